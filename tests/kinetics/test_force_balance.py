from dataclasses import replace

import numpy as np
import pytest
from plug_in_gait_bones import bones, feet
from texts import says

from gaitdisc.errors import ChannelError
from gaitdisc.ingest.c3d import read_c3d
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.foot_loads import FootLoad
from gaitdisc.kinetics.joint_moments import KineticsSettings, legs
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.kinetics.plate_steps import FootPath
from gaitdisc.kinetics.trial_kinetics import ForceBalance, force_balance, trial_kinetics
from gaitdisc.kinetics.wrench import Wrench

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
    poses = {f"{k}_{leg.side}" if k != "pelvis" else k: m.pose for leg in found.values() for k, m in leg.moving.items()}
    paths = {}
    for side in "rl":
        ankle = poses[f"foot_{side}"].origin
        paths[side] = FootPath(side, TIME, np.add(ankle, [-0.05, -0.07, 0]), np.add(ankle, [0.13, -0.06, 0]))
    finding = force_balance(legs(poses, paths, wrong, RAW), loads, UP, wrong).finding("a.c3d")
    assert finding.severity == "warning"
    assert "mean -20.0 %" in finding.what and "check body mass" in finding.spoils


def test_few_frames_tell_nothing():
    person = Person(64.0, "f")
    found, loads = bobbing(person)
    loads["l"] = replace(loads["l"], known=np.full(len(TIME), False))
    balance = force_balance(found, loads, UP, person)
    assert (balance.frames, balance.tested) == (0, False)
    assert says(balance.line(), "both", "0 frames", "not")


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
