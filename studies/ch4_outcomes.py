"""Section 6.2.2 on real recordings: joint moments and metabolic power as outcomes of a response.

    python studies/ch4_outcomes.py [FOLDER] [--tables moments energy] [--keep] [--quick]
    python studies/ch4_outcomes.py --print TABLE

`moments`: six children walk straight and turn; Nominal is fitted to the other children's straight walks, Exo to their
turns, and each is scored on the turn of the child left out. `energy`: the power of eight people under nine settings of
an ankle exoskeleton from EMG and ground forces, by models of the others; null: the person's settings shuffled.
"""

from __future__ import annotations

from pathlib import Path

from command_line import tables_line

TABLES = ("moments", "energy")
GIVEN = tables_line(__name__, __doc__, "ch4_outcomes", TABLES)  # before the slow imports

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from ch4_energy import energy
from chapter5.gait import DATA
from chapter5.people import ANGLES, CUTOFF_HZ
from further import Made, Number, main

import gaitdisc as gd
from gaitdisc.models.fourier_ridge import fit_fourier_ridge
from gaitdisc.reconstruction.windows import stacked

MOMENTS = ("ankle_angle_{}_moment", "knee_angle_{}_moment", "hip_flexion_{}_moment")
JOINTS = ("ankle", "knee", "hip")
LOADED, LEAST_S = 0.2, 0.2  # of body weight under the foot; a shorter contact is none of a step


def steps(path: Path) -> gd.Samples:
    """Angles and rates of a child's leg while a plate carries its foot, and the moments of that leg [N m/kg]."""
    trial, found = gd.read(path), []
    angles = gd.lowpass(trial.stream("kinematics").selected(ANGLES), CUTOFF_HZ)
    rates, moments = np.gradient(angles.values, 1 / angles.rate_hz, axis=0), trial.stream("moments")
    for side, other in (("r", "l"), ("l", "r")):
        names = [name.format(side) for name in MOMENTS]
        force = f"{side.upper()}NormalisedGRF.z"
        if force not in moments.names:
            continue
        weight = np.abs(np.nan_to_num(moments[force]))
        weight = weight / 9.81 if weight.max() > 5 else weight  # N/kg, or already a share
        y = moments.selected(names).values
        order = [angles.names.index(name) for name in (*(n for n in ANGLES if n.endswith(side)),
                                                       *(n for n in ANGLES if n.endswith(other)))]  # fmt: skip
        x = np.hstack([angles.values[:, order], rates[:, order]])
        on = (weight > LOADED) & np.isfinite(y).all(axis=1) & np.isfinite(x).all(axis=1)
        if on.sum() > LEAST_S * angles.rate_hz:
            named = tuple(f"x{k}" for k in range(x.shape[1]))
            found.append(gd.Samples(x[on], y[on], named, JOINTS, angles.time[on], 0 * angles.time[on]))
    return stacked(found)


def moments(quick: bool) -> Iterator[Number]:
    """Nominal, Augmented and Exo of moments on the turn of each child, by the other children."""
    people = sorted(path for path in (DATA / "young_straight_and_turn").iterdir() if path.is_dir())
    walks = {way: [steps(next((person / way).glob("*.c3d"))) for person in people] for way in ("straight", "turn")}
    for place, person in enumerate(people[: 2 if quick else None]):
        chosen = (place + 1) % len(people)
        others = [k for k in range(len(people)) if k not in (place, chosen)]
        straight, turn = ([walks[way][k] for k in others] for way in ("straight", "turn"))
        f = fit_fourier_ridge(stacked(straight), walks["straight"][chosen])
        exo = fit_fourier_ridge(stacked(turn), walks["turn"][chosen])
        missed = [replace(each, y=each.y - f(each.x)) for each in (*turn, walks["turn"][chosen])]
        g = fit_fourier_ridge(stacked(missed[:-1]), missed[-1])
        for word, test in (("turn", walks["turn"][place]), ("straight", walks["straight"][place])):
            predicted = {"mean of the others' turns (null)": np.tile(stacked(turn).y.mean(axis=0), (len(test), 1)),
                    "Nominal": f(test.x), "Augmented": f(test.x) + g(test.x), "Exo": exo(test.x)}  # fmt: skip
            for model, values in predicted.items():
                if word == "straight" and model != "Nominal":
                    continue
                for k, joint in enumerate(JOINTS):
                    missed_of = np.sqrt(np.mean((values - test.y)[:, k] ** 2))
                    yield Number(f"{model} on {word}", f"{joint}: RMSE [N m/kg]", person.name, float(missed_of))


MADE = {
    "moments": Made(moments, "stance, one child left out", "children"),
    "energy": Made(energy, "metabolic power, one person left out, own mean known; nine settings each"),
}

if __name__ == "__main__":
    main(GIVEN, MADE, Path(__file__).with_suffix(".csv"))
