import numpy as np
import pytest
import torch

from gaitdisc.model import Model
from gaitdisc.networks.ensemble import Ensemble, member_path, save_ensemble
from gaitdisc.networks.shallow_decoder import ShallowDecoder
from gaitdisc.networks.trained_network import TrainedNetwork, load_network
from gaitdisc.recording import scale_of


@pytest.fixture
def five():
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=(30, 3)), rng.normal(5, 2, (30, 2))
    members = []
    for seed in range(5):
        torch.manual_seed(seed)
        members.append(TrainedNetwork(("a", "b", "c"), ("d", "e"), scale_of(x), scale_of(y), ShallowDecoder(3, 2)))
    return Ensemble(tuple(members))


def test_mean_and_spread_of_its_members(five):
    x = np.random.default_rng(1).normal(size=(7, 3))
    each = np.array([member(x) for member in five.members])
    assert isinstance(five, Model)
    np.testing.assert_array_equal(five(x), each.mean(axis=0))
    np.testing.assert_array_equal(five.spread(x), each.std(axis=0))
    alone = Ensemble(five.members[:1])
    assert (alone.spread(x) == 0).all()
    assert (five.inputs, five.outputs) == (("a", "b", "c"), ("d", "e"))
    assert five.x_scale is five.members[0].x_scale and five.y_scale is five.members[0].y_scale


def test_every_member_has_its_file(five, tmp_path):
    save_ensemble(five, tmp_path / "weights.npz")
    loaded = [load_network(member_path(tmp_path / "weights.npz", k), ShallowDecoder) for k in range(1, 6)]
    x = np.ones((2, 3))
    np.testing.assert_array_equal(Ensemble(tuple(loaded))(x), five(x))
