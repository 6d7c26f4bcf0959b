"""Forces along a recorded walk: residuals at the ground, forces of another motion, and what noise of angles makes."""

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.batch.tracked_pass import (
    balance,
    moments_of_angle_noise,
    only_residuals,
    refuse_other_motion,
    with_angle_noise,
)
from gaitdisc.errors import SchemaError


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
    with pytest.raises(SchemaError, match=r"70.0 kg, pelvis_ty.*69 N.*63.0 kg"):
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
