from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.ndimage import gaussian_filter1d

from gaitdisc.channel import Channel
from gaitdisc.comparison.compare import best_shift, compare_people, compare_walks
from gaitdisc.errors import ComparisonError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.pooled_cycles import STRIDE_COLUMNS, WalkSummary
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.recording import PERCENT, Event
from gaitdisc.signals.contact_movement import angle_contacts

CHANNELS = tuple(Channel(f"{joint}_r", "angle", "deg", "r") for joint in ("hip_flexion", "knee_angle", "ankle_angle"))
SHAPE = np.stack([20 * np.cos(2 * np.pi * k * PERCENT / 100) for k in (1, 2, 3)], axis=1)
BUMP = np.where((PERCENT >= 30) & (PERCENT <= 60), -6.0, 0.0)


def walk(name, strides, seed, rho=0.0, sd=1.5):
    rng = np.random.default_rng(seed)
    noise = gaussian_filter1d(rng.standard_normal((strides, 141, 3)), 5, axis=1)[:, 20:121]
    noise *= sd / noise.std()
    for k in range(1, strides):
        noise[k] = rho * noise[k - 1] + np.sqrt(1 - rho**2) * noise[k]
    strides_table = pd.DataFrame(columns=pd.Index(STRIDE_COLUMNS))
    return WalkSummary("", name, 60.0, 100.0, "angles", CHANNELS, SHAPE + noise, strides_table, (), {name: "0" * 64})


def bent(summary):
    curves = np.array(summary.curves)
    curves[:, :, 2] += BUMP
    return replace(summary, curves=curves)


def test_a_known_gap_is_found_where_it_is_and_nowhere_else():
    found = compare_walks(bent(walk("sim", 40, 1)), walk("measured", 50, 2))
    assert found.ordered() == ["ankle_angle_r"]
    [region] = found.regions_of("ankle_angle_r")
    assert region["from_percent"] == pytest.approx(30, abs=1)
    assert region["to_percent"] == pytest.approx(60, abs=1)
    assert region["gap"] == pytest.approx(6, abs=1)  # second minus first
    assert region["gap_sd"] == pytest.approx(4, abs=1.2)
    assert region["p"] < 0.001
    inside = (found.curves["low"] <= 6) & (found.curves["high"] >= 6)
    assert inside[32:58, 2].all()
    assert found.summary_of("hip_flexion_r")["within"] < 2.5
    assert found.rmse["ankle_angle_r"] == pytest.approx(6 * np.sqrt(0.31), abs=0.4)


def test_no_gap_and_what_could_have_been_seen():
    found = compare_walks(walk("sim", 40, 3), walk("measured", 50, 4))
    assert not len(found.regions)
    assert 0.8 < found.summary_of("knee_angle_r")["visible"] < 2.0
    seen = compare_walks(replace(walk("sim", 40, 3), curves=walk("sim", 40, 3).curves + 2.0), walk("measured", 50, 4))
    assert seen.ordered()


def test_one_stride_is_a_curve_tested_against_the_strides():
    periodic = replace(walk("sim", 1, 5), curves=(SHAPE + np.stack([0 * BUMP, 0 * BUMP, BUMP], axis=1))[None])
    found = compare_walks(periodic, walk("measured", 30, 6))
    assert found.ordered() == ["ankle_angle_r"]
    assert (found.exchange.first, found.exchange.strides_first) == (1, 1)
    assert np.isnan(found.curves["sd_first"]).all()


def test_dependent_strides_are_gathered_into_blocks():
    found = compare_walks(walk("sim", 80, 7, rho=0.6), walk("measured", 80, 8, rho=0.6))
    assert found.exchange.unit.startswith("block of ")
    assert not len(found.regions)
    wider = found.curves["high"] - found.curves["low"]
    plain = compare_walks(walk("sim", 80, 7), walk("measured", 80, 8)).curves
    assert np.median(wider) > 1.5 * np.median(plain["high"] - plain["low"])


def test_too_few_strides_are_refused_in_words():
    with pytest.raises(ComparisonError, match=r"measured.*it has 1, and sim has 30") as refused:
        compare_walks(walk("sim", 30, 1), walk("measured", 1, 2))
    assert "one walk is a single stride" in refused.value.remedy


def test_people_are_units_and_paired():
    first, second = [], []
    for person in range(8):
        own = np.random.default_rng(person).normal(0, 8)  # people differ by more than conditions
        nominal, device = walk("nominal", 10, [person, 1]), bent(walk("exo", 12, [person, 2]))
        first.append(replace(device, curves=device.curves + own))
        second.append(replace(nominal, curves=nominal.curves + own))
    found = compare_people(first, second)
    assert found.exchange.unit == "participant"
    assert (found.exchange.first, found.exchange.permutations, found.exchange.exact) == (8, 128, True)
    assert found.ordered() == ["ankle_angle_r"]
    assert found.curves["sd_second"].mean() == pytest.approx(1.5, abs=0.3)
    with pytest.raises(ComparisonError, match=r"6 participants.*both"):
        compare_people(first[:5], second[:5])


def test_a_shifted_curve_is_told():
    wave = SHAPE[:, 0]
    shift, left = best_shift(np.roll(wave[:-1], 4)[np.arange(101) % 100], wave)
    assert shift == -4
    assert left == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("planted", [3, 7, 10])
def test_marks_apart_make_no_gap_and_hide_none(planted):
    """Halves of one walk with their marks apart: nothing; and the same with a known gap: that gap."""
    late = walk("late", 40, 3)
    late = replace(late, curves=np.roll(late.curves[:, :-1], -planted, axis=1)[:, np.arange(101) % 100])
    found = compare_walks(late, walk("measured", 50, 4))
    assert found.ordered() == []
    assert found.alignment.percent == pytest.approx(planted, abs=0.3)
    assert found.provenance.settings["smallest_angle_deg"] == 2.0
    both = bent(walk("late", 40, 3))
    both = replace(both, curves=np.roll(both.curves[:, :-1], -planted, axis=1)[:, np.arange(101) % 100])
    named = compare_walks(both, walk("measured", 50, 4))
    assert named.ordered() == ["ankle_angle_r"]
    [region] = named.regions_of("ankle_angle_r")
    assert region["gap"] == pytest.approx(6, abs=1.2)
    assert region["from_percent"] == pytest.approx(30, abs=2)


def marked_apart(trial, percent):
    """Trial whose events are its own contacts from angles, later by a share of each stride."""
    events = [
        Event("initial contact", side, float(time))
        for side, found in angle_contacts(trial.stream("kinematics")).items()
        for time in found.time[:-1] + percent / 100 * np.diff(found.time)
    ]
    return replace(trial, events=tuple(sorted(events, key=lambda event: event.time)))


@pytest.mark.parametrize("planted", [0.0, 7.0])
def test_halves_of_a_real_run_whose_marks_lie_apart_do_not_differ(gait_data, planted):
    """Minutes of one runner: with marks 7 % of the stride apart 18 of 26 channels differed, knees by 33 deg."""
    whole = read_trial(gait_data / "exotendon_run" / "c3d_Trimmed_running_natural2_manual_scaling_ik.mot")
    angles = whole.stream("kinematics")
    halves = [angles.between(0.0, 30.0), angles.between(30.0, 70.0)]
    first, second = (
        replace(whole, name=name, condition=name, streams={"kinematics": half})
        for name, half in zip("ab", halves, strict=True)
    )
    found = compare_walks(*walk_pair(marked_apart(first, planted), marked_apart(second, 0.0), detector="events"))
    assert found.ordered() == []
    assert found.alignment.percent == pytest.approx(planted, abs=0.5)


@pytest.mark.slow
def test_the_band_holds_the_true_gap_everywhere_in_95_percent():
    """Strides that depend on each other, a gap in one channel; 200 pairs of walks."""
    truth = -np.stack([0 * BUMP, 0 * BUMP, BUMP], axis=1)
    held = []
    for seed in range(200):
        found = compare_walks(bent(walk("a", 60, [seed, 1], rho=0.4)), walk("b", 60, [seed, 2], rho=0.4, sd=3.0))
        held.append(bool(((found.curves["low"] <= truth) & (truth <= found.curves["high"])).all()))
    assert 0.89 <= np.mean(held) <= 0.99
