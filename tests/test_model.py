from dataclasses import dataclass

import numpy as np
import pytest

from gaitdisc.errors import ShapeError
from gaitdisc.model import Augmented, Model


@dataclass(frozen=True)
class Line:
    slope: float
    inputs: tuple[str, ...] = ("x",)
    outputs: tuple[str, ...] = ("y",)

    def __call__(self, x):
        return self.slope * x


def test_models_add():
    both = Augmented(Line(2.0), Line(-0.5))
    assert isinstance(both, Model)
    np.testing.assert_array_equal(both(np.array([[2.0]])), [[3.0]])
    np.testing.assert_array_equal(Augmented(both, Line(1.0))(np.array([[2.0]])), [[5.0]])


def test_models_of_other_outputs_do_not_add():
    with pytest.raises(ShapeError, match=r"1.*in y"):
        Augmented(Line(1.0), Line(1.0, outputs=("z",)))
    with pytest.raises(ShapeError, match="in their order"):
        Augmented(Line(1.0, inputs=("a", "b")), Line(1.0, inputs=("b", "a")))
