"""Is the embedded cohort normal walking? Its ranges and timings, printed beside those of the literature.

    python studies/cohort_norms.py [--quick]

studies/results/cohort.md holds the table that it prints, with what the sources are worth.
"""

from __future__ import annotations

from command_line import QUICK, command_line

GIVEN = command_line(__name__, __doc__, QUICK)  # before the slow imports

import tomllib
from pathlib import Path

import numpy as np
from cohort_muscles import envelopes
from markdown_table import markdown_table
from numpy.typing import NDArray

from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import MUSCLES, Spring
from gaitdisc.cohort.walk import TrueWalk, walked
from gaitdisc.signals.contacts import force_contacts

WALK_S = 120.0
ON = 0.25  # of the way from the envelope's least to its largest
SEED = 500
PUBLISHED = tomllib.loads(Path(__file__).with_name("cohort_norms.toml").read_text(encoding="utf-8"))
SOURCES, BURSTS = PUBLISHED["sources"], PUBLISHED["bursts"]


def numbers(walk: TrueWalk) -> dict[str, float]:
    """What is read off one walk, right side."""
    person = walk.person
    angles = walk.strides(walk.angles).mean(axis=0)[:, 0]
    moments = walk.strides(walk.moments).mean(axis=0)[:, 0] / person.mass_kg
    hip = angles[:, 0] + habitual("pelvis_tilt", person.dimensionless_speed).mean
    knee, ankle = angles[:, 3], angles[:, 4]
    force = walk.strides(walk.force).mean(axis=0)[:, 0] / person.mass_kg / 9.81
    spread = walk.strides(walk.angles).std(axis=0).mean(axis=0)[0]
    durations = np.diff(walk.contacts())
    seen = np.diff(force_contacts(measure(walk, "walk", "nominal").stream("forces"))["r"].time)
    cv = [100 * float(d.std() / d.mean()) for d in (durations, seen)]
    slip = walk.strides(walk.sole)[:, 12:47, 0].mean() / -person.speed_m_per_s
    values = [hip.max(), hip.min(), knee[5:25].max(), knee.max(), knee.min(), ankle.max(), ankle.min()]
    values += [angles[:, 1].max(), knee.argmax(), ankle.argmax(), ankle.argmin()]
    values += [-moments[:, 0].min(), moments[:55, 0].max(), -moments[:, 1].min(), -moments[:, 2].min()]
    values += [100 * np.mean(walk.force[:, 0, 1] > 20.0), 120 / durations.mean()]
    values += [force[5:25, 1].max(), force[20:40, 1].min(), force[38:60, 1].max(), force[:, 0].max(), slip]
    values += [cv[0], *spread[[0, 3, 4]], cv[1] - cv[0], -walk.strides(walk.spring).mean(axis=0).min()]
    return dict(zip(SOURCES, map(float, values), strict=True))


def burst(curve: NDArray[np.float64]) -> str:
    """On and off of an envelope's mean curve, at a quarter of its height [% stride]."""
    active = (curve[:100] - curve.min()) > ON * np.ptp(curve)
    on = np.flatnonzero(active & ~np.roll(active, 1))
    off = np.flatnonzero(active & ~np.roll(active, -1))
    ends = [int(off[off >= start][0]) if np.any(off >= start) else int(off[0]) for start in on]
    return " and ".join(f"{start}-{end}" for start, end in zip(on.tolist(), ends, strict=True))


def run(quick: bool = False) -> dict[str, NDArray[np.float64]]:
    """Walk the twelve in both conditions, print both tables, and return what was read off the Nominal walks."""
    people, duration_s = (the_twelve()[:2], 20.0) if quick else (the_twelve(), WALK_S)
    tables, shapes = {"nominal": [], "exo": []}, []
    for number, person in enumerate(people):
        nominal = walked(person, None, duration_s, SEED + number)
        tables["nominal"].append(numbers(nominal))
        tables["exo"].append(numbers(walked(person.adapt_to(Spring()), Spring(), duration_s, SEED + number)))
        curves = nominal.strides(envelopes(nominal)).mean(axis=0)
        shapes.append(curves / curves.max(axis=0))
    print(f"n = {len(people)} people, {duration_s:.0f} s, right side; mean +- sd over people\n")
    found, exo = ({name: np.array([row[name] for row in rows]) for name in SOURCES} for rows in tables.values())
    rows = [(name, _spread(found[name]), _spread(exo[name]), source) for name, source in SOURCES.items()]
    print(markdown_table("quantity | Nominal | Exo | literature", rows), end="\n\n")
    mean = zip(MUSCLES, np.mean(shapes, axis=0).T, strict=True)
    bursts = [(name, burst(curve), BURSTS[name]) for name, curve in mean]
    print(markdown_table("muscle | on-off [% stride] | literature", bursts))
    return found


def _spread(values: NDArray[np.float64]) -> str:
    digits = 2 if abs(values.mean()) < 5 else 1
    return f"{values.mean():.{digits}f} +- {values.std(ddof=1):.{digits}f}"


if __name__ == "__main__":
    run(GIVEN.quick)
