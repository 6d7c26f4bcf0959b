"""Joint angles from markers against those that other software computed from the same markers.

    python studies/markers_to_angles.py [DATA] [--out FOLDER] [--quick]

DATA holds gait/young_straight_and_turn and gait/young_static (C3D with Plug-in Gait's own angles) and opensim_gait10dof
(OpenSim's inverse kinematics in a planar model); by default ../shared/data, or GAITDISC_DATA. Differences are root mean
squares over all frames of a trial [deg]; at hip, knee and ankle after the difference of the two in the static trial.
Two of the six people were held back while the program was written, and stand in columns of their own. FOLDER takes the
pictures of the curves over each other.
"""

from __future__ import annotations

from command_line import QUICK, SHARED, argument, command_line

DATA = argument("data", "folder of the real recordings", SHARED)
OUT = argument("--out", "folder of the pictures; none are drawn without it")
GIVEN = command_line(__name__, __doc__, DATA, OUT, QUICK)  # before the slow imports

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import gaitdisc as gd
from gaitdisc.ingest.c3d_measures import read_body_measures
from gaitdisc.kinematics.calibration import calibrated
from gaitdisc.kinematics.marker_set import JOINTS, MarkerSet
from gaitdisc.kinematics.marker_set_file import marker_set
from gaitdisc.kinematics.motion import joint_angles, motion
from gaitdisc.recording.body_measures import BodyMeasures

Row = tuple[str, ...]
WRITTEN_WITH, HELD_BACK = ("HC002D", "HC030A", "HC031A", "HC032A"), ("HC033A", "HC036A")
JOINT_ANGLES = {  # ours, without its side: the axis of Plug-in Gait's label, and the goal [deg]
    "hip_flexion": ("HipAngles.x", 2), "hip_adduction": ("HipAngles.y", 4), "hip_rotation": ("HipAngles.z", 4),
    "knee_angle": ("KneeAngles.x", 2), "knee_adduction": ("KneeAngles.y", 4), "knee_rotation": ("KneeAngles.z", 4),
    "ankle_angle": ("AnkleAngles.x", 2), "ankle_rotation": ("AnkleAngles.z", 4),
}  # fmt: skip
LEVEL_ANGLES = {  # against the laboratory: label, sign of ours in it, goal
    "pelvis_tilt": ("RPelvisAngles.x", -1, 2), "pelvis_list": ("LPelvisAngles.y", 1, 4),
    "pelvis_rotation": ("RPelvisAngles.z", 1, 4), "foot_progression_angle_r": ("RFootProgressAngles.z", 1, 4),
    "foot_progression_angle_l": ("LFootProgressAngles.z", 1, 4),
}  # fmt: skip
SAGITTAL = ("hip_flexion", "knee_angle", "ankle_angle")


@dataclass(frozen=True, eq=False)
class Person:
    """The recordings of one person."""

    name: str
    static: gd.Trial
    walks: dict[str, gd.Trial]
    measures: BodyMeasures


def people(data: Path, names: tuple[str, ...]) -> list[Person]:
    """Static trial, straight walk, turn and measures of each."""
    found = []
    with gd.C3DReader() as reader:
        for name in names:
            walks = data / "gait" / "young_straight_and_turn" / name
            [static] = [*(data / "gait" / "young_static").glob(f"{name}/*.c3d"), *walks.glob("static/*.c3d")]
            trials = {kind: gd.read(next(walks.glob(f"{kind}/*.c3d")), reader=reader) for kind in ("straight", "turn")}
            found.append(Person(name, gd.read(static, reader=reader), trials, read_body_measures(static)))
    return found


def nearest_axis(direction: np.ndarray) -> tuple[float, ...]:
    """The axis of the laboratory that Plug-in Gait takes for the direction of walking."""
    axis = int(np.argmax(np.abs(direction)))
    return tuple(float(np.sign(direction[axis])) * np.eye(3)[axis])


def theirs(trial: gd.Trial, ours: str) -> np.ndarray:
    """An angle of the file, with our sign."""
    angles = trial.stream("kinematics")
    if ours in LEVEL_ANGLES:
        label, sign, _ = LEVEL_ANGLES[ours]
        return sign * angles[label]
    label = f"{ours[-1].upper()}{JOINT_ANGLES[ours[:-2]][0]}"
    return angles[ours] if ours in angles.names else angles[label]


def named_set(name: str) -> MarkerSet:
    """A set that comes along; `plug_in_gait, harrington` has Harrington's hips in place of Plug-in Gait's own."""
    plain, _, hip = name.partition(", ")
    return marker_set(plain).with_hip(hip) if hip else marker_set(plain)


def curves(person: Person, chosen: str, kind: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Ours and theirs over a walk; joint angles without the difference of the static trial."""
    calibration = calibrated(person.static.stream("markers"), named_set(chosen), person.measures)
    walk, markers = person.walks[kind], person.walks[kind].stream("markers")
    forward = nearest_axis(motion(markers, calibration).walking.rotation[0, :, 0])
    ours, still = (
        motion(markers, calibration, forward).angles,
        motion(person.static.stream("markers"), calibration).angles,
    )
    found = {}
    for name in (f"{joint}_{side}" for joint in JOINT_ANGLES for side in "rl"):
        offset = float(np.nanmedian(still[name] - theirs(person.static, name)))
        found[name] = ours[name] - offset, theirs(walk, name)
    if kind == "straight":  # on a turn the two take another direction of walking
        found |= {name: (ours[name], theirs(walk, name)) for name in LEVEL_ANGLES}
    return found


def rms(pair: tuple[np.ndarray, np.ndarray]) -> float:
    """Root mean square difference [deg]."""
    return float(np.sqrt(np.nanmean((pair[0] - pair[1]) ** 2)))


def against_plug_in_gait(several: list[Person], chosen: str) -> list[Row]:
    """Median and largest difference over legs and people, each kind of walk; the two held back apart."""
    found = {(p.name, kind): curves(p, chosen, kind) for p in several for kind in ("straight", "turn")}
    rows = []
    for joint, goal in [
        *((j, g) for j, (_, g) in JOINT_ANGLES.items()),
        *((a, g) for a, (*_, g) in LEVEL_ANGLES.items()),
    ]:
        cells = []
        for kind in ("straight", "turn"):
            for group in (WRITTEN_WITH, HELD_BACK, WRITTEN_WITH + HELD_BACK):
                errors = [
                    rms(pair) for (name, walked), pairs in found.items() if walked == kind and name in group
                    for angle, pair in pairs.items() if angle == joint or angle[:-2] == joint
                ]  # fmt: skip
                cells.append(f"{np.median(errors):.2f} ({max(errors):.2f})" if errors else "-")
        rows.append((joint, f"{goal:g}", *cells))
    return rows


def opensim(data: Path) -> tuple[gd.Recording, gd.Recording, gd.Recording]:
    """Static markers, walking markers and OpenSim's angles of subject01."""
    folder = data / "opensim_gait10dof"
    files = (folder / "ExperimentalData" / "subject01_static.trc", folder / "ExperimentalData" / "subject01_walk.trc")
    static, walk = (gd.read(file).stream("markers") for file in files)
    return static, walk, gd.read(folder / "IK" / "subject01_walk_IK.mot").stream("kinematics")


def opensim_curves(data: Path, joints: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Ours and OpenSim's sagittal angles of the same markers, ours without the mean difference."""
    static, walk, inverse = opensim(data)
    ours = joint_angles(walk, static, "gait2354", joints=joints)
    found = {}
    for name in ("pelvis_tilt", *(f"{joint}_{side}" for joint in SAGITTAL for side in "rl")):
        other = np.interp(walk.time, inverse.time, inverse[name])
        found[name] = ours[name] - float(np.nanmean(ours[name] - other)), other
    return found


def against_opensim(data: Path) -> list[Row]:
    """Differences with segments free, with joints held together, and in the plane of OpenSim's model."""
    both = {joints: opensim_curves(data, joints) for joints in JOINTS}
    return [(name, "3", *(f"{rms(both[joints][name]):.2f}" for joints in both)) for name in both["free"]]


def draw(several: list[Person], data: Path, folder: Path) -> None:
    """Curves over each other: Plug-in Gait's and ours of each person's straight walk; OpenSim's and ours."""
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    rows = [*(f"{joint}_r" for joint in JOINT_ANGLES), *(name for name in LEVEL_ANGLES if name[-2:] != "_l")]
    drawn = Figure(figsize=(3 * len(several), 1.7 * len(rows)), layout="constrained")
    panels = drawn.subplots(len(rows), len(several), squeeze=False)
    for column, person in enumerate(several):
        pairs = curves(person, "plug_in_gait", "straight")
        for row, name in enumerate(rows):
            panel(panels[row][column], pairs[name], f"{name} [deg]" if column == 0 else "")
        panels[0][column].set_title(person.name + " (held back)" * (person.name in HELD_BACK))
    drawn.legend(("Plug-in Gait, in the file", "gaitdisc, from the markers"), loc="outside lower center", ncols=2)
    drawn.savefig(folder / "markers_to_angles_plug_in_gait.png", dpi=90)
    pairs = opensim_curves(data, "planar")
    drawn = Figure(figsize=(10, 8), layout="constrained")
    places = drawn.subplots(4, 2).ravel()
    for place, (name, pair) in zip(places, pairs.items(), strict=False):
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


def main() -> None:
    """Print the tables, draw the pictures."""
    several = people(GIVEN.data, WRITTEN_WITH[:1] if GIVEN.quick else (*WRITTEN_WITH, *HELD_BACK))
    for chosen in ("plug_in_gait", "plug_in_gait, harrington", "oxford_foot", "oxford_foot, harrington"):
        print(f"\n{chosen}: rms difference to Plug-in Gait, median (largest) [deg]\n")
        print("| angle | goal | straight, 4 people | 2 held back | all 6 | turn, 4 people | 2 held back | all 6 |")
        print("|---|---|---|---|---|---|---|---|")
        for row in against_plug_in_gait(several, chosen):
            print(f"| {' | '.join(row)} |")
    print("\nrms difference to OpenSim's inverse kinematics after the mean difference [deg]\n")
    print("| angle | goal | segments free | joints held | held, planar as the model |\n|---|---|---|---|---|")
    for row in against_opensim(GIVEN.data):
        print(f"| {' | '.join(row)} |")
    if GIVEN.out:
        draw(several, GIVEN.data, Path(GIVEN.out))


if __name__ == "__main__":
    main()
