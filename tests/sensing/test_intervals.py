import numpy as np
import pytest

from gaitdisc.errors import SamplingError
from gaitdisc.sensing.intervals import coverage, half_widths


def test_independent_errors_are_covered_as_often_as_promised():
    rng = np.random.default_rng(0)
    found = [
        coverage(errors[200:], half_widths(errors[:200], 0.9))[0]
        for errors in (rng.standard_t(3, size=(1200, 1)) for _ in range(50))
    ]
    assert np.mean(found) == pytest.approx(0.9, abs=0.01)


def test_too_few_windows():
    with pytest.raises(SamplingError, match="needs at least 9 checked windows; there are 8"):
        half_widths(np.zeros((8, 1)))
