"""Compiled steps of the trainer against torch's."""

import copy

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import nn

from gaitdisc.models.fused_steps import (
    BLOCK,
    FusedSteps,
    can_be_fused,
    exponential,
    gradient,
    layers,
    matrices_then_offsets,
    mean_squared_error,
)
from gaitdisc.models.networks import FeedForward
from gaitdisc.models.trainer import TorchSteps
from gaitdisc.models.training_settings import ScaledSamples, TrainingSettings, make_schedule


def both(samples=1000, decay=0.3):
    """Fused and torch steps on copies of one network, a manufactured target, and their schedule."""
    torch.manual_seed(3)
    network = FeedForward(9, 3)
    x = torch.randn(samples, 9)
    y = torch.sin(x[:, :3]) + x[:, 3:6] * x[:, 6:]
    part, check = ScaledSamples(x[:-100], y[:-100]), ScaledSamples(x[-100:], y[-100:])
    schedule = make_schedule(len(part[0]), decay, TrainingSettings(batch=200))
    twin = copy.deepcopy(network)
    return (
        (network, FusedSteps(network, part, check, schedule)),
        (twin, TorchSteps(twin, part, check, schedule)),
        schedule,
    )


def test_weights_after_one_epoch_are_torchs():
    (fused, by_kernels), (twin, by_torch), schedule = both()
    before = copy.deepcopy(fused.state_dict())
    order = torch.randperm(900)
    for steps in (by_kernels, by_torch):
        steps.epoch(order, schedule.rates[0])
    assert by_kernels.loss() == pytest.approx(by_torch.loss(), rel=1e-5)
    by_kernels.restore(by_kernels.weights())
    for name, wanted in twin.state_dict().items():
        moved = (wanted - before[name]).norm()
        assert moved > 0
        assert (fused.state_dict()[name] - wanted).norm() <= 1e-4 * moved


def test_weights_are_a_copy_and_the_network_gets_what_is_restored():
    (network, steps), _, schedule = both()
    before = copy.deepcopy(network.state_dict())
    kept, loss = steps.weights(), steps.loss()
    steps.epoch(torch.arange(900), schedule.rates[0])
    assert steps.loss() != loss
    steps.restore(kept)
    assert steps.loss() == loss
    assert all(torch.equal(values, before[name]) for name, values in network.state_dict().items())
    steps.epoch(torch.arange(900), schedule.rates[0])
    assert not np.array_equal(steps.weights(), kept)  # what was restored is still a copy


def test_only_the_dissertations_own_network_in_float32_is_fused():
    class Made(FeedForward):
        """Could compute something else."""

    assert can_be_fused(FeedForward(3, 2, nodes=5))
    assert not can_be_fused(Made(3, 2))
    assert not can_be_fused(FeedForward(3, 2).double())


def vector(tensors):
    return torch.cat([t.detach().reshape(-1) for t in tensors]).float().numpy()


def drawn(samples, inputs, nodes, outputs, seed):
    torch.manual_seed(seed)
    return FeedForward(inputs, outputs, nodes), torch.randn(samples, inputs), torch.randn(samples, outputs)


def test_the_exponential_is_exact_to_two_roundings_and_keeps_nan():
    x = np.linspace(-87, 88, 20_001).astype(np.float32)
    found = np.array([exponential(value) for value in x], dtype=float)
    np.testing.assert_allclose(found, np.exp(x.astype(float)), rtol=2.5e-7)
    assert np.isnan(exponential(np.float32(np.nan)))
    assert 0 < exponential(np.float32(-np.inf)) < 2e-38
    assert np.isfinite(exponential(np.float32(np.inf)))


def test_layers_are_views_that_cover_the_vector_once():
    whole = np.arange(3 * 4 + 16 + 8 + 4 + 4 + 2, dtype=np.float32)
    parts = layers(whole, 3, 4, 2)
    np.testing.assert_array_equal(np.concatenate([part.ravel() for part in parts]), whole)
    assert all(np.shares_memory(part, whole) for part in parts)


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 300), st.integers(1, 60), st.integers(1, 70), st.integers(1, 9), st.integers(0, 999))
def test_the_gradients_of_two_blocks_add_up_to_autograds(samples, inputs, nodes, outputs, seed):
    network, x, y = drawn(samples, inputs, nodes, outputs, seed)
    weights = vector(matrices_then_offsets(network))
    found, hidden = np.zeros_like(weights), np.empty((5, samples + 3, nodes), np.float32)
    for block in (slice(0, samples // 3), slice(samples // 3, samples)):
        added = np.empty_like(weights)
        gradient(weights, added, x.numpy()[block], y.numpy()[block], hidden, samples)
        found += added
    exact = network.double()
    nn.functional.mse_loss(exact(x.double()), y.double()).backward()
    gradients = [p.grad for p in matrices_then_offsets(exact)]
    for part, wanted in zip(layers(found, inputs, nodes, outputs), gradients, strict=True):
        assert wanted is not None
        assert np.linalg.norm(part - wanted.numpy()) <= 1e-5 * np.linalg.norm(wanted.numpy()) + 1e-7


@pytest.mark.parametrize("samples", [1, BLOCK - 1, BLOCK, 3 * BLOCK + 5])
def test_the_loss_is_torchs_whole_and_in_blocks(samples):
    network, x, y = drawn(samples, 5, 6, 2, samples)
    weights = vector(matrices_then_offsets(network))
    with torch.no_grad():
        wanted = float(nn.functional.mse_loss(network(x), y))
    assert mean_squared_error(weights, x.numpy(), y.numpy(), 6) == pytest.approx(wanted, rel=1e-5)


def test_missing_numbers_and_overflow_show_in_the_loss():
    network, x, y = drawn(4, 3, 5, 2, 0)
    weights = vector(matrices_then_offsets(network))
    holed, large = weights.copy(), weights.copy()
    holed[0], large[-1] = np.nan, 1e30
    assert np.isnan(mean_squared_error(holed, x.numpy(), y.numpy(), 5))
    assert np.isinf(mean_squared_error(large, x.numpy(), y.numpy(), 5))
