"""A network that is trained: a model, saved and loaded, and how many threads it takes."""

from functools import partial

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from threadpoolctl import threadpool_info

from gaitdisc.errors import SchemaError
from gaitdisc.model import Augmented, Model
from gaitdisc.models.networks import FeedForward, ShallowDecoder
from gaitdisc.models.trained_network import TrainedNetwork, pin_threads, torch_threads
from gaitdisc.reconstruction.model_folder import load_weights, save_weights
from gaitdisc.reconstruction.window_model import Ensemble
from gaitdisc.recording import fit_scale


def network(inputs=3, outputs=2, seed=0):
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    x = rng.normal(3, 2, (50, inputs))
    x[:, 0] = 4.0
    names = tuple(f"x{k}" for k in range(inputs)), tuple(f"y{k}" for k in range(outputs))
    return TrainedNetwork(
        *names, fit_scale(x), fit_scale(rng.normal(100, 9, (50, outputs))), FeedForward(inputs, outputs)
    )


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 9), st.integers(1, 4), st.integers(0, 99))
def test_loaded_equals_saved_to_the_last_bit(tmp_path_factory, inputs, outputs, seed):
    path = tmp_path_factory.mktemp("network") / "nominal.npz"
    saved = network(inputs, outputs, seed)
    save_weights(saved, path)
    loaded = load_weights(path, FeedForward)
    assert (loaded.inputs, loaded.outputs) == (saved.inputs, saved.outputs)
    for name, values in saved.weights().items():
        assert values.tobytes() == loaded.weights()[name].tobytes()
    x = np.random.default_rng(seed).normal(size=(20, inputs))
    assert saved(x).tobytes() == loaded(x).tobytes()


def test_it_is_a_model_and_adds():
    one, other = network(seed=0), network(seed=1)
    x = np.ones((4, 3))
    assert isinstance(one, Model)
    np.testing.assert_array_equal(Augmented(one, other)(x), one(x) + other(x))


def test_outputs_are_in_their_units_and_missing_inputs_stay_missing():
    y = network()(np.array([[4.0, 3.0, 3.0], [4.0, np.nan, 3.0]]))
    assert np.all(np.abs(y[0] - 100) < 50)
    assert np.isnan(y[1]).all()


def test_inputs_that_did_not_vary_weigh_nothing():
    still = network()
    np.testing.assert_array_equal(still(np.array([[4.0, 1.0, 2.0]])), still(np.array([[-50.0, 1.0, 2.0]])))


def test_a_damaged_file_and_another_kind_of_network_are_refused(tmp_path):
    path = tmp_path / "nominal.npz"
    save_weights(network(), path)
    with pytest.raises(SchemaError, match=r"nominal\.npz.*not.*FeedForward"):
        load_weights(path, partial(FeedForward, nodes=32))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(SchemaError, match=r"nominal\.npz.*a trained network"):
        load_weights(path, FeedForward)
    with pytest.raises(SchemaError, match=r"absent\.npz"):
        load_weights(tmp_path / "absent.npz", FeedForward)


@pytest.fixture
def five():
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=(30, 3)), rng.normal(5, 2, (30, 2))
    members = []
    for seed in range(5):
        torch.manual_seed(seed)
        members.append(TrainedNetwork(("a", "b", "c"), ("d", "e"), fit_scale(x), fit_scale(y), ShallowDecoder(3, 2)))
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


def test_threads_are_as_before_also_after_an_error():
    before = torch.get_num_threads()
    with pytest.raises(RuntimeError), torch_threads(3):
        assert torch.get_num_threads() == 3
        raise RuntimeError
    assert torch.get_num_threads() == before


def blas_threads():
    return [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"]


def test_every_blas_is_pinned_and_let_go_again():
    before = blas_threads()
    with pytest.raises(RuntimeError), pin_threads(1):
        assert set(blas_threads()) == {torch.get_num_threads()} == {1}
        raise RuntimeError
    assert blas_threads() == before
