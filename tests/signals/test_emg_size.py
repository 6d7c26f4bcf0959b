"""A trial whose EMG has another unit than it states, beside one that has the right one."""

from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording
from gaitdisc.signals.emg import OVER_STANDING, OVER_WALKING, emg_sizes, other_unit_findings

MUSCLES = ("emg_sol_r", "emg_ta_r", "emg_gas_r", "emg_rf_r")
SIZES = np.array([3e-4, 5e-5, 1e-4, 2e-5])


def emg(factor: float, seed: int = 0) -> Recording:
    values = factor * SIZES * np.random.default_rng(seed).normal(size=(2000, 4))
    return Recording(np.arange(2000) / 1000, values, tuple(Channel(name, "emg", "V", "r") for name in MUSCLES))


def said(walk: float, other: float, usual: tuple[float, float]) -> list[str]:
    found = other_unit_findings(emg_sizes(emg(walk)), emg_sizes(emg(other, 1)), usual, "walk", "other")
    return [finding.what for finding in found]


@pytest.mark.parametrize("stronger", [0.5, 1.0, 5.0, 30.0])
def test_walking_beside_standing_is_judged_by_a_thousand(stronger):
    assert not said(stronger, 1.0, OVER_STANDING)
    (weak,) = said(1e-3 * stronger, 1.0, OVER_STANDING)
    assert says(weak, "weaker", "4 channels", "mV")
    (strong,) = said(1e3 * stronger, 1.0, OVER_STANDING)
    assert "times stronger than in other" in strong and says(strong, "mV", "V is stated")


def test_one_walk_beside_another():
    assert not said(4.0, 1.0, OVER_WALKING) and not said(0.25, 1.0, OVER_WALKING)
    assert said(4e-3, 1.0, OVER_WALKING) and said(250.0, 1.0, OVER_WALKING)


def test_loose_electrodes_resting_muscles_and_two_channels_decide_nothing():
    sizes = emg_sizes(emg(1.0))
    assert not other_unit_findings({**sizes, "emg_ta_r": 1.0}, sizes, OVER_WALKING, "walk", "other")
    rested = {name: size / 5000 if name != "emg_gas_r" else size / 3 for name, size in sizes.items()}
    assert not other_unit_findings(sizes, rested, OVER_STANDING, "walk", "other")
    two = {name: 1e-3 * sizes[name] for name in MUSCLES[:2]}
    assert not other_unit_findings(two, sizes, OVER_WALKING, "walk", "other")


def test_dead_and_empty_channels_have_no_size():
    bare = np.column_stack([np.zeros(50), np.full(50, np.nan), np.arange(50.0)])
    channels = tuple(Channel(name, "emg", "V", "r") for name in MUSCLES[:3])
    assert list(emg_sizes(Recording(np.arange(50) / 1000, bare, channels))) == ["emg_gas_r"]


def test_electrodes_that_were_not_yet_on_in_the_static_trial_are_no_unit():
    """Converter of 16 bits and 1.25 V: noise of 0.3 mV standing, bursts of 250 mV walking: 893 times, and no unit."""
    step, rng = 1.25 / 2**15, np.random.default_rng(3)
    channels = tuple(Channel(name, "emg", "V", "r") for name in MUSCLES)
    noise, bursts = ((np.round(rng.normal(0, size, (3000, 4)) / step) * step) for size in (2.8e-4, 0.25))
    static, walk = (Recording(np.arange(3000) / 1000, x, channels) for x in (noise, np.clip(bursts, -1.25, 1.25)))
    assert not other_unit_findings(emg_sizes(walk), emg_sizes(static), OVER_STANDING, "walk", "the static trial")
