"""From a trial to moments and powers, and the balance of forces that tells whether they can be right."""

from dataclasses import replace

import numpy as np
import pytest
from plug_in_gait_bones import bones, feet
from texts import says

from gaitdisc.errors import ChannelError
from gaitdisc.ingest.c3d import read_c3d
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import FootLoad, KineticsSettings, legs
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.kinetics.plate_steps import FootPath
from gaitdisc.kinetics.platform import Wrench
from gaitdisc.kinetics.trial_kinetics import ForceBalance, force_balance, trial_kinetics

# Mass as PROCESSING states it; both plates of each straight walk are clean
WALKS = {"HC002D/straight/HC002D06": 32.1, "HC030A/straight/HC030A05": 45.8, "HC036A/turn/HC036A23": 33.0}


def apart(trial, result, name):
    """Rms difference from the file, per kg and turned at ingest to internal, over the clean steps [N m/kg or W/kg]."""
    over = []
    for step in result.steps:
        if not step.clean:
            continue
        rows = (result.moments.time >= step.start) & (result.moments.time <= step.end)
        mine = result.moments[name.format(s=step.side)][rows]
        theirs = trial.stream("moments")[name.format(s=step.side)][rows]
        there = np.isfinite(mine) & (theirs != 0)
        assert there.sum() > 30
        over.append(float(np.sqrt(np.mean((mine - theirs)[there] ** 2))))
    return max(over)


@pytest.mark.parametrize("walk", WALKS)
def test_sagittal_moments_and_powers_are_those_of_plug_in_gait(gait_data, walk):
    trial = read_c3d(gait_data / "young_straight_and_turn" / f"{walk}.c3d")
    result = trial_kinetics(trial, bones(trial), feet(trial), Person(WALKS[walk]))
    for name, limit in {"ankle_angle": 0.03, "knee_angle": 0.09, "hip_flexion": 0.12}.items():
        assert apart(trial, result, name + "_{s}_moment") < limit, name
    for joint, limit in {"ankle": 0.3, "knee": 0.15, "hip": 0.2}.items():
        assert apart(trial, result, joint + "_power_{s}") < limit, joint


def test_in_the_distal_frame_all_parts_are_those_of_plug_in_gait(gait_data):
    trial = read_c3d(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d")
    result = trial_kinetics(
        trial, bones(trial), feet(trial), Person(45.8), KineticsSettings(20.0, np.inf, frame="distal")
    )
    for joint, other in (("ankle", "inversion"), ("knee", "adduction"), ("hip", "adduction")):
        for name in (f"{joint}_{other}", f"{joint}_rotation"):
            assert apart(trial, result, name + "_{s}_moment") < 0.05, name


def test_an_adult_of_another_laboratory_on_three_plates(gait_data):
    trial = read_c3d(gait_data / "c3d_reader_samples" / "gait" / "PiG_Motion3_FF.c3d")
    result = trial_kinetics(trial, bones(trial), feet(trial), Person(74.0), KineticsSettings(frame="distal"))
    assert [(step.platform, step.side, step.clean) for step in result.steps] == [
        ("plate_1", "l", True),
        ("plate_2", "r", True),
        ("plate_3", "l", True),
    ]
    limits = {
        "ankle_angle": 0.03,
        "knee_angle": 0.05,
        "hip_flexion": 0.1,
        "knee_adduction": 0.03,
        "hip_adduction": 0.05,
    }
    for name, limit in limits.items():
        assert apart(trial, result, name + "_{s}_moment") < limit, name


def test_a_straight_walk_pushes_off_and_says_what_it_rests_on(gait_data):
    trial = read_c3d(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d")
    result = trial_kinetics(trial, bones(trial), feet(trial), Person(45.8))
    for side in "rl":
        assert -1.5 < np.nanmin(result.moments[f"ankle_angle_{side}_moment"]) < -1.0
        assert 2.0 < np.nanmax(result.moments[f"ankle_power_{side}"]) < 5.0
    assert [(step.side, step.clean) for step in result.steps] == [("r", True), ("l", True)]
    assert [finding.kind for finding in result.findings] == ["force balance"]
    assert result.moments.source.file == "HC030A05.c3d"


def test_a_turn_keeps_the_clean_step_and_names_the_other(gait_data):
    trial = read_c3d(gait_data / "young_straight_and_turn" / "HC032A" / "turn" / "HC032A18.c3d")
    result = trial_kinetics(trial, bones(trial), feet(trial), Person(56.8))
    left_out = next(step for step in result.steps if not step.clean)
    rows = (result.moments.time > left_out.start) & (result.moments.time < left_out.end)
    assert left_out.side == "l"
    assert np.isnan(result.moments["ankle_angle_l_moment"][rows]).all()
    assert says(result.findings[0].line(), "8 cm beyond the plate's edge")


def test_a_trial_without_a_clean_step_or_without_forces_is_refused(gait_data):
    trial = read_c3d(gait_data / "young_static" / "HC030A" / "HC030A01.c3d")
    with pytest.raises(ChannelError, match=r"one foot must step alone.*HC030A01.c3d.*plate_1.*0.00 s"):
        trial_kinetics(trial, {}, feet(trial), Person(45.8))
    trial = read_c3d(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d")
    markers = replace(trial, streams={"markers": trial.stream("markers")})
    with pytest.raises(ChannelError, match=r"forces.*markers"):
        trial_kinetics(markers, bones(trial), feet(trial), Person(45.8))


TIME = np.arange(100) / 100
UP = np.array([0.0, 1.0, 0.0])
RAW = KineticsSettings(np.inf, np.inf)


def bobbing(person, share=0.5):
    """Someone who moves up and down as a whole by 2 cm at 2 Hz, on two feet, without turning anything."""
    bob = np.outer(0.02 * np.sin(4 * np.pi * TIME), UP)
    upright = np.tile(np.eye(3), (len(TIME), 1, 1))
    poses = {"pelvis": Pose(np.add(bob, [0, 1.0, 0]), upright)}
    paths = {}
    for side, z in (("r", 0.1), ("l", -0.1)):
        for segment, y in (("thigh", 0.93), ("shank", 0.52), ("foot", 0.1)):
            poses[f"{segment}_{side}"] = Pose(np.add(bob, [0, y, z]), upright)
        paths[side] = FootPath(side, TIME, np.add(bob, [-0.05, 0.03, z]), np.add(bob, [0.13, 0.04, z]))
    force = person.kg * (GRAVITY + -0.02 * (4 * np.pi) ** 2 * np.sin(4 * np.pi * TIME))[:, None] * UP
    known = np.full(len(TIME), True)
    loads = {s: FootLoad(Wrench.at(np.zeros(3), force * w), known) for s, w in (("r", share), ("l", 1 - share))}
    return legs(poses, paths, person, RAW), loads


def test_a_body_that_moves_as_one_is_balanced():
    person = Person(64.0, "f")
    balance = force_balance(*bobbing(person, 0.7), UP, person)
    assert (balance.frames, balance.rms, balance.level_rms) == pytest.approx((96, 0.0, 0.0), abs=0.01)
    assert balance.finding("a.c3d").severity == "note"


def test_a_wrong_mass_shows_as_a_mean():
    found, loads = bobbing(Person(64.0, "f"))
    wrong = Person(80.0, "f")
    poses = {
        f"{k}_{side}" if k != "pelvis" else k: m.pose for side, leg in found.items() for k, m in leg.moving.items()
    }
    paths = {}
    for side in "rl":
        ankle = poses[f"foot_{side}"].origin
        paths[side] = FootPath(side, TIME, np.add(ankle, [-0.05, -0.07, 0]), np.add(ankle, [0.13, -0.06, 0]))
    finding = force_balance(legs(poses, paths, wrong, RAW), loads, UP, wrong).finding("a.c3d")
    assert finding.severity == "warning"
    assert "mean -20.0 %" in finding.what and "check the body mass" in finding.spoils


def test_few_frames_tell_nothing():
    person = Person(64.0, "f")
    found, loads = bobbing(person)
    loads["l"] = replace(loads["l"], known=np.full(len(TIME), False))
    balance = force_balance(found, loads, UP, person)
    assert (balance.frames, balance.tested) == (0, False)
    assert says(balance.line(), "not tested", "both feet", "(0)")


def test_one_leg_cannot_be_balanced():
    person = Person(64.0, "f")
    found, loads = bobbing(person)
    with pytest.raises(ChannelError, match=r"both.*and the pelvis"):
        force_balance({"r": found["r"]}, loads, UP, person)


def test_a_walk_is_balanced_and_exchanged_plates_or_a_wrong_mass_are_not(gait_data):
    trial = read_c3d(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d")
    poses = bones(trial)
    right = trial_kinetics(trial, poses, feet(trial), Person(45.8), trunk=("C7", "T10", "CLAV", "STRN")).balance
    assert right.frames > 80
    assert (right.rms, right.level_rms, abs(right.mean)) < (5.0, 5.0, 2.0)
    heavier = trial_kinetics(trial, poses, feet(trial), Person(52.7))
    assert any(f.kind == "force balance" and f.severity == "warning" for f in heavier.findings)
    with pytest.raises(ChannelError, match=r"0\.7\d.*588 N"):
        trial_kinetics(trial, poses, feet(trial), Person(60.0))


def test_the_line_of_a_balance():
    assert says(ForceBalance(87, 7.44, 9.41, -4.71).line(), "87 frames", "7.4 %", "-4.7 %", "9.4 %")
