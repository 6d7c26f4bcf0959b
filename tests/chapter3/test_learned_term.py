import numpy as np
import pytest
from chapter3.augmented_run import learned_term

from gaitdisc.errors import TrainingError


def test_another_kind_of_model_is_refused():
    with pytest.raises(TrainingError, match="found function"):
        learned_term(test_another_kind_of_model_is_refused, np.empty(0))
