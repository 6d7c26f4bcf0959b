from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.muscles import FALL_S, RISE_S, activated, cycle_activation, muscle_moments, strength_of
from gaitdisc.cohort.person import MUSCLES


def stepped(start, excitation, seconds, step_s=1e-5):
    level = start
    for _ in range(round(seconds / step_s)):
        level = activated(excitation, level, step_s)
    return level


def test_activation_rises_faster_than_it_falls():
    assert stepped(0.0, 1.0, RISE_S) == pytest.approx(1 - np.exp(-1), abs=1e-3)
    assert stepped(1.0, 0.0, FALL_S) == pytest.approx(np.exp(-1), abs=1e-3)


def test_muscles_pull_the_way_they_are_named():
    strength = strength_of(70.0)
    for name, joint, sign in [("emg_sol", 2, -1), ("emg_ta", 2, 1), ("emg_vas", 1, -1), ("emg_ham", 0, -1)]:
        activation, moments = np.zeros(7), np.zeros(3)
        activation[MUSCLES.index(name)] = 0.5
        muscle_moments(strength, activation, np.zeros(3), moments)
        assert np.sign(moments[joint]) == sign


def test_a_lengthening_muscle_gives_more():
    strength, activation = strength_of(70.0), np.zeros(7)
    activation[MUSCLES.index("emg_sol")] = 0.5
    still, stretched = np.zeros(3), np.zeros(3)
    muscle_moments(strength, activation, np.zeros(3), still)
    muscle_moments(strength, activation, np.array([0.0, 0.0, 2.0]), stretched)
    assert stretched[2] == pytest.approx(1.12 * still[2])


def test_a_change_of_command_is_never_shared_out_beyond_itself():
    strength = strength_of(70.0)
    for take in (strength.take_up, strength.take_down):
        for joint in range(3):
            assert (take[:, joint] * strength.reach[:, joint]).sum() <= 1.4  # antagonists let go at the same time
            assert np.all(take[:, joint] * strength.reach[:, joint] >= 0)


def test_cycle_activation_is_periodic_and_lags():
    count, step = 500, 0.002
    phase = np.arange(count) / count
    excitation = np.repeat(np.maximum(0.05, np.sin(2 * np.pi * phase))[:, None], 7, axis=1)
    activation = cycle_activation(excitation, step, 3)
    assert activation[:, 0].argmax() > excitation[:, 0].argmax()
    last = activated(excitation[-1, 0], activation[-1, 0], step)
    assert last == pytest.approx(activation[0, 0], abs=1e-6)
