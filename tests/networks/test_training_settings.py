from __future__ import annotations

from typing import Any

import pytest

from gaitdisc.errors import TrainingError
from gaitdisc.networks.training_settings import TrainingSettings


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"epochs": 0}, "needs epochs above 0; epochs is 0"),
        ({"learning_rate": -1.0}, "needs learning_rate above 0; learning_rate is -1"),
        ({"decays": ()}, "needs at least one weight decay; decays is empty"),
        ({"decays": (0.1, -0.2)}, "needs weight decays of 0 or more; decays holds -0.2"),
        ({"inner_share": 1.0}, "needs an inner_share between 0 and 1; it is 1.0"),
        ({"arithmetic": "fast"}, "needs arithmetic 'auto' or 'torch'; it is 'fast'"),
        ({"precision": "float16"}, "needs precision 'float32' or 'bfloat16'; it is 'float16'"),
    ],
)
def test_settings_that_train_nothing_are_refused(wrong: dict[str, Any], words):
    with pytest.raises(TrainingError, match=words):
        TrainingSettings(**wrong)
