from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.recording import Strides
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.stride_quality import outlying, stride_distances, stride_findings, without_outlying
from gaitdisc.signals.strides import cut_strides


def walk_with_fault(made, size_deg, seed=0):
    walk, contacts = made.walk(30, seed=seed)
    values = walk.values.copy()
    rows = (walk.time > contacts[12] + 0.2) & (walk.time < contacts[12] + 0.7)
    values[rows, 1] += size_deg
    return walk.with_values(values), Strides(contacts[:-1], contacts[1:], "r", "force")


def test_distances_are_in_the_channels_unit(made):
    walk, strides = walk_with_fault(made, 10.0)
    distance = stride_distances(walk, strides)
    assert distance.shape == (30, 6)
    assert distance[12, 1] == pytest.approx(10 * np.sqrt(0.5 / 1.1), rel=0.15)


def test_a_planted_stride_is_found_in_its_channel_only(made):
    for seed in range(10):
        walk, strides = walk_with_fault(made, 15.0, seed)
        assert np.argwhere(outlying(walk, strides)).tolist() == [[12, 1]]


def test_clean_strides_raise_no_alarm(made):
    alarms = sum(outlying(*made.wandering(200, dependence, seed)).sum() for seed in range(5) for dependence in (0, 0.5))
    assert alarms <= 2  # of 11 940


def test_the_finding_says_which_and_how_far(made):
    walk, strides = walk_with_fault(made, 15.0)
    (finding,) = stride_findings(walk, strides)
    assert finding.channel == "knee_angle_r"
    assert says(finding.what, "1 of 30 strides", f"{strides.start[12]:.2f} s")
    assert finding.spans == ((strides.start[12], strides.end[12]),)


def test_an_outlying_stride_is_dropped_with_its_reason(made):
    walk, strides = walk_with_fault(made, 15.0)
    kept = without_outlying(walk, strides)
    assert len(kept) == 29
    assert kept.dropped[0].start == strides.start[12]
    assert kept.dropped[0].reason.startswith("unlike the others: knee_angle_r ")
    assert without_outlying(walk, strides, fewest_channels=2) is strides


def test_gaps_and_few_strides_have_no_outliers(made):
    walk, strides = walk_with_fault(made, 15.0)
    few = replace(strides, start=strides.start[8:15], end=strides.end[8:15])
    assert not outlying(walk, few).any()
    values = walk.values.copy()
    values[:, 2] = np.nan
    assert outlying(walk.with_values(values), strides)[:, 2].sum() == 0


def test_every_real_stumble_is_seen(gait_data, real):
    for name, walk in real.treadmill_walks(gait_data).items():
        if name == "S01DE503":
            continue
        strides = cut_strides(angle_contacts(walk)["r"], walk)
        kept = without_outlying(walk.selected(real.legs), strides)
        assert any(9 < stride.start < 13.5 for stride in kept.dropped), name
        assert len(kept) >= 13


def test_a_channel_without_a_whole_stride_prints_no_warning(made):
    walk, strides = walk_with_fault(made, 15.0)
    values = walk.values.copy()
    values[:, 3] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(without_outlying(walk.with_values(values), strides).dropped) == 1
