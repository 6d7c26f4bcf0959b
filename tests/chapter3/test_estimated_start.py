import numpy as np
import pytest
from chapter3.starts import WINDOWS, estimated_start

DT, TIME = 0.01, np.arange(1000) * 0.01
TRUTH = np.column_stack([np.cos(TIME), -np.sin(TIME)])


def turning(rate):
    """A pendulum of small swing, solved by a rotation; the first state or both are measured."""

    def run(start, time):
        angle = rate * (time - time[0])
        x = start[0] * np.cos(angle) + start[1] * np.sin(angle)
        v = start[1] * np.cos(angle) - start[0] * np.sin(angle)
        states = np.column_stack([x, v])
        return states, states

    return run


def noisy(seed, sd=0.1):
    return TRUTH + sd * np.random.default_rng(seed).standard_normal(TRUTH.shape)


def test_the_state_of_a_linear_model_is_that_of_least_squares():
    measured = noisy(0)
    found = estimated_start(turning(1.0), TIME, measured, TRUTH)
    window = slice(len(TIME) - 1 - found.samples, None)
    angle = TIME[window] - TIME[-1]
    rows = np.vstack(
        [np.column_stack([np.cos(angle), np.sin(angle)]), np.column_stack([-np.sin(angle), np.cos(angle)])]
    )
    sd = (measured - TRUTH).std(axis=0)
    weight = np.repeat(1 / sd, len(angle))
    wanted, *_ = np.linalg.lstsq(rows * weight[:, None], measured[window].T.ravel() * weight, rcond=None)
    assert found.samples == WINDOWS[-1]
    assert found.state == pytest.approx(wanted, abs=1e-6)
    assert found.sd == pytest.approx(0.1 / np.sqrt(found.samples + 1), rel=0.1)


def test_the_error_is_as_large_as_its_standard_error_says():
    found = [estimated_start(turning(1.0), TIME, noisy(seed), TRUTH) for seed in range(40)]
    scaled = np.array([(each.state - TRUTH[-1]) / each.sd for each in found])
    assert 0.75 < np.sqrt(np.mean(scaled**2)) < 1.3


def test_a_model_that_is_wrong_is_fitted_to_a_short_window():
    wrong = [estimated_start(turning(1.3), TIME, noisy(seed), TRUTH) for seed in range(10)]
    assert max(each.samples for each in wrong) < WINDOWS[-1]
    longest = 1.3 * DT * WINDOWS[-1] - DT * WINDOWS[-1]  # by how far the phase of a whole window would be off
    assert all(np.abs(each.state - TRUTH[-1]).max() < longest / 4 for each in wrong)


def test_a_state_that_is_not_measured_is_found_by_the_model():
    def seen(start, time):
        states, _ = turning(1.0)(start, time)
        return states, states[:, :1]

    guess = np.column_stack([TRUTH[:, 0], np.zeros(len(TIME))])
    found = estimated_start(seen, TIME, noisy(1)[:, :1], guess)
    assert np.abs(found.state - TRUTH[-1]).max() < 0.05


def test_without_noise_it_is_the_last_sample():
    assert estimated_start(turning(1.3), TIME, TRUTH, TRUTH).state == pytest.approx(TRUTH[-1], abs=1e-12)


def test_a_model_that_diverges_leaves_the_first_guess():
    def lost(start, time):
        nothing = np.full((len(time), 2), np.nan)
        return nothing, nothing

    found = estimated_start(lost, TIME, noisy(0), TRUTH)
    assert (found.samples, found.state.tolist()) == (0, TRUTH[-1].tolist())
    assert np.isnan(found.sd).all()
