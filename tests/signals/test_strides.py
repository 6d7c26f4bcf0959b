"""Strides, their quality and period, and where somebody walks."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import says

from gaitdisc.errors import StrideError
from gaitdisc.recording import Strides
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.stride_quality import outlying, stride_distances, stride_findings, without_outlying
from gaitdisc.signals.strides import cut_strides, stride_period, verify_walking


def contacts(durations, start=1.0):
    return Contacts(start + np.concatenate([[0.0], np.cumsum(durations)]), "r", "force")


def test_every_contact_begins_a_stride():
    strides = cut_strides(contacts([1.0, 1.1, 0.95, 1.05]))
    assert strides.duration_s == pytest.approx([1.0, 1.1, 0.95, 1.05])
    assert (strides.side, strides.detector, strides.dropped) == ("r", "force", ())


@pytest.mark.parametrize(
    ("odd", "words"),
    [
        (0.3, "0.30 s is shorter than 0.4 s: one contact is probably false"),
        (3.0, "3.00 s is longer than 2.5 s: the person paused, or a contact was missed"),
        (
            2.1,
            "2.10 s differs from the median stride of 1.00 s by more than 15 % and 6 robust SD: a contact was missed",
        ),
        (0.8, "0.80 s differs from the median stride of 1.00 s by more than 15 % and 6 robust SD: a stumble, or"),
    ],
)
def test_an_odd_stride_is_dropped_with_its_reason(odd, words):
    durations = [1.0] * 5 + [odd] + [1.0] * 5
    strides = cut_strides(contacts(durations))
    assert len(strides) == 10
    assert len(strides.dropped) == 1
    assert strides.dropped[0].start == pytest.approx(6.0)
    assert strides.dropped[0].reason.startswith(words)


def test_natural_variability_drops_nothing():
    rng = np.random.default_rng(0)
    for _ in range(50):
        assert cut_strides(contacts(1.1 * (1 + 0.03 * rng.normal(size=200)))).dropped == ()


def test_a_gap_in_the_data_drops_its_stride(made):
    walk, at = made.walk(12)
    first = int(np.searchsorted(walk.time, at[4] + 0.3))
    long, short = (with_column(walk, "knee_angle_r", np.nan, slice(first, first + length)) for length in (25, 8))
    strides = cut_strides(Contacts(at, "r", "force"), long)
    assert len(strides) == 11
    assert strides.dropped[0].reason == "knee_angle_r missing for 0.25 s"
    assert cut_strides(Contacts(at, "r", "force"), short).dropped == ()  # short enough to be filled


def test_a_channel_without_any_value_drops_nothing(made):
    walk, at = made.walk(12)
    assert len(cut_strides(Contacts(at, "r", "force"), with_column(walk, "hip_flexion_l", np.nan))) == 12


def test_strides_beyond_the_recording_are_dropped(made):
    walk, at = made.walk(12)
    strides = cut_strides(Contacts(at, "r", "force"), walk.between(0.0, 6.0))
    assert len(strides) + len(strides.dropped) == 12
    assert says(strides.dropped[0].reason, "0.00", "5.99 s")


def test_one_contact_is_no_stride_and_none_left_is_refused_with_the_first_reason():
    with pytest.raises(StrideError, match=r"two initial contacts.*1.*'r'"):
        cut_strides(contacts([]))
    with pytest.raises(StrideError, match=r"2.*1\.00 s: 5\.00 s.*longer.*2\.5 s"):
        cut_strides(contacts([5.0, 6.0]))


def walk_with_fault(made, size_deg, seed=0):
    walk, contacts = made.walk(30, seed=seed)
    rows = (walk.time > contacts[12] + 0.2) & (walk.time < contacts[12] + 0.7)
    faulty = with_column(walk, "knee_angle_r", walk["knee_angle_r"][rows] + size_deg, rows)
    return faulty, Strides(contacts[:-1], contacts[1:], "r", "force")


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
    assert kept.dropped[0].reason.startswith("outlying: knee_angle_r ")
    assert without_outlying(walk, strides, fewest_channels=2) is strides


def test_gaps_and_few_strides_have_no_outliers(made):
    walk, strides = walk_with_fault(made, 15.0)
    few = replace(strides, start=strides.start[8:15], end=strides.end[8:15])
    assert not outlying(walk, few).any()
    assert outlying(with_column(walk, "ankle_angle_r", np.nan), strides)[:, 2].sum() == 0


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
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(without_outlying(with_column(walk, "hip_flexion_l", np.nan), strides).dropped) == 1


def strides_of(contacts):
    return Strides(contacts[:-1], contacts[1:], "r", "force")


def test_a_made_walk_is_walking(made):
    walk, contacts = made.walk(20)
    found = verify_walking(walk, strides_of(contacts))
    assert found.strides == 20
    assert found.stride_s == pytest.approx(1.1, abs=0.02)
    assert found.coverage > 0.95
    assert found.regularity > 0.95
    assert found.knee_deg > 45
    stiff = with_column(walk, "knee_angle_l", 0.3 * walk["knee_angle_l"])  # a stiff knee walks too
    assert verify_walking(stiff, strides_of(contacts)).knee_deg > 45


def test_what_is_not_walking_is_refused_with_its_numbers(made):
    walk, contacts = made.walk(20)
    rng = np.random.default_rng(0)
    still = walk.with_values(walk.values * 0 + np.cumsum(rng.normal(size=walk.values.shape), axis=0) / 5)
    with pytest.raises(StrideError) as refusal:
        verify_walking(still, strides_of(contacts[:3]))
    assert says(refusal.value.needed, "3 strides", "60 %")
    for words in ("2 strides, but 3", "strides cover 10 % of", "repeat with a correlation of", "ranges of motion is"):
        assert words in refusal.value.found


def test_a_short_walk_over_ground_is_judged_without_regularity(made):
    walk, contacts = made.walk(2)
    found = verify_walking(walk, strides_of(contacts), fewest=1)
    assert np.isnan(found.regularity)
    assert found.strides == 2


def test_real_walks_pass_and_range_of_motion_trials_do_not(gait_data, real):
    trials = real.treadmill_walks(gait_data)
    trials["S01DN603"] = real.mot(gait_data / "treadmill_walk_ik" / "S01DN603_ik.mot")
    for name, trial in trials.items():
        strides = cut_strides(angle_contacts(trial)["r"], trial)
        if name in ("S01DE503", "S01DN603"):
            with pytest.raises(StrideError, match=r"3.*needed; strides cover [38] %"):
                verify_walking(trial, strides)
        else:
            assert verify_walking(trial, strides).regularity > 0.8


@settings(deadline=None, max_examples=20)
@given(st.floats(0.5, 1.8))
def test_the_period_of_a_periodic_signal(period):
    t = np.arange(1500) / 100
    x = np.sin(2 * np.pi * t / period) + 0.6 * np.cos(4 * np.pi * t / period)
    found, regularity = stride_period(x, 100.0)
    assert found == pytest.approx(period, abs=0.01)
    assert regularity > 0.98


def test_noise_and_constants_do_not_repeat():
    assert stride_period(np.random.default_rng(0).normal(size=2000), 100.0)[1] < 0.2
    assert stride_period(np.zeros(2000), 100.0)[1] == 0.0


def test_gaps_do_not_matter():
    t = np.arange(1500) / 100
    x = np.sin(2 * np.pi * t)
    x[300:420] = np.nan
    assert stride_period(x, 100.0)[0] == pytest.approx(1.0, abs=0.01)


def test_two_strides_are_enough_and_one_is_not():
    t = np.arange(400) / 100
    x = np.sin(2 * np.pi * t / 1.1)
    assert stride_period(x[:220], 100.0)[0] == pytest.approx(1.1, abs=0.02)
    assert stride_period(x[:110], 100.0)[0] != pytest.approx(1.1, abs=0.1)
