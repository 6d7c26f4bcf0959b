"""Forces along a recorded walk: refused where they are of another motion; what is planted into them is named."""

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.discovery.discover_tracked import doubts, make_discovery, search_joints, summarise_joint
from gaitdisc.discovery.tracked_pass import (
    balance,
    moments_of_angle_noise,
    only_residuals,
    refuse_other_motion,
    with_angle_noise,
)
from gaitdisc.errors import SamplingError, SchemaError


def test_joints_are_those_that_some_actuator_moves_and_the_weight_is_the_models(leg_walk):
    walk = leg_walk()
    assert walk.joints == (1, 2) and walk.groups_at(2) == ["ankle_lowering_muscles"]
    assert walk.weight_n == pytest.approx(70 * 9.81)
    assert np.abs(walk.left[:, 1:]).max() < 1e-9


def test_noise_of_angles_leaves_its_size_in_the_angles_and_its_inertia_in_the_moments(leg_walk):
    walk = leg_walk()
    moved = with_angle_noise(walk, 0.3, np.random.default_rng(1))
    noise = moved.motion.q - walk.motion.q
    assert np.degrees(noise[:, 1:].std(axis=0)) == pytest.approx(0.3, rel=0.35)  # some twelve periods of 6 Hz
    made = moments_of_angle_noise(walk, 0.3)
    sizes = made.std(axis=(0, 1))
    assert made.shape == (4, len(walk.times), 3)
    assert sizes[1] / sizes[2] == pytest.approx(2.5, rel=0.4)  # as their moments of inertia
    assert moments_of_angle_noise(walk, 0.0).any() == np.False_


def test_a_mass_that_the_ground_does_not_carry_is_refused_and_one_that_it_does_is_told(leg_walk):
    (found,) = balance(leg_walk(carried=0.98))
    assert says(found.what, "pelvis_ty: 13.7 N", "neither")
    with pytest.raises(SchemaError, match=r"70.0 kg.*63.0 kg: pelvis_ty.*69 N"):
        balance(leg_walk(carried=0.9))


def test_residual_forces_that_balance_another_motion_are_refused(leg_walk):
    walk = leg_walk()
    pulls = walk.pulls.copy()
    pulls[:, 0, 0] = 150.0
    with pytest.raises(SchemaError, match=r"pelvis_ty.*150 N.*687."):
        refuse_other_motion(replace(walk, pulls=pulls))
    refuse_other_motion(walk)


def test_without_muscles_the_residuals_are_what_can_be_said(leg_walk):
    said = only_residuals(leg_walk(carried=0.98))
    assert says(said, "can be named") and "13.7 N at pelvis_ty" in said


def searched(walk, moment=None, seed=1):
    """Search a walk whose calf gives less at the ankle than the motion demands, by a moment."""
    noisy = with_angle_noise(walk, 0.3, np.random.default_rng(seed))
    if moment is not None:
        pulls = noisy.pulls.copy()
        pulls[:, 1, 2] -= moment
        noisy = replace(noisy, pulls=pulls)
    return search_joints(noisy, moments_of_angle_noise(walk, 0.3))[1]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_walk_with_noise_alone_is_silent(leg_walk, seed):
    assert all(one.named is None for one in searched(leg_walk(), seed=seed))


def test_a_spring_and_late_and_weak_muscles_are_named_at_their_joint(leg_walk):
    walk = leg_walk()
    angle, time, calf = walk.motion.q[:, 2], walk.motion.time, walk.groups["ankle_lowering_muscles"]
    planted = {
        "ankle_moment": (-150 * np.maximum(0, angle - 0.05), "factor", -150.0),
        "ankle_lowering_muscles_delay": (np.interp(time - 0.04, time, calf) - calf, "value", 0.04),
        "ankle_lowering_muscles_strength": (-0.3 * calf, "value", 0.7),
    }
    for place, (moment, word, value) in planted.items():
        knee, ankle = searched(walk, moment)
        assert knee.named is None and ankle.named is not None
        assert ankle.named.candidate.place == place
        assert ankle.named.values[word] == pytest.approx(value, rel=0.2)
        rest = ankle.joint.left - ankle.named.predicted
        assert np.sqrt(np.mean(rest**2)) < 0.5 * np.sqrt(np.mean(ankle.joint.left**2))


def test_a_joint_says_what_it_shows_and_warns_of_what_has_no_name(leg_walk):
    walk = leg_walk()
    said = summarise_joint(walk, 2, searched(walk)[1])
    assert (
        said.severity == "note"
        and "visible effects: a spring of" in said.what
        and "% of the force of its lowering muscles" in said.what
    )
    odd = 30 * np.sign(np.sin(2 * np.pi * 3.1 * walk.motion.time))
    unnamed = summarise_joint(walk, 2, searched(walk, odd)[1])
    assert unnamed.kind == "without a name" and doubts([said]) == []
    (doubt,) = doubts([said, unnamed])
    assert says(doubt.what, "1 of 2 joints", "unnamed residual", "3 times", "more")
    assert says(doubt.spoils, "the other joints")


def test_a_walk_of_half_a_second_is_refused(leg_walk):
    walk = leg_walk()
    short = replace(walk, motion=replace(walk.motion, time=walk.motion.time[:30]))
    with pytest.raises(SamplingError, match=r"6 Hz.*at least 0.83 s.*0.48 s"):
        search_joints(short, np.zeros((1, 1, 3)))


def answered(walk, moment):
    pulls = walk.pulls.copy()
    pulls[:, 1, 2] -= moment
    noise = np.random.default_rng(0).normal(0, 0.5, (4, len(walk.times), 3))
    return make_discovery(*search_joints(replace(walk, pulls=pulls), noise))


def test_a_named_spring_stands_with_its_numbers_and_the_gap_that_it_closes(leg_walk):
    walk = leg_walk()
    spring = -150 * np.maximum(0, walk.motion.q[:, 2] - 0.05)
    found = answered(walk, spring)
    (effect,) = found.effects
    assert (effect.name, effect.place) == ("one_sided_spring", "ankle_moment")
    assert effect.estimates["stiffness"].value == pytest.approx(150, rel=0.02)
    before, after, _ = found.held_out.channels["net_ankle_moment"]
    assert before == pytest.approx(np.sqrt(np.mean(walk.dense(spring) ** 2))) and after < 0.1 * before
    assert found.runs.names == ("whole walk",) and found.runs.measured.shape == (1, len(walk.times), 2)
    gap = found.runs.measured - found.runs.augmented
    assert np.sqrt(np.mean(gap[0, :, 1] ** 2)) == pytest.approx(after)


@pytest.mark.parametrize("kg", [2.0, -0.8])
def test_a_mass_is_named_once_for_the_joints_at_which_it_acts_by_the_heaviest_body_that_moves_so(leg_walk, kg):
    walk = leg_walk()
    assert walk.masses_by_joints() == {"foot_mass"}  # toes move with the foot, the trunk at no joint
    noisy = with_angle_noise(walk, 0.05, np.random.default_rng(3))
    pulls = noisy.pulls.copy()
    pulls[:, 1] += kg * walk.demanded_by_mass["foot_mass"]
    found = make_discovery(*search_joints(replace(noisy, pulls=pulls), moments_of_angle_noise(walk, 0.05)))
    (effect,) = found.effects
    mass = effect.estimates["value"]
    assert (effect.place, mass.unit, effect.kind) == ("foot_mass", "kg", "parameter") and effect.held_out > 0.9
    assert mass.value == pytest.approx(1.2 + kg, abs=0.1) and mass.low < 1.2 + kg < mass.high
    assert says(found.sentence, "foot_mass", "1.2 kg in the file")
    assert all(after < 0.3 * before for before, after, _ in found.held_out.channels.values())


def test_a_spring_at_one_joint_is_no_mass(leg_walk):
    walk = leg_walk()
    spring = -150 * np.maximum(0, walk.motion.q[:, 2] - 0.05)
    pulls = walk.pulls.copy()
    pulls[:, 1, 2] -= spring
    pulls[:, 0, 1] += 3 * np.sin(40 * walk.motion.time)  # so that the knee is not at the noise
    found = make_discovery(*search_joints(replace(walk, pulls=pulls), moments_of_angle_noise(walk, 0.05)))
    assert [one.place for one in found.effects] == ["ankle_moment"]


def test_where_nothing_is_left_nothing_is_named(leg_walk):
    found = answered(leg_walk(), 0.0)
    assert (found.verdict, found.effects) == ("no_gap", ())
    assert make_discovery(search_joints(leg_walk(), np.ones((1, 48, 3)))[0], []).runs.measured.size == 0
