"""Landmarks of a standing person: right labels contradict nothing, every exchange of two does and is named."""

import itertools

import numpy as np
import pytest
from manufactured_body import PLUG_IN_GAIT, static_of

from gaitdisc.kinematics.calibration import exchanged_in_static, landmark_order
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.markers import marker_labels, marker_places

UP = np.array([0.0, 1.0, 0.0])
PIG = marker_set("plug_in_gait")


@pytest.fixture(scope="module")
def places():
    static = static_of(PLUG_IN_GAIT)
    names = PIG.names(marker_labels(static))
    return dict(zip(names, marker_places(static, list(names.values()))[0], strict=True))


def test_a_standing_person_contradicts_nothing(places):
    assert min(landmark_order(PIG, places, UP))[0] > 0


def test_exchanges_of_two_plug_in_gait_markers_are_found_and_named(places):
    for pair in [*itertools.combinations(places, 2)][::4]:
        wrong = {**places, pair[0]: places[pair[1]], pair[1]: places[pair[0]]}
        assert min(landmark_order(PIG, wrong, UP))[0] <= 0, pair
        assert exchanged_in_static(PIG, wrong, UP) == pair


@pytest.mark.parametrize("turn_deg", [-70, -30, 30, 70])
def test_feet_that_turn_out_or_in_are_no_exchange(places, turn_deg):
    angle = np.radians(turn_deg)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    turned = dict(places)
    for side, way in (("R", turn), ("L", turn.T)):
        for name in ("HEE", "TOE"):
            turned[side + name] = places[f"{side}ANK"] + way @ (places[side + name] - places[f"{side}ANK"])
    assert not [what for value, what in landmark_order(PIG, turned, UP) if value <= 0 and "ahead" in what]
