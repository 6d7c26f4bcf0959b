"""Joint angles when skin moves over bone, and when markers are lost.

    python studies/marker_noise.py [DATA] [--out FOLDER] [--quick]

Bodies are real ones (a straight walk of HC030A with Plug-in Gait and Oxford foot markers, subject01 of gait10dof with
clusters of three): each marker is put where its segment, as followed in the recording, has it, so that the angles are
known. Skin: every marker slides on its segment in all three directions by sines of a stride's first two harmonics
with random phases, half of it in common with the markers of its segment; sizes are the root mean square in each
direction on the thigh, half of that on shank and pelvis, a quarter on the foot. Dropout: every marker of the real
recording is lost for 0.2 s at random times, so that on the mean a share of all samples is missing. Errors are root
mean squares over frames, legs and draws [deg]. FOLDER takes the picture.
"""

from __future__ import annotations

from command_line import QUICK, SHARED, argument, command_line

DATA = argument("data", "folder of the real recordings", SHARED)
OUT = argument("--out", "folder of the picture; none is drawn without it")
GIVEN = command_line(__name__, __doc__, DATA, OUT, QUICK)  # before the slow imports

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from markers_to_angles import opensim, people

import gaitdisc as gd
from gaitdisc.kinematics.calibration import Calibration, calibrated
from gaitdisc.kinematics.marker_set import METHODS
from gaitdisc.kinematics.marker_set_file import marker_set
from gaitdisc.kinematics.motion import motion

SIZES_MM, SHARES = (2.0, 5.0, 10.0, 15.0), (1, 5, 10, 20)
PART_OF_SKIN = {"pelvis": 0.5, "thigh": 1.0, "shank": 0.5, "foot": 0.25}
COMMON = 0.5
STRIDE_S, LOST_S = 1.0, 0.2
SHOWN = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "knee_adduction", "knee_rotation", "ankle_angle")
FORWARD = (1.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Body:
    """A recording, its person, and the markers where rigid segments have them."""

    name: str
    calibration: Calibration
    markers: gd.Recording
    rigid: gd.Recording

    def angles(self, markers: gd.Recording) -> gd.Recording:
        """Angles of other markers of this person."""
        return motion(markers, self.calibration, FORWARD).angles


def bodies(data: Path) -> list[Body]:
    """Each set on the recording it was worn in, with joints free and held."""
    [person] = people(data, ("HC030A",))
    static, walk, _ = opensim(data)
    found = []
    for chosen, joints in (
        ("plug_in_gait", "free"),
        ("oxford_foot", "free"),
        ("gait2354", "free"),
        ("gait2354", "held"),
    ):
        markers = walk if chosen == "gait2354" else person.walks["straight"].stream("markers")
        standing = static if chosen == "gait2354" else person.static.stream("markers")
        calibration = calibrated(standing, marker_set(chosen).with_joints(joints), person.measures)
        found.append(Body(f"{chosen}, {joints}", calibration, markers, rigid(markers, calibration)))
    return found


def rigid(markers: gd.Recording, calibration: Calibration) -> gd.Recording:
    """The markers where their segments have them, joints held together so that no segment leaves its joint."""
    held = replace(calibration, marker_set=calibration.marker_set.with_joints("held"))
    poses = motion(markers, held, FORWARD).poses
    labels = calibration.marker_set.names([name[:-2] for name in markers.names if name.endswith(".x")])
    values = np.array(markers.values)
    for segment, body in calibration.body.items():
        for point in (point for point in body if point not in METHODS and point in labels):
            values[:, columns(markers, labels[point])] = poses[segment].to_laboratory(body[point])
    return markers.with_values(values)


def columns(markers: gd.Recording, label: str) -> list[int]:
    """The three columns of a marker."""
    return [markers.index(f"{label}.{axis}") for axis in "xyz"]


def slid(body: Body, size_mm: float, random: np.random.Generator) -> gd.Recording:
    """Markers that slide on their segments."""
    labels = body.calibration.marker_set.names([name[:-2] for name in body.rigid.names if name.endswith(".x")])
    values = np.array(body.rigid.values)

    def wave() -> np.ndarray:
        harmonics = np.arange(1, 3)[:, None, None] * body.rigid.time[None, :, None] * 2 * np.pi / STRIDE_S
        return np.sin(harmonics + random.uniform(0, 2 * np.pi, (2, 1, 3))).sum(axis=0)

    for segment, points in body.calibration.body.items():
        size = size_mm / 1000 * PART_OF_SKIN[segment.split("_")[0]]
        common = wave()
        for point in (point for point in points if point not in METHODS and point in labels):
            sliding = np.sqrt(COMMON) * common + np.sqrt(1 - COMMON) * wave()
            values[:, columns(body.rigid, labels[point])] += size * sliding
    return body.rigid.with_values(values)


def lost(body: Body, share: float, random: np.random.Generator) -> gd.Recording:
    """The real markers with a share of samples missing, 0.2 s at a time."""
    labels = body.calibration.marker_set.names([name[:-2] for name in body.markers.names if name.endswith(".x")])
    values = np.array(body.markers.values)
    length = round(LOST_S * body.markers.rate_hz)
    for label in labels.values():
        missing = np.zeros(len(values), bool)
        for first in random.integers(0, len(values), random.poisson(share / 100 * len(values) / length)):
            missing[first : first + length] = True
        for column in columns(body.markers, label):
            values[missing, column] = np.nan
    return body.markers.with_values(values)


def errors(found: list[gd.Recording], truth: gd.Recording) -> dict[str, float]:
    """Root mean square error of each angle over both legs [deg]."""
    return {
        name: float(
            np.sqrt(np.nanmean([(one[f"{name}_{s}"] - truth[f"{name}_{s}"]) ** 2 for one in found for s in "rl"]))
        )
        for name in SHOWN
    }


def skin(several: list[Body], draws: int) -> dict[tuple[str, float], dict[str, float]]:
    """Errors by body and size of sliding."""
    found = {}
    for body in several:
        truth = body.angles(body.rigid)
        for size in SIZES_MM:
            angles = [body.angles(slid(body, size, np.random.default_rng(seed))) for seed in range(draws)]
            found[body.name, size] = errors(angles, truth)
    return found


def dropout(several: list[Body], draws: int) -> dict[tuple[str, int], tuple[float, dict[str, float]]]:
    """Share of frames with all angles [%], and their errors against those with every marker, by body and share lost."""
    found = {}
    for body in several:
        truth = body.angles(body.markers)
        names = [f"{name}_{side}" for name in SHOWN for side in "rl"]
        for share in SHARES:
            angles = [body.angles(lost(body, share, np.random.default_rng(seed))) for seed in range(draws)]
            known = np.mean([np.isfinite(one.selected(names).values).mean() for one in angles])
            found[body.name, share] = (100 * float(known), errors(angles, truth))
    return found


def draw(slides: dict[tuple[str, float], dict[str, float]], folder: Path) -> None:
    """Error over size of sliding, one panel an angle, one line a set."""
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    drawn = Figure(figsize=(12, 6), layout="constrained")
    places = drawn.subplots(2, 4).ravel()
    for place, angle in zip(places, SHOWN, strict=False):
        for name in dict.fromkeys(name for name, _ in slides):
            place.plot([0, *SIZES_MM], [0, *(slides[name, size][angle] for size in SIZES_MM)], marker="o", label=name)
        place.set(title=angle, xlabel="skin over the thigh, rms [mm]", ylabel="error, rms [deg]")
    places[0].legend(fontsize=7)
    places[-1].remove()
    drawn.savefig(folder / "marker_noise.png", dpi=90)


def main() -> None:
    """Print both tables, draw the picture."""
    several, draws = bodies(GIVEN.data), 2 if GIVEN.quick else 10
    slides = skin(several, draws)
    print(f"Skin that slides\n\n| markers | thigh [mm] | {' | '.join(SHOWN)} |\n|{'---|' * (len(SHOWN) + 2)}")
    for (name, size), found in slides.items():
        print(f"| {name} | {size:g} | {' | '.join(f'{found[angle]:.1f}' for angle in SHOWN)} |")
    titles = f"| markers | lost [%] | angles known [%] | {' | '.join(SHOWN)} |"
    print(f"\nMarkers lost\n\n{titles}\n|{'---|' * (len(SHOWN) + 3)}")
    for (name, share), (known, found) in dropout(several, draws).items():
        print(f"| {name} | {share} | {known:.1f} | {' | '.join(f'{found[angle]:.1f}' for angle in SHOWN)} |")
    if GIVEN.out:
        draw(slides, Path(GIVEN.out))


if __name__ == "__main__":
    main()
