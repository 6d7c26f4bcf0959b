import numpy as np
import pytest

from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.recording import Samples


@pytest.fixture
def swing() -> Samples:
    """20 s of a pendulum's state, and its acceleration -9 sin x - 0.3 x'; the third input does not vary."""
    rng = np.random.default_rng(1)
    time = np.arange(2000) / 100
    x, xdot = rng.uniform(-2, 2, 2000), rng.uniform(-4, 4, 2000)
    y = np.column_stack([-9 * np.sin(x) - 0.3 * xdot, 1000 + 5 * x * xdot])
    return Samples(np.column_stack([x, xdot, np.full(2000, 7.0)]), y, ("x", "v", "still"), ("a", "b"), time, time % 1)


@pytest.fixture
def quick() -> TrainingSettings:
    return TrainingSettings(epochs=1, batch=500, decays=(0.1,))
