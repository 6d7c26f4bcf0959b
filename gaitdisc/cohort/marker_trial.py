"""A walk as cameras and two belts see it: markers over moving skin, a static trial, forces with their point.

The skeleton of the walk is laid in space: pelvis, thighs, shanks and feet with the true joint angles, hips where the
habit and the compliant pelvis move them. The pelvis keeps its tilt and neither lists nor turns, so that the angles from
the markers are to be those of the model. Markers are those of the Rajagopal set, with medial ones at knee and ankle.
Skin moves over bone by 5 to 15 mm at the thigh, less below, in proportion to hip and knee flexion and in directions of
each marker's own (range: Leardini et al. 2005, from memory). The sideways force and the place of the hips are general
knowledge. The laboratory has x forwards, y to the left, z up.

References
----------
Rajagopal 2016, IEEE Trans Biomed Eng 63:2068. Leardini 2005, Gait Posture 21:212. Harrington 2007, J Biomech 40:595.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from gaitdisc.channel import Channel
from gaitdisc.cohort.body import Leg, ankle_place, make_leg
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.leg_path import PHASES, hip_motion, map_phase, pressure_centre, pressure_point, thigh_shank_foot
from gaitdisc.cohort.person import Person
from gaitdisc.cohort.walk import QUICK_HZ, SLOW_HZ, TrueWalk
from gaitdisc.recording import Recording, Source, Surface, Trial
from gaitdisc.recording.arrays import Values, runs

SIDES = (("r", 1.0), ("l", -1.0))
ASIS_WIDTH, PELVIS_DEPTH = 0.145, 0.090  # of height
CAMERA_M = 0.0003  # noise of a coordinate
SKIN_M = {"pelvis": 0.003, "thigh": 0.006, "shank": 0.004, "foot": 0.001}  # for 60 deg of the joints beside it
STANDING_S = 1.0
SWAY_M = 0.040  # of the pelvis sideways, and with it the feet apart
SWAY_AT = 0.30  # share of the right leg's stride at which it is towards that leg
INWARDS = 0.05  # sideways force, of the vertical one
MOMENT_NM = 0.3  # noise of a belt's moments
FORCE_N = 2.0
BELT_M = (2.0, 0.5)  # length, width of a belt
TO_LABORATORY = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # from forwards, up, right
Segments = dict[str, tuple[Values, Values]]  # origin and rotation over time
# (forwards, down, outwards) of the joint above or the middle of the front spines; down in shares of the segment, the
# rest in shares of height
PLACES = {
    "pelvis": {
        "RASI": (0.0, 0.0, ASIS_WIDTH / 2),
        "LASI": (0.0, 0.0, -ASIS_WIDTH / 2),
        "RPSI": (-PELVIS_DEPTH, 0.0, 0.025),
        "LPSI": (-PELVIS_DEPTH, 0.0, -0.025),
    },
    "thigh": {
        "TH1": (0.00, 0.45, 0.055),
        "TH2": (0.045, 0.40, 0.012),
        "TH3": (-0.025, 0.60, 0.040),
        "LFC": (0.0, 1.0, 0.031),
        "MFC": (0.0, 1.0, -0.031),
    },
    "shank": {
        "TB1": (0.00, 0.45, 0.035),
        "TB2": (0.030, 0.30, 0.006),
        "TB3": (-0.020, 0.55, 0.025),
        "LMAL": (0.0, 1.0, 0.022),
        "MMAL": (0.0, 1.0, -0.022),
    },
    "foot": {"CAL": (-0.035, 0.025, 0.0), "TOE": (0.085, 0.030, -0.005), "MT5": (0.070, 0.034, 0.026)},
}


def belts() -> tuple[Surface, Surface]:
    """Right and left belt."""
    along, across = BELT_M
    corners = np.array([[along / 2, 0, 0], [-along / 2, 0, 0], [-along / 2, across, 0], [along / 2, across, 0]])
    return Surface("plate_1", corners - np.array([0, across, 0])), Surface("plate_2", corners)


def standing(person: Person) -> Trial:
    """Static trial of a person, all joints straight, at 100 Hz."""
    count = round(STANDING_S * SLOW_HZ)
    leg = make_leg(person.height_m, person.mass_kg)
    angles = np.zeros((count, 2, 5))
    angles[:, :, 0] = _tilt(person)
    height = leg.thigh_m + leg.shank_m + leg.ankle_m
    hips = np.tile([0.0, height, 0.0], (count, 1))
    rng = np.random.default_rng([round(person.mass_kg * 1e6), 41])
    markers = _markers(person, leg, _segments(person, leg, angles, hips), angles - angles[0], rng)
    return Trial(f"{person.name}_static", {"markers": markers}, subject=person.name)


def marker_trial(walk: TrueWalk, name: str, condition: str) -> Trial:
    """Markers at 100 Hz, and both belts' forces and moments at 1000 Hz (`plate_1` is the right one)."""
    person = walk.person
    leg = make_leg(person.height_m, person.mass_kg, person.foot_kg)
    angles = walk.angles.copy()
    angles[:, :, 0] += _tilt(person)
    hips = _pelvis(walk, leg)
    rng = np.random.default_rng([walk.seed, 43])
    straight = np.zeros((2, 5))
    straight[:, 0] = _tilt(person)
    segments = _segments(person, leg, angles, hips)
    markers = _markers(person, leg, segments, angles - straight, rng, condition)
    forces = _forces(walk, leg, segments, rng, condition)
    return Trial(
        name, {"markers": markers, "forces": forces}, subject=person.name, condition=condition, surfaces=belts()
    )


def _tilt(person: Person) -> float:
    return habitual("pelvis_tilt", person.dimensionless_speed).mean


def _pelvis(walk: TrueWalk, leg: Leg) -> Values:
    """Path of the middle of the hips (time, 3), forwards, up and right, so that standing feet press on the belt [m]."""
    person = walk.person
    grid = np.arange(PHASES) / PHASES
    path = np.cumsum(hip_motion(person, grid), axis=0) * person.stride_s / PHASES
    path = 0.5 * (path + np.roll(path, -PHASES // 2, axis=0))
    path -= path.mean(axis=0)
    phase = walk.phase[:: round(QUICK_HZ / SLOW_HZ)] % 1.0
    hip_path = [np.interp(phase, grid, column, period=1.0) for column in path.T]
    sway = SWAY_M * np.cos(2 * np.pi * (phase - SWAY_AT))
    moved = np.column_stack([hip_path[0] + walk.pelvis[:, 0], hip_path[1] + walk.pelvis[:, 1], sway])
    stands = (phase > 0.15) & (phase < 0.40)
    moved[:, 1] -= np.mean(moved[stands, 1] + _pressure_from_hip(walk, leg, 0)[stands, 1])
    return moved


def _pressure_from_hip(walk: TrueWalk, leg: Leg, side: int) -> Values:
    """Point under the pressure from the hip (time, 2), forwards and up [m]."""
    psi = thigh_shank_foot(walk.angles[:, side])
    phase = walk.phase[:: round(QUICK_HZ / SLOW_HZ)] + 0.5 * side
    pressure = pressure_centre(map_phase(walk.person, phase % 1.0), leg.sole_m)
    return ankle_place(leg, psi) + pressure_point(leg, psi[:, 2], pressure)


def _segments(person: Person, leg: Leg, angles: Values, hips: Values) -> Segments:
    """Origin (time, 3) and rotation (time, 3, 3) of each segment, in forwards, up, right."""
    pelvis = Rotation.from_euler("ZXY", np.tile([-_tilt(person), 0.0, 0.0], (len(angles), 1)), degrees=True).as_matrix()
    segments = {"pelvis": (hips - pelvis @ _hip(person, 0.0), pelvis)}
    for column, (side, sign) in enumerate(SIDES):
        leg_angles = angles[:, column]
        above, place = pelvis, segments["pelvis"][0] + pelvis @ _hip(person, sign)
        flat = np.zeros(len(leg_angles))
        for part, turns, length in (
            ("thigh", (leg_angles[:, 0], sign * leg_angles[:, 1], sign * leg_angles[:, 2]), leg.thigh_m),
            ("shank", (-leg_angles[:, 3], flat, flat), leg.shank_m),
            ("foot", (leg_angles[:, 4], flat, flat), 0.0),
        ):
            above = above @ Rotation.from_euler("ZXY", np.column_stack(turns), degrees=True).as_matrix()
            segments[f"{part}_{side}"] = (place, above)
            place = place + above @ np.array([0.0, -length, 0.0])
    return segments


def _hip(person: Person, sign: float) -> Values:
    """Hip from the middle of the front spines, by Harrington's regression; sign 0 is the middle of both hips [m]."""
    width, depth = ASIS_WIDTH * person.height_m, PELVIS_DEPTH * person.height_m
    return np.array([-0.24 * depth - 0.0099, -0.30 * width - 0.0109, sign * (0.33 * width + 0.0073)])


def _markers(
    person: Person, leg: Leg, segments: Segments, bent_deg: Values, rng: np.random.Generator, condition: str = ""
) -> Recording:
    skin = np.random.default_rng([round(person.mass_kg * 1e6), 37])  # the same in every trial of the person
    columns, channels = [], []
    for segment, (origin, rotation) in segments.items():
        part, _, side = segment.partition("_")
        column = "rl".find(side) if side else 0
        flexed = bent_deg[:, column][:, [0, 3]] / 60.0
        for label, place in _places(person, leg, part, side).items():
            away = flexed @ (SKIN_M[part] * skin.normal(size=(2, 3)))
            seen = (origin + np.einsum("tij,tj->ti", rotation, place + away)) @ TO_LABORATORY.T
            columns.append(seen + rng.normal(0.0, CAMERA_M, seen.shape))
            channels += [Channel(f"{label}.{axis}", "marker", "m") for axis in "xyz"]
    values = np.hstack(columns)
    return Recording(
        np.arange(len(values)) / SLOW_HZ, values, tuple(channels), person.name, condition, Source(reader="cohort")
    )


def _places(person: Person, leg: Leg, part: str, side: str) -> dict[str, Values]:
    """Markers of a segment in its frame [m]."""
    height = person.height_m
    length = {"thigh": leg.thigh_m, "shank": leg.shank_m}.get(part, height)
    sign = -1.0 if side == "l" else 1.0
    return {
        f"{side.upper()}{label}": np.array([x * height, -y * length, sign * z * height])
        for label, (x, y, z) in PLACES[part].items()
    }


def _forces(walk: TrueWalk, leg: Leg, segments: Segments, rng: np.random.Generator, condition: str) -> Recording:
    """Force and moment about the middle of each belt, in the laboratory's axes."""
    columns, channels = [], []
    pelvis, turned = segments["pelvis"]
    hips = pelvis + turned @ _hip(walk.person, 0.0)
    for column, ((side, sign), belt) in enumerate(zip(SIDES, belts(), strict=True)):
        at = _pressure_from_hip(walk, leg, column) + hips[:, :2]
        foot = segments[f"foot_{side}"][0][:, 2]
        slow = np.column_stack([at[:, 0], np.zeros(len(at)), foot]) @ TO_LABORATORY.T
        point = np.column_stack([np.interp(walk.quick_s, walk.slow_s, coordinate) for coordinate in slow.T])
        along, up = walk.force[:, column].T
        force = np.column_stack([along, up, -sign * INWARDS * up]) @ TO_LABORATORY.T
        turn = np.interp(walk.quick_s, walk.slow_s, walk.turn[:, column])[:, None] * np.array([0.0, 0.0, 1.0])
        moment = np.cross(point - belt.corners.mean(axis=0), force) + turn @ TO_LABORATORY.T
        columns += [force + rng.normal(0.0, FORCE_N, force.shape), moment + rng.normal(0.0, MOMENT_NM, moment.shape)]
        channels += [
            Channel(f"{belt.name}_{kind}{axis}", "vertical_force" if kind + axis == "fz" else quantity, unit)
            for kind, quantity, unit in (("f", "force", "N"), ("m", "moment", "N m"))
            for axis in "xyz"
        ]
    return Recording(
        walk.quick_s, np.hstack(columns), tuple(channels), walk.person.name, condition, Source(reader="cohort")
    )


STRIDES = 2.9  # in the cameras' view
BEFORE = 0.7  # strides before the step on the first plate
PLATE_M = (0.6, 0.9)  # along and across the walkway; shorter where a step is
STANDS_N = 20.0


def overground(belts: Trial, start_s: float, stride_s: float, speed_m_per_s: float, name: str) -> Trial:
    """Trial of two to three strides over two plates, of a walk on two belts with markers.

    The belts' frame moves on at the belts' speed. The right foot's step is seen by `plate_1`, the left foot's after it
    by `plate_2`; other steps fall beside the plates.
    """
    end_s = start_s + STRIDES * stride_s
    stretches = {key: recording.between(start_s, end_s) for key, recording in belts.streams.items()}
    right = _step(stretches["forces"], "plate_1", start_s + BEFORE * stride_s)
    left = _step(stretches["forces"], "plate_2", right.start_s)
    length = min(PLATE_M[0], 0.9 * 0.5 * stride_s * speed_m_per_s)
    plates, columns = [], []
    rng = np.random.default_rng([round(1000 * start_s), 47])
    along, half = np.array([1.0, 0.0, 0.0]), PLATE_M[1] / 2
    for step, belt in zip((right, left), belts.surfaces, strict=True):
        middle = belt.corners.mean(axis=0)[0] + step.along_m + speed_m_per_s * (step.middle_s - start_s)
        front, back = length / 2, -length / 2  # around the step, across the whole walkway
        corners = np.array([[front, -half, 0.0], [back, -half, 0.0], [back, half, 0.0], [front, half, 0.0]])
        plate = Surface(belt.name, corners + middle * along)
        apart = belt.corners.mean(axis=0) - plate.corners.mean(axis=0)
        apart = apart + (speed_m_per_s * (stretches["forces"].time - start_s))[:, None] * along
        moment = step.moment + np.cross(apart, step.force)  # about the middle of the plate
        columns.append(step.force + rng.normal(0.0, FORCE_N, step.force.shape))
        columns.append(moment + rng.normal(0.0, MOMENT_NM, moment.shape))
        plates.append(plate)
    walked = np.zeros_like(stretches["markers"].values)
    walked[:, 0::3] = speed_m_per_s * (stretches["markers"].time - start_s)[:, None]
    stretches["markers"] = stretches["markers"].with_values(stretches["markers"].values + walked)
    stretches["forces"] = stretches["forces"].with_values(np.hstack(columns))
    streams = {key: replace(recording, time=recording.time - recording.time[0]) for key, recording in stretches.items()}
    return Trial(name, streams, subject=belts.subject, condition=belts.condition, surfaces=tuple(plates))


class _Step(NamedTuple):
    """One step on one belt: its force and its moment about the belt's middle while the foot stands, else zero."""

    force: Values
    moment: Values
    start_s: float
    middle_s: float
    along_m: float  # where the pressure stands in mid-stance, from the belt's middle


def _step(forces: Recording, belt: str, after_s: float) -> _Step:
    """First step on a belt that begins after a time and ends within the recording."""
    loads = forces.selected([f"{belt}_{kind}{axis}" for kind in "fm" for axis in "xyz"]).values
    time, least = forces.time, 0.2 * forces.rate_hz
    stood = runs(loads[:, 2] > STANDS_N)
    first, end = next((a, b) for a, b in stood if time[a] > after_s and b < len(loads) and b - a > least)
    stands = np.zeros((len(loads), 1))
    stands[first:end] = 1.0
    force, moment, middle = loads[:, :3] * stands, loads[:, 3:] * stands, (first + end) // 2
    middle_s = float(0.5 * (time[first] + time[end - 1]))
    along_m = float(-moment[middle, 1] / force[middle, 2])
    return _Step(force, moment, float(time[first]), middle_s, along_m)
