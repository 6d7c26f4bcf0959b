from dataclasses import replace

import numpy as np
import pytest
from made_joint import GAIN, made_joint

from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.joint_and_trials import cut_walk_trials, joint_model, nominal_moment, weighed
from gaitdisc.errors import ChannelError, StrideError

SLOW = pytest.mark.slow  # a whole discovery


@pytest.fixture(scope="module")
def model():
    return nominal_moment(made_joint(seed=1))


def found_in(record, model):
    simulation = joint_model(record, model)
    return discover(simulation, cut_walk_trials(record, model, simulation), Request(possible=weighed))[0]


def test_the_nominal_walk_gives_each_muscle_its_gain_and_sign(model):
    np.testing.assert_allclose(model.gains.mean(axis=1), np.abs(GAIN), rtol=0.25)
    assert (model.gains >= 0).all()
    assert model.r2 > 0.97


@SLOW
def test_an_ankle_of_the_same_muscles_lacks_nothing(model):
    assert found_in(made_joint(seed=2), model).verdict == "no_gap"


@SLOW
def test_a_spring_is_named_with_its_stiffness_and_the_angle_it_engages_at(model):
    found = found_in(made_joint(seed=3, spring=150.0), model)
    (effect,) = found.effects
    assert (effect.name, effect.place) == ("one_sided_spring", "ankle_moment")
    assert effect.estimates["stiffness"].value == pytest.approx(150.0, rel=0.1)
    assert effect.estimates["engagement"].value == pytest.approx(0.05, abs=0.015)
    before, after, _ = found.held_out.channels["net_moment"]
    assert after < 0.5 * before


@SLOW
def test_late_emg_is_named_with_its_delay(model):
    (effect,) = found_in(made_joint(seed=4, late_s=0.05), model).effects
    assert (effect.name, effect.place) == ("wrong_parameter", "emg_delay")
    assert effect.estimates["value"].value == pytest.approx(-0.05, abs=0.01)


@SLOW
def test_weak_muscles_are_named_with_their_strength(model):
    (effect,) = found_in(made_joint(seed=5, strength=0.7), model).effects
    assert (effect.name, effect.place) == ("wrong_parameter", "plantarflexors_strength")
    assert effect.estimates["value"].value == pytest.approx(0.7, abs=0.05)


def test_too_few_strides_are_refused_with_their_number(model):
    record = made_joint(strides=9)
    with pytest.raises(StrideError, match=r"12 strides; it is known in 9 of 9 strides of W01"):
        cut_walk_trials(record, model, joint_model(record, model))


def test_a_joint_without_a_muscle_of_its_own_is_refused():
    """Electrodes on the shank alone say nothing of the hip."""
    shank = replace(made_joint(seed=1), joint="hip_flexion")
    with pytest.raises(ChannelError, match=r"the hip.*emg_.*--part"):
        nominal_moment(shank)
