from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.errors import StrideError
from gaitdisc.sensing.calibration import PENALTIES, calibrated, first_strides, rehearsed
from gaitdisc.sensing.reconstructor import fit_reconstructor


@pytest.fixture
def fitted(pair):
    return fit_reconstructor("delay ridge", pair.what, pair.parts.fitted(), pair.parts.checked())


def changed(trials):
    """A person whose state is another mixture of what the sensor reads now and read a while ago, and higher by 4."""
    return [replace(s, y=s.y * 1.5 - 0.4 * s.x[:, -1:] + 4.0) for s in trials]


def test_the_rest_shares_no_reading_with_the_first_strides(pair):
    parted = first_strides(pair.parts.training, 3, pair.what.reach_s)
    windows = pair.parts.fitted()
    gap = windows.time[parted.rest][0] - parted.strides.time[-1]
    assert gap == pytest.approx(pair.what.reach_s + 0.3, abs=0.02)
    assert len(np.unique(np.floor(parted.strides.time))) == 3


def test_the_gap_is_left_in_the_trial_of_the_last_stride_alone(pair):
    one = pair.parts.fitted()
    parted = first_strides([one.rows(one.time < 3.0), one], 3, pair.what.reach_s)
    before = int((one.time < 3.0).sum())
    assert parted.rest[before:].all()
    assert not parted.rest[:before].any()


def test_another_linear_mixture_is_learnt_from_a_few_strides(pair, fitted):
    windows = changed(pair.parts.training)
    parted = first_strides(windows, 8, pair.what.reach_s)
    rest = windows[0].rows(parted.rest)
    before = np.sqrt(np.mean((fitted(rest) - rest.y) ** 2))
    after = np.sqrt(np.mean((calibrated(fitted, parted.strides, PENALTIES[0])(rest) - rest.y) ** 2))
    assert before > 4.0
    assert after < 0.01 * before


def test_a_large_penalty_takes_the_mean_error_off_and_nothing_else(pair, fitted):
    windows = changed(pair.parts.training)
    parted = first_strides(windows, 8, pair.what.reach_s)
    found = calibrated(fitted, parted.strides, 1e12)(windows[0])
    offset = (parted.strides.y - fitted(parted.strides)).mean(axis=0)
    assert np.allclose(found, fitted(windows[0]) + offset)


def test_the_penalty_is_rehearsed_on_another_person(pair, fitted):
    found = rehearsed(fitted, changed(pair.parts.training), 8)
    assert found.penalty == PENALTIES[0]
    assert np.sqrt(np.mean(found.missed**2)) < 0.05


def test_too_few_strides_are_refused_in_words(pair):
    with pytest.raises(StrideError, match=r"500 strides.*more.*P01"):
        first_strides(pair.parts.training, 500, pair.what.reach_s)
