"""What is planted into a walk with known forces is named at its joint, with its number; nothing else is."""

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.batch.tracked_joints import doubts, joints_of, shown_by
from gaitdisc.batch.tracked_pass import moments_of_angle_noise, with_angle_noise
from gaitdisc.errors import SamplingError


def searched(walk, moment=None, seed=1):
    """Search a walk whose calf gives less at the ankle than the motion demands, by a moment."""
    noisy = with_angle_noise(walk, 0.3, np.random.default_rng(seed))
    if moment is not None:
        pulls = noisy.pulls.copy()
        pulls[:, 1, 2] -= moment
        noisy = replace(noisy, pulls=pulls)
    return joints_of(noisy, moments_of_angle_noise(walk, 0.3))[1]


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
        assert ankle.named.part.candidate.place == place
        assert ankle.named.part.values[word] == pytest.approx(value, rel=0.2)
        rest = ankle.joint.left - ankle.named.predicted
        assert np.sqrt(np.mean(rest**2)) < 0.5 * np.sqrt(np.mean(ankle.joint.left**2))


def test_a_joint_says_what_it_shows_and_warns_of_what_has_no_name(leg_walk):
    walk = leg_walk()
    said = shown_by(walk, 2, searched(walk)[1])
    assert (
        said.severity == "note" and "it shows a spring from" in said.what and "% of its lowering muscles" in said.what
    )
    odd = 30 * np.sign(np.sin(2 * np.pi * 3.1 * walk.motion.time))
    unnamed = shown_by(walk, 2, searched(walk, odd)[1])
    assert unnamed.kind == "without a name" and doubts([said]) == []
    (doubt,) = doubts([said, unnamed])
    assert says(doubt.what, "1 of 2 joints", "no", "left, 3 times", "more")
    assert says(doubt.spoils, "the other joints")


def test_a_walk_of_half_a_second_is_refused(leg_walk):
    walk = leg_walk()
    short = replace(walk, motion=replace(walk.motion, time=walk.motion.time[:30]))
    with pytest.raises(SamplingError, match=r"0.83 s.*more.*6 Hz.*0.48 s"):
        joints_of(short, np.zeros((1, 1, 3)))
