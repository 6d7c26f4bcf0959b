from __future__ import annotations

import math

import numpy as np
import torch

from gaitdisc.networks.schedule import epochs_of, schedule_of
from gaitdisc.networks.training_settings import TrainingSettings


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
