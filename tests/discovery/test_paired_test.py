"""The paired test of held-out errors: its level kept under noise that remembers, its power where an effect acts."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter
from scipy.stats import rankdata

from gaitdisc.discovery.paired_test import ALIKE_BELOW, FEWEST_DIFFERING, compare_errors, errors_rise_p

ONE = np.ones(1)
WAVES = {"wave": np.sin(np.arange(1000) / 8)[None, :, None], "pulse": np.exp(-((np.arange(1000) / 6 - 50) ** 2))}


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(-9, 9).filter(bool), min_size=1, max_size=FEWEST_DIFFERING, unique_by=abs))
def test_the_chance_of_greater_errors_is_the_share_of_signs_whose_ranks_sum_as_high(rises):
    ranks = rankdata(np.abs(rises))
    reached = ranks[np.array(rises) > 0].sum()
    as_high = [ranks[np.array(signs) > 0].sum() >= reached for signs in product((1, -1), repeat=len(rises))]
    assert errors_rise_p(np.zeros(len(rises)), np.array(rises, float)) == pytest.approx(np.mean(as_high))


def test_pieces_that_hardly_differ_say_nothing():
    rises, alike = np.linspace(1.0, 2.0, FEWEST_DIFFERING), np.full(20, -0.9 * ALIKE_BELOW)
    zeros = np.zeros(FEWEST_DIFFERING + 20)
    assert errors_rise_p(zeros, np.concatenate([rises, alike])) == errors_rise_p(zeros[:FEWEST_DIFFERING], rises)


def test_white_noise_is_worth_its_samples_and_what_remembers_fewer():
    rng = np.random.default_rng(2)
    white = rng.normal(size=(2, 1000, 1))
    slow = np.asarray(lfilter([1.0], [1.0, -0.9], white, axis=1))
    change = 0.1 * WAVES["wave"]
    assert compare_errors(white + change, white, ONE).pieces == pytest.approx(2000, rel=0.02)
    assert compare_errors(slow + change, slow, ONE).pieces == pytest.approx(2000 * (1 - 0.81) / (1 + 0.81), rel=0.5)


def test_an_error_that_rises_is_not_borne_out():
    noise = np.random.default_rng(0).normal(size=(2, 600, 1))
    test = compare_errors(noise, 1.5 * noise, ONE)
    assert test.fall < 0
    assert test.p > 0.99
    assert not test.bears_out


def test_an_effect_that_acts_in_a_small_part_of_the_data_is_borne_out():
    noise = np.random.default_rng(1).normal(size=(1, 1000, 1))
    pulse = 2.5 * WAVES["pulse"][None, :, None]
    assert pulse[0, :, 0].astype(bool).mean() < 0.35
    assert compare_errors(noise + pulse, noise, ONE).p < 1e-4
    assert not compare_errors(noise, noise - pulse, ONE).bears_out


def test_gaps_in_the_record_count_for_nothing_and_a_run_that_failed_for_no_proof():
    rng = np.random.default_rng(3)
    after = rng.normal(size=(1, 600, 1))
    with_gap = after.copy()
    with_gap[0, 100:200] = np.nan
    assert compare_errors(2 * with_gap, with_gap, ONE).bears_out
    failed = after.copy()
    failed[0, 300:] = np.nan
    test = compare_errors(2 * after, failed, ONE)
    assert np.isnan(test.p)
    assert not test.bears_out


def test_without_a_change_there_is_nothing_to_bear_out():
    noise = np.random.default_rng(6).normal(size=(1, 100, 1))
    assert compare_errors(noise, noise, ONE).p == 1.0


@pytest.mark.parametrize("shape", WAVES)
@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_what_is_false_is_borne_out_at_most_as_often_as_the_level_says(memory, shape):
    rng, borne = np.random.default_rng(4), 0
    wave = WAVES[shape].reshape(1, -1, 1)
    for _ in range(400):
        noise = np.asarray(lfilter([1.0], [1.0, -memory], rng.normal(size=(1, 1000, 1)), axis=1))
        borne += compare_errors(noise, noise - 0.05 * rng.normal() * noise.std() * wave, ONE).bears_out
    assert borne <= 400 * 0.05 + 3 * np.sqrt(400 * 0.05 * 0.95)
