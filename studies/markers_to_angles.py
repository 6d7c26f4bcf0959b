"""Joint angles from markers against those that other software computed from the same markers.

    python studies/markers_to_angles.py [DATA] [--out FOLDER] [--quick]

DATA holds gait/young_straight_and_turn and gait/young_static (C3D with Plug-in Gait's own angles) and opensim_gait10dof
(OpenSim's inverse kinematics in a planar model). Differences are root mean squares over all frames of a trial [deg]; at
hip, knee and ankle after the difference of the two in the static trial. Two of the six people were held back while the
program was written, and stand in columns of their own. FOLDER takes the pictures of the curves over each other.
"""

from __future__ import annotations

from command_line import QUICK, RECORDINGS, argument, command_line

OUT = argument("--out", "folder of the pictures; none are drawn without it")
GIVEN = command_line(__name__, __doc__, RECORDINGS, OUT, QUICK)  # before the slow imports

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from markdown_table import markdown_table
from plug_in_gait_angles import HELD_BACK, WRITTEN_WITH, Row, against_plug_in_gait, drawn_curves, people, rms

import gaitdisc as gd

JOINTS = ("free", "held", "planar")
PLUG_IN_GAIT = "angle | goal | straight, 4 people | 2 held back | all 6 | turn, 4 people | 2 held back | all 6"
OPENSIM = "angle | goal | segments free | joints held | held, planar as the model"
SAGITTAL = ("hip_flexion", "knee_angle", "ankle_angle")
Pairs = Mapping[str, tuple[np.ndarray, np.ndarray]]  # angle -> ours, theirs [deg]


def opensim(data: Path) -> tuple[gd.Trial, gd.Trial, gd.Recording]:
    """Static trial, walk and OpenSim's angles of subject01."""
    folder = data / "opensim_gait10dof"
    files = (folder / "ExperimentalData" / "subject01_static.trc", folder / "ExperimentalData" / "subject01_walk.trc")
    static, walk = map(gd.read, files)
    return static, walk, gd.read(folder / "IK" / "subject01_walk_IK.mot").stream("kinematics")


def opensim_curves(data: Path, joints: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Ours and OpenSim's sagittal angles of the same markers, ours without the mean difference."""
    static, walk, inverse = opensim(data)
    ours = gd.angles(walk, static, "gait2354", joints)
    found = {}
    for name in ("pelvis_tilt", *(f"{joint}_{side}" for joint in SAGITTAL for side in "rl")):
        other = np.interp(ours.time, inverse.time, inverse[name])
        found[name] = ours[name] - float(np.nanmean(ours[name] - other)), other
    return found


def against_opensim(data: Path) -> list[Row]:
    """Differences with segments free, with joints held together, and in the plane of OpenSim's model."""
    both = {joints: opensim_curves(data, joints) for joints in JOINTS}
    return [(name, "3", *(f"{rms(both[joints][name]):.2f}" for joints in both)) for name in both["free"]]


def draw(people: Mapping[str, Pairs], opensim: Pairs, folder: Path) -> None:
    """Plug-in Gait's and ours of each person's straight walk; OpenSim's and ours."""
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    rows = list(next(iter(people.values())))
    drawn = Figure(figsize=(3 * len(people), 1.7 * len(rows)), layout="constrained")
    panels = drawn.subplots(len(rows), len(people), squeeze=False)
    for column, (person, pairs) in enumerate(people.items()):
        for row, name in enumerate(rows):
            panel(panels[row][column], pairs[name], f"{name} [deg]" if column == 0 else "")
        panels[0][column].set_title(person)
    drawn.legend(("Plug-in Gait, in the file", "gaitdisc, from the markers"), loc="outside lower center", ncols=2)
    drawn.savefig(folder / "markers_to_angles_plug_in_gait.png", dpi=90)
    drawn = Figure(figsize=(10, 8), layout="constrained")
    places = drawn.subplots(4, 2).ravel()
    for place, (name, pair) in zip(places, opensim.items(), strict=False):
        panel(place, pair, f"{name} [deg]")
    places[-1].remove()
    drawn.legend(("OpenSim, planar model", "gaitdisc, planar"), loc="outside lower center", ncols=2)
    drawn.savefig(folder / "markers_to_angles_opensim.png", dpi=90)


def panel(axes, pair: tuple[np.ndarray, np.ndarray], label: str) -> None:
    """One angle over the frames."""
    axes.plot(pair[1], color="0.6", lw=3)
    axes.plot(pair[0], color="tab:blue", lw=1)
    axes.set_ylabel(label, fontsize=7)
    axes.set_xlabel("frame", fontsize=6)
    axes.tick_params(labelsize=7)


if __name__ == "__main__":
    several = people(GIVEN.data, WRITTEN_WITH[:1] if GIVEN.quick else (*WRITTEN_WITH, *HELD_BACK))
    for chosen in ("plug_in_gait", "plug_in_gait, harrington", "oxford_foot", "oxford_foot, harrington"):
        print(f"\n{chosen}: rms difference to Plug-in Gait, median (largest) [deg]\n")
        print(markdown_table(PLUG_IN_GAIT, against_plug_in_gait(several, chosen)))
    print("\nrms difference to OpenSim's inverse kinematics after the mean difference [deg]\n")
    print(markdown_table(OPENSIM, against_opensim(GIVEN.data)))
    if GIVEN.out:
        straight = {p.name + " (held back)" * (p.name in HELD_BACK): drawn_curves(p) for p in several}
        draw(straight, opensim_curves(GIVEN.data, "planar"), Path(GIVEN.out))
