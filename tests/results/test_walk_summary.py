from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.errors import ShapeError


def test_light_and_counts(walk):
    assert walk.worst == "warning"
    assert replace(walk, findings=()).worst == "clean"
    assert walk.counted() == {"l": 1, "r": 1}
    assert walk.counted(kept=False) == {"r": 1}


def test_curves_have_101_points(walk):
    with pytest.raises(ShapeError, match=r"101, 2\).*\(4, 100, 2\).*P01"):
        replace(walk, curves=np.zeros((4, 100, 2)))
