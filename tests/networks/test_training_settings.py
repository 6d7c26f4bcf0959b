from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import torch

from gaitdisc.errors import TrainingError
from gaitdisc.networks.training_settings import TrainingSettings, epochs_of, schedule_of


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


def test_rates_are_those_of_torchs_cosine():
    schedule = schedule_of(300, 0.1, TrainingSettings(batch=100))
    adam = torch.optim.AdamW([torch.nn.Parameter(torch.zeros(1))], lr=1e-2)
    cosine = torch.optim.lr_scheduler.CosineAnnealingLR(adam, schedule.rates.size)
    expected = []
    for _ in range(schedule.rates.size):
        expected.append(adam.param_groups[0]["lr"])
        adam.step()
        cosine.step()
    np.testing.assert_allclose(schedule.rates.ravel(), expected, rtol=1e-9, atol=1e-15)


def test_short_recordings_get_a_thousand_steps():
    for samples in (1, 255, 257, 20_000):
        rates = schedule_of(samples, 0.0, TrainingSettings()).rates
        assert rates.shape == (epochs_of(samples, TrainingSettings()), math.ceil(samples / 256))
        assert rates.size >= 1000


def test_going_on_takes_a_third_of_the_epochs_from_half_the_rate():
    first = schedule_of(2560, 0.1, TrainingSettings())
    second = first.continued(0.3)
    assert (second.rates.shape, second.decay, second.batch) == ((34, 10), 0.3, 256)
    assert second.rates[0, 0] == first.rates[0, 0] / 2
    assert np.all(np.diff(second.rates.ravel()) < 0)
