"""A low-pass is found where there is one, at its cut-off; raw records, smooth ones and rounded ones show none."""

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfiltfilt

from gaitdisc.signals.recorded_filter import recorded_filter, spectrum_of

RATE = 100.0
TIME = np.arange(3000) / RATE


def _signal(seed):
    """A mass on a spring that noise pushes: its spectrum falls with the fourth power of frequency."""
    push = np.random.default_rng(seed).normal(size=len(TIME))
    slow = sosfiltfilt(butter(4, 1.0, fs=RATE, output="sos"), lfilter([1.0], [1, -1.98, 0.984], push))
    return slow / slow.std()


def _trials(noise, cutoff=None, order=2, signal=_signal):
    trials = [signal(seed) + noise * np.random.default_rng(99 + seed).normal(size=len(TIME)) for seed in range(4)]
    if cutoff is None:
        return trials
    return [sosfiltfilt(butter(order, cutoff, fs=RATE, output="sos"), one) for one in trials]


@pytest.mark.parametrize(("cutoff", "noise"), [(3.0, 0.1), (6.0, 0.01), (6.0, 0.1), (10.0, 0.01), (10.0, 0.1)])
def test_the_cut_off_is_found(cutoff, noise):
    found = recorded_filter(_trials(noise, cutoff), RATE)
    assert found.cutoff_hz == pytest.approx(cutoff, rel=0.06)
    assert found.gained > 100 and found.signal < 0.1


def test_gaps_and_written_digits_do_not_matter():
    trials = [np.round(one, 4) for one in _trials(0.02, 6.0)]
    for trial in trials:
        trial[700:730] = trial[2100:2110] = np.nan
    assert recorded_filter(trials, RATE).cutoff_hz == pytest.approx(6.0, rel=0.06)


def test_raw_records_show_none():
    assert recorded_filter(_trials(0.02), RATE) is None
    assert recorded_filter([np.round(one, 3) for one in _trials(1e-5)], RATE) is None
    slow = [lfilter([0.05], [1, -0.95], one) for one in _trials(1.0)]
    assert recorded_filter(slow, RATE) is None


def test_a_smooth_signal_without_noise_is_one_with_a_signal_in_the_way_or_none():
    found = recorded_filter(_trials(0.0), RATE)
    assert found is None or found.signal > 10


def _broad(seed):
    return lfilter([1.0], [1, -1.8, 0.81], np.random.default_rng(seed).normal(size=len(TIME)))


def test_where_the_signal_is_in_the_way_a_like_one_helps():
    trials, like = _trials(0.02, 6.0, signal=_broad), [1.2 * _broad(seed) for seed in range(4)]
    found = recorded_filter(trials, RATE, like)
    assert found.cutoff_hz == pytest.approx(6.0, rel=0.1)
    assert recorded_filter([_broad(seed) for seed in range(4)], RATE, like) is None


def test_a_record_too_short_shows_none():
    assert recorded_filter([np.zeros(127)], RATE) is None
    assert spectrum_of([np.full(500, np.nan)]) is None


def test_the_spectrum_is_that_of_whole_stretches():
    trial = np.sin(2 * np.pi * 10 * TIME)
    trial[1000:1005] = np.nan
    spectrum = spectrum_of([trial])
    assert spectrum.frequency[np.argmax(spectrum.power)] == pytest.approx(0.1, abs=0.003)
    assert spectrum.windows == 2 + 6


def test_a_steeper_filter_is_not_taken_for_one_of_order_2():
    assert recorded_filter(_trials(0.1, 6.0, order=4), RATE) is None
