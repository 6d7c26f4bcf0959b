import numpy as np
import pytest

from gaitdisc.discovery.catalogue import GRIDS
from gaitdisc.discovery.grids import Rhythm, cells, delays, find_rhythm, grid

RHYTHM = Rhythm(period=1.6, duration=20.0, rate=50.0)
ALONG = np.linspace(-1.0, 3.0, 401)


@pytest.mark.parametrize("period", [0.5, 1.6, 4.0])
def test_the_period_of_a_sine_is_read_off(period):
    t = np.arange(1000) / 50
    seen = np.sin(2 * np.pi * t / period) + np.random.default_rng(0).normal(0, 0.1, 1000)
    assert find_rhythm(seen[None, :, None], 50.0).period == pytest.approx(period, rel=0.05)


def test_the_offset_and_scale_of_a_channel_do_not_count():
    t = np.arange(800) / 50
    seen = np.sin(2 * np.pi * t)[None, :, None]
    assert find_rhythm(1e3 * seen + 5e4, 50.0).period == pytest.approx(find_rhythm(seen, 50.0).period)


def test_shorter_trials_are_padded_with_nan():
    t = np.arange(1000) / 50
    two = np.stack([np.sin(2 * np.pi * t / 2), np.where(t < 10, np.sin(2 * np.pi * t / 2), np.nan)])[..., None]
    rhythm = find_rhythm(two, 50.0)
    assert rhythm.period == pytest.approx(2.0, rel=0.05)
    assert (rhythm.duration, rhythm.rate) == (20.0, 50.0)


def test_thresholds_lie_inside_what_is_visited():
    at = grid("quantiles of x", ALONG, RHYTHM)
    assert ALONG.min() < at.min() < at.max() < ALONG.max()
    assert np.all(np.diff(at) > 0)


def test_half_widths_are_positive():
    assert grid("half widths of x", ALONG, RHYTHM).min() > 0


def test_delays_reach_half_a_period_and_are_half_a_sample_at_least():
    assert delays(RHYTHM).max() == pytest.approx(0.55 * RHYTHM.period)
    assert delays(Rhythm(0.1, 20.0, 50.0)).min() == pytest.approx(0.01)


def test_frequencies_are_spaced_as_the_record_can_tell_them():
    at = grid("frequencies", ALONG, RHYTHM)
    np.testing.assert_allclose(np.diff(at), np.pi / RHYTHM.duration)
    assert at.min() == pytest.approx(2 * np.pi / RHYTHM.duration)


def test_a_long_record_does_not_make_an_endless_grid():
    assert len(grid("frequencies", ALONG, Rhythm(0.2, 5000.0, 100.0))) == 240


def test_phases_go_once_around_the_stride():
    at = grid("phases", ALONG, RHYTHM)
    np.testing.assert_allclose(np.diff(np.append(at, 1 + at[0])), 0.05)


@pytest.mark.parametrize("kind", GRIDS)
def test_every_grid_of_the_catalogue_has_points(kind):
    assert np.isfinite(grid(kind, ALONG, RHYTHM)).all()


def test_cells_are_every_combination():
    made = cells({"c": "phases", "w": "phase widths"}, ALONG, RHYTHM)
    assert len(made) == 20 * 4 == len({(one["c"], one["w"]) for one in made})
    assert cells({}, ALONG, RHYTHM) == [{}]


def test_gaps_of_one_channel_after_the_other_leave_the_period():
    t = np.arange(1000) / 50
    seen = np.stack([np.sin(2 * np.pi * t / 2), np.cos(2 * np.pi * t / 2)], axis=1)
    seen[::2, 0] = np.nan
    seen[1::2, 1] = np.nan
    assert find_rhythm(seen[None], 50.0).period == pytest.approx(2.0, rel=0.05)
