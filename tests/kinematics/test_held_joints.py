"""Segments held together at their joints: against an independent minimiser, and against skin that slides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from manufactured_body import RAJAGOPAL, known_angles, markers_of, static_of
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.calibration import calibrated
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.motion import Motion, joint_angles, motion
from gaitdisc.kinematics.pose import SEGMENTS
from gaitdisc.recording import Recording

HELD = marker_set("rajagopal")
FREE = HELD.with_joints("free")
FLEXIONS = ("hip_flexion", "knee_angle", "ankle_angle")
ANGLES = known_angles(60)
CALIBRATION = calibrated(static_of(RAJAGOPAL), HELD)
PLANAR = calibrated(static_of(RAJAGOPAL), HELD.with_joints("planar"))
JOINTS = {"thigh": "hip", "shank": "knee", "foot": "ankle"}


def shaken(markers: Recording, seed: int, size: float = 0.008) -> Recording:
    return markers.with_values(markers.values + size * np.random.default_rng(seed).normal(size=markers.values.shape))


def slid(markers: Recording, amplitude: float) -> Recording:
    """The markers of both thighs go up and forward on the skin together, once a stride."""
    values = np.array(markers.values)
    wave = amplitude * np.sin(np.linspace(0, 4 * np.pi, len(values)))
    for side in "LR":
        for name in ("TH1", "TH2", "TH3", "LFC"):
            values[:, markers.index(f"{side}{name}.x")] += wave
    return markers.with_values(values)


def joints_apart(found: Motion) -> float:
    apart = []
    for segment in SEGMENTS[1:]:
        joint = JOINTS[segment[:-2]] + segment[-2:]
        inside = found.poses[segment].to_laboratory(CALIBRATION.points[segment][joint])
        apart.append(np.linalg.norm(inside - found.joint_centres[joint], axis=1).max())
    return max(apart)


def test_joints_do_not_part():
    markers = shaken(markers_of(known_angles(40), RAJAGOPAL), 0)
    assert joints_apart(motion(markers, CALIBRATION)) < 1e-9
    assert joints_apart(motion(markers, replace(CALIBRATION, marker_set=FREE))) > 1e-3


def test_the_squares_are_the_least_that_an_independent_minimiser_finds():
    """Place of the pelvis and seven rotation vectors, minimised by scipy from the same rigid bodies."""
    markers = shaken(markers_of(known_angles(40), RAJAGOPAL), 1).between(0.2, 0.205)
    found = motion(markers, CALIBRATION, (1, 0, 0))

    def apart(numbers: np.ndarray) -> np.ndarray:
        turns = {segment: Rotation.from_rotvec(numbers[3 + 3 * i : 6 + 3 * i]) for i, segment in enumerate(SEGMENTS)}
        origins, left = {"pelvis": numbers[:3]}, []
        for segment in SEGMENTS:
            if segment != "pelvis":
                part, side = segment.split("_")
                above = {"thigh": "pelvis", "shank": f"thigh_{side}", "foot": f"shank_{side}"}[part]
                joint = f"{JOINTS[part]}_{side}"
                origins[segment] = origins[above] + turns[above].apply(CALIBRATION.points[above][joint])
            for name, place in CALIBRATION.body[segment].items():
                if f"{name}.x" in markers.names:
                    seen = np.array([markers[f"{name}.{axis}"][0] for axis in "xyz"])
                    left.append(origins[segment] + turns[segment].apply(place) - seen)
        return np.concatenate(left)

    start = np.concatenate(
        [found.poses["pelvis"].origin[0]]
        + [Rotation.from_matrix(found.poses[segment].rotation[0]).as_rotvec() for segment in SEGMENTS]
    )
    best = least_squares(apart, start + 0.05, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    np.testing.assert_allclose((apart(start) ** 2).sum(), 2 * best.cost, rtol=1e-9)


def test_a_body_that_moves_in_a_plane_is_followed_in_it():
    """Out of the plane nothing is reported; in it the angles are exact though the markers shake across it."""
    known = {name: values * (name[:-2] in FLEXIONS or name == "pelvis_tilt") for name, values in ANGLES.items()}
    markers = markers_of(known, RAJAGOPAL)
    across = np.array([name.endswith(".z") for name in markers.names])
    shaking = 0.008 * np.random.default_rng(2).normal(size=markers.values.shape) * across
    found = motion(markers.with_values(markers.values + shaking), PLANAR, (1, 0, 0)).angles
    assert set(found.names) == {*(f"{name}_{side}" for name in FLEXIONS for side in "rl"), "pelvis_tilt",
                                "pelvis_tx", "pelvis_ty"}  # fmt: skip
    for name in set(found.names) & set(known):
        np.testing.assert_allclose(found[name], known[name], atol=1e-8, err_msg=name)


def test_a_planar_body_agrees_with_opensim_s_planar_model(gait_data):
    """gait10dof's own inverse kinematics of the same markers: after the mean difference, sagittal rms <= 3 deg."""
    folder = gait_data.parent / "opensim_gait10dof"
    if not folder.is_dir():
        pytest.skip(f"real recordings are absent: {folder}")
    files = (folder / "ExperimentalData" / "subject01_static.trc", folder / "ExperimentalData" / "subject01_walk.trc")
    static, walk = (read_trial(file).stream("markers") for file in files)
    theirs = read_trial(folder / "IK" / "subject01_walk_IK.mot").stream("kinematics")
    ours = joint_angles(walk, static, joints="planar")
    for name in ("pelvis_tilt", *(f"{flexion}_{side}" for flexion in FLEXIONS for side in "rl")):
        apart = ours[name] - np.interp(walk.time, theirs.time, theirs[name])
        assert apart.std() <= 3.0, f"{name} {apart.std():.2f} deg"


def test_a_thigh_laid_over_sliding_skin_leaves_its_hip_and_a_held_one_does_not():
    """The thigh's markers slide by 15 mm: as one body they shift, but the hip does not follow."""
    known = known_angles(100)
    markers = slid(markers_of(known, RAJAGOPAL), 0.015)
    errors = {}
    for name, chosen in (("held", HELD), ("free", FREE)):
        found = motion(markers, replace(CALIBRATION, marker_set=chosen), (1, 0, 0))
        centre = found.poses["thigh_r"].origin - found.joint_centres["hip_r"]
        errors[name] = np.linalg.norm(centre, axis=1).max()
    assert errors["held"] < 1e-9
    np.testing.assert_allclose(errors["free"], 0.015, rtol=0.05)
