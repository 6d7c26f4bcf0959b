"""Left and right: labels, and channels that follow the one or the other foot."""

import numpy as np
import pytest
from changed_trials import markers_at, with_column
from texts import says

from gaitdisc.channel import vocabulary
from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Recording, Strides
from gaitdisc.signals.sides import knee_peak_percent, load_findings, marker_side_findings, sway_findings, verify_sides


def right_strides(contacts, side="r"):
    return Strides(contacts[:-1], contacts[1:], side, "force")


def test_the_knee_of_the_side_peaks_in_swing(made):
    walk, contacts = made.walk(12)
    assert verify_sides(walk, right_strides(contacts)) == pytest.approx(70, abs=2)
    assert knee_peak_percent(walk, right_strides(contacts), "knee_angle_l") == pytest.approx(20, abs=2)


def test_swapped_sides_and_a_knee_of_the_other_sign_are_refused_with_what_was_seen(made):
    walk, contacts = made.walk(12)
    with pytest.raises(StrideError, match=r"knee_angle_l.*(19|20|21) %, knee_angle_r.*(69|70|71) %: left.*right"):
        verify_sides(walk, right_strides(contacts, "l"))
    with pytest.raises(StrideError, match="flexion is positive"):
        verify_sides(walk.with_values(-walk.values), right_strides(contacts))


def test_a_knee_that_bends_most_in_stance_is_stiff_where_the_other_swings(made):
    walk, contacts = made.walk(12)
    other = with_column(walk, "knee_angle_r", walk["knee_angle_l"])
    assert verify_sides(other, right_strides(contacts)) == pytest.approx(20, abs=2)


def test_a_stiff_or_missing_knee_tells_nothing(made):
    walk, contacts = made.walk(12)
    assert np.isnan(verify_sides(walk.with_values(walk.values / 100), right_strides(contacts)))
    with pytest.raises(ChannelError, match="knee_angle_r"):
        verify_sides(walk.selected(["hip_flexion_r"]), right_strides(contacts))


PLACES = {  # x forward, y to the left, z up [m]
    "RASI": (0.10, -0.12, 1.0), "LASI": (0.10, 0.12, 1.0), "RPSI": (-0.10, -0.05, 1.0), "LPSI": (-0.10, 0.05, 1.0),
    "RKNE": (0.0, -0.15, 0.5), "LKNE": (0.0, 0.15, 0.5), "RHEE": (0.0, -0.08, 0.05), "LHEE": (0.0, 0.08, 0.05),
}  # fmt: skip
TIME = np.arange(100) / 100


def markers(names):
    """Someone who stands; each marker lies where the one lies whose name it is given."""
    return markers_at(TIME, {name: np.tile(PLACES[of], (100, 1)) for name, of in names.items()})


def exchanged(name):
    return {"R": "L", "L": "R"}[name[0]] + name[1:]


def test_own_names_say_nothing_whichever_way_the_person_faces():
    right = markers({name: name for name in PLACES})
    assert marker_side_findings(right) == []
    turned = right.values.reshape(100, -1, 3) * [-1, -1, 1]
    assert marker_side_findings(right.with_values(turned.reshape(100, -1))) == []


def test_labels_of_the_other_side_are_named_with_their_distance():
    (finding,) = marker_side_findings(markers({name: exchanged(name) for name in PLACES}))
    assert (finding.severity, finding.channel) == ("warning", "RASI, LASI")
    assert says(finding.what, "left", "right", "3 of 3 pairs")
    assert says(finding.what, "RASI", "24 cm", "left", "LASI")


def test_legs_alone_are_seen_and_one_pair_is_not_enough():
    legs = {name: exchanged(name) if name[1:] in ("KNE", "HEE") else name for name in PLACES}
    (finding,) = marker_side_findings(markers(legs))
    assert says(finding.what, "2 of 3 pairs")
    assert marker_side_findings(markers({**legs, "RHEE": "RHEE", "LHEE": "LHEE"})) == []


def test_markers_without_a_pelvis_or_never_seen_say_nothing():
    seen = markers({name: name for name in PLACES})
    assert marker_side_findings(seen.with_values(np.full_like(seen.values, np.nan))) == []
    assert marker_side_findings(markers({"RHEE": "LHEE", "LHEE": "RHEE"})) == []


def pelvis(sway_m, heading_deg):
    """Ten strides of 1 s whose pelvis sways to the right while the right foot stands alone."""
    time = np.arange(1001) / 100
    right = sway_m * np.sin(2 * np.pi * time - 0.2)
    heading = np.radians(heading_deg)
    values = np.stack([right * np.sin(heading), right * np.cos(heading), np.full(1001, float(heading_deg))], axis=1)
    named = [vocabulary().named(name) for name in ("pelvis_tx", "pelvis_tz", "pelvis_rotation")]
    strides = [
        Strides(s + np.arange(9.0), s + 1 + np.arange(9.0), side, "angles") for side, s in (("r", 0), ("l", 0.5))
    ]
    return Recording(time, values, tuple(named)), strides


@pytest.mark.parametrize("heading", [0, 79, 180])
def test_a_pelvis_that_sways_away_from_the_foot_that_stands_is_of_the_other_side(heading):
    assert sway_findings(*pelvis(0.03, heading)) == []
    (finding,) = sway_findings(*pelvis(-0.03, heading))
    assert says(finding.what, "left", "right", "pelvis_tz points", "left")


def test_a_small_sway_or_one_foot_says_nothing():
    assert sway_findings(*pelvis(-0.002, 0)) == []
    walk, strides = pelvis(-0.03, 0)
    assert sway_findings(walk, strides[:1]) == []


def test_a_force_under_the_other_knee_is_named():
    time = np.arange(300) / 100
    stands = np.sin(2 * np.pi * time) > 0
    knees = np.where(np.stack([stands, ~stands], axis=1), 12.0, 45.0)
    angles = Recording(time, knees, tuple(vocabulary().named(f"knee_angle_{side}") for side in "rl"))
    loads = 700.0 * np.stack([stands, ~stands], axis=1)
    forces = Recording(time, loads, tuple(vocabulary().named(f"ground_force_{side}_vy") for side in "rl"))
    assert load_findings(angles, forces) == []
    (finding,) = load_findings(angles, forces.with_values(loads[:, ::-1]))
    assert says(finding.what, "left", "right")
    assert says(finding.what, "knee_angle_l +33 deg", "knee_angle_r +33 deg")
