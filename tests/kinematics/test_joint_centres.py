"""Joint centres against published equations, a file's own numbers and right angles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gaitdisc.errors import ShapeError
from gaitdisc.ingest.c3d_kinetics import read_body_measures
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.pose import DavisHip, chord_centre, harrington_hip, hip_of_spines


def test_harrington_has_the_numbers_of_the_paper():
    """x = -0.24 PD - 9.9, y = -0.30 PW - 10.9, z = 0.33 PW + 7.3 mm, for PW 240 mm and PD 150 mm."""
    np.testing.assert_allclose(harrington_hip(0.240, 0.150, "r"), [-0.0459, -0.0829, 0.0865], atol=1e-12)
    np.testing.assert_allclose(harrington_hip(0.240, 0.150, "l"), [-0.0459, -0.0829, -0.0865], atol=1e-12)


@pytest.mark.parametrize("side", ["l", "r"])
def test_the_hip_goes_with_the_pelvis(side):
    """Spines 240 mm apart and 150 mm deep, turned by 30 deg and carried: the same point of the pelvis."""
    turn = np.array(
        [
            [math.cos(math.pi / 6), 0, math.sin(math.pi / 6)],
            [0, 1, 0],
            [-math.sin(math.pi / 6), 0, math.cos(math.pi / 6)],
        ]
    )
    spines = np.array([[0, 0, -0.12], [0, 0, 0.12], [-0.15, 0, 0]])
    frames = np.stack([spines, spines @ turn.T + 1.0])
    found = hip_of_spines(*np.swapaxes(frames, 0, 1), side)
    point = harrington_hip(0.240, 0.150, side)
    np.testing.assert_allclose(found, [point, turn @ point + 1.0], atol=1e-12)


@pytest.mark.parametrize("person", ["HC030A", "HC031A"])
def test_hips_are_where_a_laboratory_s_own_model_has_them(gait_data, person):
    """The static files hold hips by Harrington and by Davis, computed by the laboratory's software."""
    path = gait_data / "young_static" / person / f"{person}01.c3d"
    markers, measures = read_trial(path).stream("markers"), read_body_measures(path)
    place = {
        name: np.stack([markers[f"{name}.{axis}"] for axis in "xyz"], axis=1)
        for name in ("LASI", "RASI", "SACR", "LHJC", "RHJC", "LHJCHarrington", "RHJCHarrington")
    }
    middle = (place["LASI"] + place["RASI"]) / 2
    right = place["RASI"] - place["LASI"]
    up = np.cross(right, middle - place["SACR"])
    right, up = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (right, up))
    axes = np.stack([np.cross(up, right), up, right], axis=2)
    depth = float(np.median(np.linalg.norm(middle - place["SACR"], axis=1)))
    width, legs = measures.inter_asis_m, measures.leg_length_m
    assert width is not None
    assert measures.marker_diameter_m is not None
    for side in "lr":
        davis = DavisHip(width, (legs["l"] + legs["r"]) / 2, legs[side], measures.marker_diameter_m / 2)
        for name, ours in (("HJCHarrington", harrington_hip(width, depth, side)), ("HJC", davis.centre(side))):
            theirs = np.einsum("fji,fj->fi", axes, place[f"{side.upper()}{name}"] - middle)
            np.testing.assert_allclose(ours, np.median(theirs, axis=0), atol=1e-3, err_msg=f"{side} {name}")


def test_chord_makes_a_right_angle_in_the_plane():
    random = np.random.default_rng(0)
    for _ in range(20):
        hip, wand, lateral = random.normal(size=(3, 3))
        centre = chord_centre(hip, wand, lateral, 0.05)
        assert math.isclose(np.linalg.norm(lateral - centre), 0.05, rel_tol=1e-9)
        assert abs((hip - centre) @ (lateral - centre)) < 1e-9
        assert abs(np.cross(wand - hip, lateral - hip) @ (centre - hip)) < 1e-9
        across = np.cross(np.cross(wand - hip, lateral - hip), lateral - hip)
        assert (wand - hip) @ across * ((centre - hip) @ across) < 0  # on the side away from the wand


def test_a_marker_inside_of_the_joint_is_refused():
    with pytest.raises(ShapeError, match=r"0\.05 m.*above.*0\.06 m"):
        chord_centre(np.zeros(3), np.array([0, 0, 0.1]), np.array([0, -0.05, 0]), 0.06)


def test_a_wand_on_the_line_is_refused():
    with pytest.raises(ShapeError, match="0 m beside the line"):
        chord_centre(np.zeros(3), np.array([0, -0.2, 0]), np.array([0, -0.4, 0]), 0.06)
