from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Source
from gaitdisc.signals.channel_quality import drift_findings, swing_baseline

RATE = 1000.0


def belt(steps=30, offset_n=0.0, drift_n=0.0, sign=1.0, seed=0):
    t = np.arange(round(steps * 1.1 * RATE)) / RATE
    phase = t / 1.1 % 1.0
    load = np.where(phase < 0.6, 700 * np.sqrt(np.abs(np.sin(np.pi * phase / 0.6))), 0.0)
    noise = 2 * np.random.default_rng(seed).normal(size=len(t))
    force = sign * (load + noise) + offset_n + drift_n * t / t[-1]
    channel = Channel("ground_force_r_vy", "vertical_force", "N", "r")
    return Recording(t, force[:, None], (channel,), source=Source("walk.c3d"))


def test_the_baseline_is_that_of_swing():
    found = swing_baseline(belt(offset_n=7.0)["ground_force_r_vy"], RATE)
    assert len(found) == 29
    assert found[:, 1] == pytest.approx(7.0, abs=0.5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_planted_drift_is_found(sign):
    (finding,) = drift_findings(belt(drift_n=12.0, sign=sign))
    assert "and drifts by +11." in finding.what
    assert "subtract the baseline" in finding.spoils


def test_an_offset_is_found():
    forces = belt(offset_n=-15.0)
    (finding,) = drift_findings(Recording(forces.time + 10.0, forces.values, forces.channels))
    assert says(finding.what, "-15.0 N", "29 swings")
    assert np.ravel(finding.spans) == pytest.approx([10.0 + 0.8 * 1.1, 10.0 + 28.8 * 1.1], abs=0.05)


def test_a_good_plate_is_not_accused():
    assert all(drift_findings(belt(drift_n=2.0, offset_n=3.0, seed=seed)) == [] for seed in range(10))


def test_few_swings_are_said():
    (finding,) = drift_findings(belt(steps=4))
    assert finding.severity == "note" and says(finding.what, "3 unloaded phases", "5")


def test_real_belts_rest_at_zero(gait_data, real):
    ezc3d = pytest.importorskip("ezc3d")
    plates = real.plates(ezc3d.c3d(str(gait_data / "treadmill_c3d_emg" / "walking_1.c3d")))
    assert drift_findings(plates) == []
