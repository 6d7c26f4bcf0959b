"""A sensor that wanders at random, and a state: what it read a quarter of a second ago."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch
from scipy.ndimage import gaussian_filter1d

from gaitdisc.channel import Channel
from gaitdisc.models.trained_network import TrainedNetwork
from gaitdisc.reconstruction.window_model import ENSEMBLE, MEMBERS, Ensemble, WindowModel, make_network, sensing
from gaitdisc.reconstruction.windows import Lags, split_within
from gaitdisc.recording import Recording, fit_scale


@pytest.fixture(scope="session")
def pair():
    noise = np.random.default_rng(0).normal(size=3025)
    a = gaussian_filter1d(noise, 4.0) * 4
    values = np.column_stack([a[25:], a[:-25]])
    channels = (Channel("a", "angle", "deg"), Channel("late", "angle", "deg"))
    recording = Recording(np.arange(3000) / 100, values, channels, "P01")
    what = sensing(("a", "late"), ("a",), Lags(11, 5), 100.0)
    phi = 100 * (recording.time % 1.0)
    windows = what.windows(recording, phi)
    return SimpleNamespace(
        recording=recording, what=what, channels=channels, parts=split_within([windows], "temporal", what.reach_s)
    )


@pytest.fixture
def untrained(pair):
    """A network of a kind as it is before the first step: what carries it need not know what it has learnt."""

    def made(kind):
        torch.manual_seed(0)
        seen = pair.parts.fitted()
        networks = [
            make_network(kind, 1)(len(seen.inputs), len(seen.outputs))
            for _ in range(MEMBERS if kind == ENSEMBLE else 1)
        ]
        scales = fit_scale(seen.x), fit_scale(seen.y)
        members = tuple(TrainedNetwork(seen.inputs, seen.outputs, *scales, network) for network in networks)
        model = Ensemble(members) if kind == ENSEMBLE else members[0]
        return WindowModel(kind, pair.what, model, len(seen), 0.0)

    return made
