"""Faults planted into real walks: each is said and left out, and walks that are right, or only unusual, keep all."""

import numpy as np
import pytest
from changed_trials import with_labels_exchanged, with_stream
from texts import says

from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.two_sources import KIND, line_angles, without_contradicted
from gaitdisc.recording import Trial


@pytest.fixture(scope="module")
def plug_in_gait(gait_data) -> Trial:
    """Markers, and the angles, moments and powers that Plug-in Gait made of them."""
    return read_trial(gait_data / "young_straight_and_turn" / "HC031A" / "straight" / "HC031A06.c3d")


@pytest.fixture(scope="module")
def tables(gait_data) -> Trial:
    """Angles, generalised moments and forces of OpenSim, without markers."""
    folder = gait_data / "opensim_walks" / "moco_3dwalking"
    return read_trial([folder / name for name in ("coordinates.sto", "id_walk.sto", "grf_walk.mot")])


def planted(trial: Trial, change, *names: str, stream: str = "kinematics") -> Trial:
    old = trial.stream(stream)
    values = np.array(old.values)
    for name in names:
        values[:, old.index(name)] = change(old[name])
    return with_stream(trial, stream, old.with_values(values))


def said_of(trial: Trial):
    """Findings, and the channels that are gone."""
    checked = without_contradicted(trial)
    gone = {
        name
        for key, old in trial.streams.items()
        for name in old.names
        if key not in checked.streams or name not in checked.stream(key).names
    }
    return [finding for finding in checked.findings if finding.kind == KIND], gone


def test_walks_that_are_right_keep_every_channel(plug_in_gait, tables, gait_data):
    others = [
        *sorted(gait_data.glob("young_straight_and_turn/HC0[03]*[AD]/straight/*.c3d"))[:2],
        *sorted(gait_data.glob("treadmill_walk_ik/*.mot")),
    ]
    for trial in (plug_in_gait, tables, *map(read_trial, others)):
        assert said_of(trial) == ([], set())


def test_lines_between_markers_follow_the_files_angles(plug_in_gait):
    angles, lines = plug_in_gait.stream("kinematics"), line_angles(plug_in_gait.stream("markers"))
    assert len(lines) == 8
    for name, line in lines.items():
        known = np.isfinite(line) & np.isfinite(angles[name])
        slope, _ = np.polyfit(line[known], angles[name][known], 1)
        assert np.corrcoef(line[known], angles[name][known])[0, 1] > 0.98
        assert 0.9 < slope < 1.3


@pytest.mark.parametrize(
    "name", ["hip_flexion_l", "knee_angle_r", "ankle_angle_l", "hip_adduction_r", "hip_rotation_r"]
)
def test_one_angle_in_radians_is_left_out(plug_in_gait, tables, name):
    for trial in (plug_in_gait, tables):
        (finding,), gone = said_of(planted(trial, np.radians, name))
        assert (finding.severity, finding.channel, gone) == ("refused", name, {name})
        assert says(finding.what, "less", "seems to be in rad")


def test_a_whole_file_in_radians_loses_its_pelvis_and_headings_too(plug_in_gait):
    names = [channel.name for channel in plug_in_gait.stream("kinematics").channels]
    (finding,), gone = said_of(planted(plug_in_gait, np.radians, *names))
    assert finding.channel.count(",") == 5 and "seems to be in rad" in finding.what
    assert {"hip_flexion_l", "LPelvisAngles.x", "RPelvisAngles.z", "RFootProgressAngles.z"} <= gone


@pytest.mark.parametrize("names", [["hip_flexion_r"], ["hip_flexion_l"], ["hip_flexion_l", "hip_flexion_r"]])
def test_a_hip_of_turned_sign_is_left_out(plug_in_gait, tables, names):
    for trial in (plug_in_gait, tables):
        findings, gone = said_of(planted(trial, np.negative, *names))
        assert gone == set(names)
        assert all("sign is wrong" in finding.what for finding in findings)


def test_an_offset_of_one_knee_is_left_out_where_markers_do_not_show_it(plug_in_gait, tables):
    (finding,), gone = said_of(planted(plug_in_gait, lambda knee: knee + 20, "knee_angle_l"))
    assert (finding.channel, gone) == ("knee_angle_l", {"knee_angle_l"})
    assert says(finding.what, "knee_angle_l", "+18 deg", "knee_angle_r -8 deg")
    asymmetric = planted(tables, lambda knee: knee + 20, "knee_angle_l")
    assert said_of(asymmetric) == ([], set())  # without markers it is how the person walks


def test_moments_of_a_thousandth_are_left_out(plug_in_gait, tables):
    for trial, unit in ((plug_in_gait, "N m/kg"), (tables, "N m")):
        legs = [n for n in trial.stream("moments").names if n.startswith(("hip", "knee", "ankle")) and "moment" in n]
        small = planted(trial, lambda moment: moment / 1000, *legs, stream="moments")
        (finding,), gone = said_of(small)
        assert set(legs) <= gone
        assert says(finding.what, f"{unit}", "at least", "the unit is wrong")
        one = planted(trial, lambda moment: moment / 1000, "knee_angle_l_moment", stream="moments")
        (finding,), gone = said_of(one)
        assert gone == {finding.channel} == {"knee_angle_l_moment"}


def test_power_against_moment_times_rate_shows_a_turned_and_a_large_moment(plug_in_gait):
    for change, words in ((np.negative, "but is -0.96"), (lambda moment: 100 * moment, "is 0.00966 times")):
        (finding,), gone = said_of(planted(plug_in_gait, change, "hip_flexion_l_moment", stream="moments"))
        assert words in finding.what
        assert {"hip_flexion_l_moment", "hip_adduction_l_moment", "hip_power_l"} <= gone
        assert not {name for name in gone if name.endswith("_r") or "_r_" in name}


def test_one_moment_a_thousand_times_the_others_is_the_one_left_out(tables):
    (finding,), gone = said_of(planted(tables, lambda m: 1000 * m, "knee_angle_r_moment", stream="moments"))
    assert gone == {finding.channel} == {"knee_angle_r_moment"}


def test_moments_of_turned_sign_are_left_out_without_powers(tables):
    for name, beside in (("hip_flexion_r", "hip_flexion_r"), ("ankle_angle_l", "ground_force_l_vy")):
        (finding,), gone = said_of(planted(tables, np.negative, f"{name}_moment", stream="moments"))
        assert gone == {f"{name}_moment"}
        assert finding.what.startswith(f"{name}_moment correlates with {beside} (r = 0.")


def test_an_unusual_joint_keeps_its_curves(tables, plug_in_gait):
    stiff = planted(tables, lambda knee: 5 + 0.1 * (knee - knee.mean()), "knee_angle_r")
    fused = planted(tables, lambda ankle: 7 + 0.02 * ankle, "ankle_angle_l")
    crouch = planted(
        planted(tables, lambda knee: knee + 30, "knee_angle_l", "knee_angle_r"), lambda hip: hip + 25, "hip_flexion_l"
    )
    equinus = planted(tables, lambda ankle: 0.3 * ankle - 25, "ankle_angle_r")
    for unusual in (stiff, fused, crouch, equinus):
        assert said_of(unusual) == ([], set())


@pytest.mark.parametrize("pair", [("RHEE", "RTOE"), ("RHEE", "LHEE"), ("RKNE", "LKNE"), ("RASI", "LASI")])
def test_labels_exchanged_for_half_a_second_cost_no_angle_of_the_file(plug_in_gait, pair):
    assert said_of(with_labels_exchanged(plug_in_gait, pair, slice(60, 110))) == ([], set())


def test_a_person_who_stands_keeps_every_channel(gait_data):
    for person in ("HC030A", "HC031A"):
        assert said_of(read_trial(gait_data / "young_static" / person / f"{person}01.c3d")) == ([], set())
