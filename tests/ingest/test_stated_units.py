"""Units that a file states against its numbers: every planted mistake is found, no clean trial is accused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.channel import vocabulary
from gaitdisc.errors import UnitError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.stated_units import (
    distance_from_origin,
    find_copied_unit,
    per_kg_findings,
    plausible_unit,
    refuse_other_unit,
)
from gaitdisc.ingest.trc import read_trc
from gaitdisc.recording import Recording

TIME = np.arange(200) / 100
NAMES = ["pelvis_rotation", "hip_flexion_r", "knee_angle_r", "ankle_angle_r"]


def _walk_deg(hip=22.0, knee=30.0):
    turn = 2 * np.pi * TIME
    return np.column_stack([400 * TIME, hip * np.cos(turn) + 5, knee * (1 - np.cos(2 * turn)), 12 * np.sin(turn)])


@given(st.floats(10, 30), st.floats(20, 40))
def test_walking_is_recognised_and_mistakes_are_refused(hip, knee):
    degrees = _walk_deg(hip, knee)
    radians = np.radians(degrees)
    assert plausible_unit(TIME, degrees, NAMES, "deg", "a.mot") == ("deg", None)
    assert plausible_unit(TIME, radians, NAMES, "rad", "a.mot") == ("rad", None)
    assert plausible_unit(TIME, degrees, NAMES, None, "a.mot")[0] == "deg"
    assert plausible_unit(TIME, radians, NAMES, None, "a.mot")[0] == "rad"
    with pytest.raises(UnitError):
        plausible_unit(TIME, degrees, NAMES, "rad", "a.mot")
    with pytest.raises(UnitError):
        plausible_unit(TIME, radians, NAMES, "deg", "a.mot")


def test_the_words_name_channel_and_number():
    with pytest.raises(UnitError, match=r"inDegrees=no\).*6\.28 rad; knee_angle_r.*60"):
        plausible_unit(TIME, _walk_deg(), NAMES, "rad", "a.mot")
    with pytest.raises(UnitError, match=r"a\.mot.*2\.5.*1\.04"):
        plausible_unit(TIME, np.radians(_walk_deg()), NAMES, "deg", "a.mot")


def test_a_silent_header_is_reported_and_standing_still_is_refused():
    finding = plausible_unit(TIME, _walk_deg(), NAMES, None, "a.mot")[1]
    assert finding is not None and says(finding.what, "(largest joint angle 60)")
    with pytest.raises(UnitError, match=r"largest joint angle.*0"):
        plausible_unit(TIME, np.zeros((200, 4)), NAMES, None, "a.mot")
    with pytest.raises(UnitError, match="joint angle of the file"):
        plausible_unit(TIME, _walk_deg()[:, :1], NAMES[:1], None, "a.mot")


def test_standing_in_degrees_and_a_turning_pelvis_are_not_accused():
    standing = np.tile([90.0, 3.0, 2.0, 1.0], (200, 1)) + 0.1 * np.sin(TIME)[:, None]
    assert plausible_unit(TIME, standing, NAMES, "deg", "a.mot") == ("deg", None)
    turning = np.radians(_walk_deg())
    assert turning[:, 0].max() > 7
    assert plausible_unit(TIME, turning, NAMES, "rad", "a.mot") == ("rad", None)


@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_an_arm_that_winds_on_and_a_fit_that_lost_its_markers_hide_no_unit(unit):
    degrees = np.column_stack([_walk_deg(), 300 * TIME])
    degrees[-8:, 1] += 170  # the hip of the last frames, as a fit without markers has it
    names = [*NAMES, "arm_rot_r"]
    values = degrees if unit == "deg" else np.radians(degrees)
    assert np.abs(np.radians(degrees[:, -1])).max() > 2 * np.pi
    assert plausible_unit(TIME, values, names, unit, "a.mot") == (unit, None)
    with pytest.raises(UnitError):
        plausible_unit(TIME, values, names, "rad" if unit == "deg" else "deg", "a.mot")


def test_ankles_alone_leave_a_doubt_not_a_refusal():
    unit, finding = plausible_unit(TIME, 0.5 * np.sin(9 * TIME)[:, None], ["ankle_angle_r"], "deg", "a.mot")
    assert unit == "deg" and finding is not None and finding.kind == "unit in doubt"


def test_a_copied_coordinate_follows_its_knee_in_either_unit():
    knee = _walk_deg()[:, 2]
    angles = {"knee_angle_r": knee}
    assert find_copied_unit("knee_angle_r_beta", np.radians(knee), angles) == "rad"
    assert find_copied_unit("knee_angle_r_beta", knee, angles) == "deg"
    assert find_copied_unit("knee_angle_r_beta", knee[::-1] ** 2, angles) is None
    assert find_copied_unit("knee_angle_l_beta", knee, angles) is None
    assert find_copied_unit("knee_angle_r_beta", np.full(200, np.nan), angles) is None


def belt(peak_n, pattern=((60, 1.0), (40, 0.0))):
    steps = np.concatenate([np.full(count, peak_n * share) for count, share in pattern] * 3)[:, None]
    return {"forces": Recording(np.arange(len(steps)) / 100, steps, (vocabulary().named("ground_force_r_vy"),))}


def test_a_step_of_ten_newtons_is_per_kg():
    (finding,) = per_kg_findings(belt(10.8))
    assert (finding.kind, finding.channel) == ("per body mass", "ground_force_r_vy")
    assert says(finding.what, "10.8 N", "steps")


@pytest.mark.parametrize("peak", [60.0, 700.0, 2.0])
def test_a_child_an_adult_and_noise_are_not(peak):
    assert per_kg_findings(belt(peak)) == []


def test_drift_of_an_empty_plate_is_no_step():
    assert per_kg_findings(belt(10.0, ((200, 1.0),))) == []


def test_the_moments_of_a_real_walk_are_in_newton_metres_until_divided_by_its_mass(gait_data):
    trial = read_trial(gait_data.parent / "opensim_gait10dof" / "ID" / "Results" / "subject01_walk_ID.sto")
    moments = trial.stream("moments")
    assert per_kg_findings(trial.streams) == []
    (finding,) = per_kg_findings({"moments": moments.with_values(moments.values / 72.6)})
    assert says(finding.what, "seems to be N m per kg")


def test_millimetres_called_metres_and_the_other_way_round_are_refused():
    with pytest.raises(UnitError, match=r"15 m.*1500 m away.*mm"):
        refuse_other_unit("m", 1500.0, "a.trc", "Units in line 3")
    for metres in (0.5, 1.5, 7.0):  # a walkway may be long, or lie far from the origin
        with pytest.raises(UnitError, match=rf"15 mm.*{metres:g} mm away.*line 3"):
            refuse_other_unit("mm", metres, "a.trc", "Units in line 3")
    refuse_other_unit("mm", 1500.0, "a.trc", "")
    refuse_other_unit("m", float("nan"), "a.trc", "")


def test_the_far_end_counts_and_gaps_do_not():
    assert np.isnan(distance_from_origin(np.full((3, 3), np.nan)))
    assert distance_from_origin(np.array([[np.nan, -2.0]])) == 2.0


def test_a_real_trc_whose_header_states_the_other_unit_is_refused(gait_data, tmp_path):
    source = gait_data.parent / "opensim_gait10dof" / "ExperimentalData" / "subject01_walk.trc"
    lines = source.read_text().splitlines()
    assert "\tmm\t" in lines[2]
    lines[2] = lines[2].replace("\tmm\t", "\tm\t")
    path = tmp_path / "walk.trc"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(UnitError, match="which looks like mm"):
        read_trc(path)
