"""The joints' findings as one answer: what is named, what was left before and after, every sample held out once."""

from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.batch.discover_tracked import discovery_of
from gaitdisc.batch.tracked_joints import joints_of


def answered(walk, moment):
    pulls = walk.pulls.copy()
    pulls[:, 1, 2] -= moment
    noise = np.random.default_rng(0).normal(0, 0.5, (4, len(walk.times), 3))
    return discovery_of(*joints_of(replace(walk, pulls=pulls), noise))


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


def test_where_nothing_is_left_nothing_is_named(leg_walk):
    found = answered(leg_walk(), 0.0)
    assert (found.verdict, found.effects) == ("no_gap", ())
    assert discovery_of(joints_of(leg_walk(), np.ones((1, 48, 3)))[0], []).runs.measured.size == 0
