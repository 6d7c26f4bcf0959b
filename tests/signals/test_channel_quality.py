from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Source
from gaitdisc.signals.channel_quality import channel_findings, clipped, jumping

FORCE = Channel("ground_force_r_vy", "vertical_force", "N", "r")


def one(x, channel, rate=100.0):
    return Recording(np.arange(len(x)) / rate, np.asarray(x, float)[:, None], (channel,), source=Source("walk.mot"))


def test_a_clean_walk_has_no_findings(made):
    for seed in range(10):
        assert channel_findings(made.walk(20, seed=seed)[0]) == []


def planted(made, fault):
    walk, _ = made.walk(20)
    x = walk.values[:, 1].copy()
    if fault == "gap":
        x[400:440] = np.nan
    elif fault == "flat":
        x[:] = 3.0
    elif fault == "clipped":
        x = np.minimum(x, 50.0)
    elif fault == "jump":
        x[400] += 15.0
    return one(x, walk.channels[1])


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("gap", "1 gap, 0.400 s"),
        ("flat", "3 deg throughout"),
        ("clipped", "stops at 50 deg, in 2"),
        ("jump", "leaps from one sample to the next, in 1 place, 0.05 s in all"),
    ],
)
def test_each_planted_fault_is_found_and_no_other(made, fault, words):
    findings = channel_findings(planted(made, fault))
    assert words in next(finding.what for finding in findings if finding.kind == fault)
    assert {finding.kind for finding in findings} == {fault}


def test_spans_say_where(made):
    assert channel_findings(planted(made, "gap"))[0].spans == ((4.0, 4.4),)


def test_a_force_that_rests_at_zero_is_well():
    t = np.arange(2000) / 1000
    f = np.where(np.sin(2 * np.pi * t) > 0, 700 * np.sin(2 * np.pi * t), 0.0)
    assert channel_findings(one(f, FORCE, 1000.0)) == []


def test_a_force_that_is_cut_off_is_clipped():
    t = np.arange(2000) / 1000
    f = np.clip(900 * np.sin(2 * np.pi * t), 0.0, 700.0)
    assert [finding.kind for finding in channel_findings(one(f, FORCE, 1000.0))] == ["clipped"]


def test_marks_lie_on_the_fault():
    assert not clipped(np.sin(np.arange(1000) / 30)).any()
    x = np.sin(np.arange(1000) / 30)
    x[700] += 0.5
    assert np.flatnonzero(jumping(x)).tolist() == list(range(698, 703))


def test_a_real_ankle_that_jumps(gait_data, real):
    walk = real.treadmill_walks(gait_data)["S01DE507"].selected(["ankle_angle_r", "hip_flexion_r", "knee_angle_r"])
    jumps = [finding for finding in channel_findings(walk) if finding.kind == "jump"]
    assert [finding.channel for finding in jumps] == ["ankle_angle_r"]
    assert jumps[0].spans[0][0] == pytest.approx(13.98, abs=0.03)


def test_a_heading_that_passes_180_deg_does_not_leap():
    t = np.arange(1000) / 100
    true = 170 + 3 * t + np.sin(2 * np.pi * t)
    walk = Recording(t, ((true + 180) % 360 - 180)[:, None], (Channel("pelvis_rotation", "angle", "deg"),))
    assert channel_findings(walk) == []
