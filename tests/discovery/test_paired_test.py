"""The paired test of held-out errors: its chance counted out, its pieces independent, its level kept."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter
from scipy.stats import rankdata, wilcoxon

from gaitdisc.discovery.paired_test import correlation_length, paired_test, signed_rank_p

ONE = np.ones(1)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(-9, 9).filter(bool), min_size=1, max_size=8))
def test_the_chance_is_the_share_of_signs_whose_ranks_sum_as_high(gains):
    ranks = rankdata(np.abs(gains))
    reached = ranks[np.array(gains) > 0].sum()
    as_high = [ranks[np.array(signs) > 0].sum() >= reached for signs in product((1, -1), repeat=len(gains))]
    assert signed_rank_p(np.array(gains, float)) == pytest.approx(np.mean(as_high))


@pytest.mark.parametrize("pieces", [12, 59, 61, 300])
def test_the_chance_is_scipys(pieces):
    gains = np.random.default_rng(pieces).normal(0.2, 1.0, pieces)
    method = "exact" if pieces <= 60 else "approx"
    _, known = wilcoxon(gains, alternative="greater", method=method, correction=True)
    assert signed_rank_p(gains) == pytest.approx(known, rel=1e-9)


def test_four_pieces_bear_nothing_out_and_five_may():
    worse, better = np.ones((1, 400, 1)), np.zeros((1, 400, 1))
    worse[0, ::2] = -1.0
    five, four = (paired_test(worse[:, :n], better[:, :n], ONE, 1) for n in (5, 4))
    assert (four.pieces, five.pieces) == (4, 5)
    assert not four.bears_out
    assert five.bears_out
    assert five.p == pytest.approx(1 / 32)


def test_an_error_that_rises_is_not_borne_out():
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(2, 600, 1))
    test = paired_test(noise, 1.5 * noise, ONE, 50)
    assert test.fall < 0
    assert test.p > 0.99
    assert not test.bears_out


def test_a_fall_in_a_single_piece_is_not_borne_out_by_its_size():
    rng = np.random.default_rng(1)
    after = rng.normal(size=(1, 1200, 1))
    before = after + 0.02
    before[0, :50] += 5.0
    test = paired_test(before, after, ONE, 50)
    assert test.fall > 1000
    assert test.p > 0.05


def test_pieces_are_a_period_long_and_no_shorter_than_what_is_left_remembers():
    rng = np.random.default_rng(2)
    white = rng.normal(size=(2, 1000, 1))
    slow = np.asarray(lfilter([1.0], [1.0, -0.95], white, axis=1))
    assert paired_test(2 * white, white, ONE, 50).pieces == 40
    assert paired_test(2 * white, white, ONE, 800).pieces == 12
    short = slow[:, :600]
    assert 60 < correlation_length(short) < 150
    assert paired_test(2 * short, short, ONE, 150).pieces == 2 * (600 // max(correlation_length(short), 100)) <= 12


def test_what_never_forgets_is_cut_into_eight_pieces_all_the_same():
    after = np.sin(np.arange(80) / 40)[None, :, None]
    test = paired_test(3 * after, after, ONE, 80)
    assert correlation_length(after) > 10
    assert test.pieces == 8


def test_gaps_in_the_record_count_for_nothing_and_a_run_that_failed_for_no_proof():
    rng = np.random.default_rng(3)
    after = rng.normal(size=(1, 600, 1))
    with_gap = after.copy()
    with_gap[0, 100:200] = np.nan
    assert paired_test(2 * with_gap, with_gap, ONE, 50).bears_out
    failed = after.copy()
    failed[0, 300:] = np.nan
    test = paired_test(2 * after, failed, ONE, 50)
    assert np.isnan(test.p)
    assert not test.bears_out


@pytest.mark.parametrize("shrink", [0.0, 0.9])
def test_what_is_false_is_borne_out_at_most_as_often_as_the_level_says(shrink):
    rng, borne = np.random.default_rng(4), 0
    wave = np.sin(np.arange(1000) / 8)[None, :, None]
    for _ in range(400):
        noise = np.asarray(lfilter([1.0], [1.0, -shrink], rng.normal(size=(1, 1000, 1)), axis=1))
        borne += paired_test(noise, noise - 0.05 * rng.normal() * noise.std() * wave, ONE, 50).bears_out
    assert borne <= 400 * 0.05 + 3 * np.sqrt(400 * 0.05 * 0.95)


def test_what_ten_samples_show_by_chance_is_no_memory():
    shortest = [correlation_length(np.random.default_rng(seed).normal(size=(1, 10, 1))) for seed in range(200)]
    assert np.mean(np.array(shortest) == 1) > 0.9
