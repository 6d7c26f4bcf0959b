"""Drives of trials of different lengths."""

import numpy as np
import pytest

from gaitdisc.errors import ShapeError
from gaitdisc.simulation.drive import Drive


def test_trials_are_padded_and_their_lengths_kept():
    drive = Drive.of([np.ones((3, 2)), np.ones((5, 2))], 50.0, [0.0, 2.0])
    assert drive.inputs.shape == (2, 5, 2)
    assert drive.inputs[0, 3:].tolist() == [[0, 0], [0, 0]]
    assert drive.samples.tolist() == [3, 5]
    assert drive.time0.tolist() == [0.0, 2.0]
    assert not drive.inputs.flags.writeable


def test_what_does_not_fit_is_refused():
    with pytest.raises(ShapeError, match=r"\(1, 5, 2\).*\[7\]"):
        Drive(100.0, np.zeros(1), np.zeros((1, 5, 2)), np.array([7]))
    with pytest.raises(ShapeError, match="rate 0"):
        Drive(0, np.zeros(1), np.zeros((1, 5, 2)), np.array([5]))
