"""Thighs that are circled about known hips show these, under skin that slides too; too small a movement is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from manufactured_body import MEASURES, PLUG_IN_GAIT, RAJAGOPAL, known_angles, markers_of, static_of
from texts import says

from gaitdisc.kinematics.calibration import calibrated
from gaitdisc.kinematics.functional_hips import functional_hips, sphere_centre
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.motion import motion
from gaitdisc.recording import Recording

BODIES = {"plug_in_gait": PLUG_IN_GAIT, "rajagopal": RAJAGOPAL}
TIME = np.arange(1500) / 100


def circled(name: str, flexion: float = 25.0, adduction: float = 20.0) -> Recording:
    """Each leg drawn to the front and the back, to the side, and round, knees straight."""
    turn = 2 * np.pi * TIME / 5
    angles = {key: np.zeros(len(TIME)) for key in known_angles(2)}
    for side in "rl":
        angles[f"hip_flexion_{side}"] = flexion * np.sin(turn)
        angles[f"hip_adduction_{side}"] = adduction * np.sin(turn * 1.5 + 0.4) - 5
        angles[f"hip_rotation_{side}"] = 5 * np.sin(turn * 0.5)
    angles["pelvis_tilt"] = 6 * np.sin(turn + 1)
    return markers_of(angles, BODIES[name], speed=0.0, file="circles.c3d")


def body(name: str, wrong_m: float = 0.0):
    """Calibration of a person whose hips the landmarks place by so much beside where they are, and the true hips."""
    right = calibrated(static_of(BODIES[name]), marker_set(name).with_hip("harrington"), MEASURES)
    true = {joint: place for joint, place in right.points["pelvis"].items() if joint.startswith("hip")}
    points = dict(right.points)
    points["pelvis"] = {k: place + wrong_m * (k in true) for k, place in right.points["pelvis"].items()}
    return type(right)(right.marker_set, right.body, points, right.static), true


@pytest.mark.parametrize("name", BODIES)
def test_known_hips_are_found_whatever_the_landmarks_say(name):
    calibration, true = body(name, wrong_m=0.012)
    hips, findings = functional_hips(circled(name), calibration)
    for joint, place in true.items():
        np.testing.assert_allclose(hips[joint], place, atol=1e-5)
    assert [finding.kind for finding in findings] == ["functional hip"] * 2
    assert says(findings[0].what, "21 mm", "after the landmarks")


@pytest.mark.parametrize(("skin_mm", "within_mm"), [(1.0, 3.0), (5.0, 13.0)])
def test_sliding_skin_moves_them_by_millimetres(skin_mm, within_mm):
    random = np.random.default_rng(3)
    markers = circled("rajagopal")
    values = np.array(markers.values)
    for column, channel in enumerate(markers.channels):
        if channel.name.startswith(("RTH", "LTH", "RLFC", "LLFC", "RMFC", "LMFC")):
            phase = random.uniform(0, 2 * np.pi, 2)
            slid = np.sin(2 * np.pi * TIME / 5 + phase[0]) + np.sin(4 * np.pi * TIME / 5 + phase[1])
            values[:, column] += skin_mm / 1000 * slid
    calibration, true = body("rajagopal")
    hips, _ = functional_hips(markers.with_values(values), calibration)
    apart = [1000 * np.linalg.norm(hips[joint] - place) for joint, place in true.items()]
    assert max(apart) < within_mm


def test_noise_of_the_cameras_gives_no_bias():
    random = np.random.default_rng(0)
    way = random.normal(size=(20_000, 3)) * [0.3, 0.05, 0.2] + [0, -1, 0]
    way = 0.4 * way / np.linalg.norm(way, axis=1, keepdims=True)
    noisy = way[:, None] + random.normal(scale=0.003, size=(20_000, 1, 3))
    assert np.linalg.norm(sphere_centre(noisy, np.array([0.02, 0.02, 0.02])).centre) < 4e-4


@pytest.mark.parametrize(
    ("flexion", "adduction", "words"),
    [(25.0, 2.0, r"turns by \d\.\d deg \(rms\) at right angles"), (3.0, 2.0, "turns by"), (0.0, 0.0, "turns by")],
)
def test_one_plane_or_none_keeps_the_hip_of_the_landmarks(flexion, adduction, words):
    calibration, _ = body("rajagopal")
    hips, findings = functional_hips(circled("rajagopal", flexion, adduction), calibration)
    assert not hips
    for finding in findings:
        assert finding.severity == "warning" and says(finding.what, "not", "function but after")
        assert re.search(words, finding.what)


def test_a_body_calibrated_with_them_has_its_joints_there():
    _, true = body("rajagopal")
    moved = {joint: place + np.array([0.01, -0.01, 0.0]) for joint, place in true.items()}
    found = calibrated(static_of(RAJAGOPAL), marker_set("rajagopal"), MEASURES, moved)
    for joint, place in moved.items():
        np.testing.assert_allclose(found.points["pelvis"][joint], place, atol=1e-12)
    standing = motion(static_of(RAJAGOPAL), found)
    assert abs(standing.angles["hip_flexion_r"]).max() > 0.5  # thigh axes end in the hip
