"""The one trainer: best weights restored, the same seed the same weights, settings that are refused."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from gaitdisc.errors import TrainingError
from gaitdisc.models import trainer
from gaitdisc.models.networks import FeedForward, ShallowDecoder
from gaitdisc.models.trainer import PENALTIES, choose_device, choose_penalty, descend, solve_readout, train
from gaitdisc.models.training_settings import ScaledSamples, TrainingSettings, count_epochs, make_schedule
from gaitdisc.recording import fit_scale
from gaitdisc.statistics.r2 import r2


def same_weights(one, other):
    pairs = zip(one.network.weights().values(), other.network.weights().values(), strict=True)
    return all(a.tobytes() == b.tobytes() for a, b in pairs)


def test_it_learns_a_pendulum(swing):
    done = train(swing.rows(slice(0, 1500)), FeedForward)
    later = swing.rows(slice(1500, None))
    missed = later.y - done.network(later.x)
    assert np.all(1 - missed.var(axis=0) / later.y.var(axis=0) > 0.995)


def test_same_seed_same_weights_and_another_seed_others(swing, quick, trained_briefly):
    first = train(swing, FeedForward, quick)
    torch.rand(10)  # the global generator is neither used nor moved
    assert same_weights(first, train(swing, FeedForward, quick))
    assert not same_weights(first, train(swing, FeedForward, replace(quick, seed=1)))


def test_training_leaves_the_global_generator_alone(swing, quick, trained_briefly):
    torch.manual_seed(5)
    expected = torch.rand(3)
    torch.manual_seed(5)
    train(swing, FeedForward, quick)
    assert torch.equal(torch.rand(3), expected)


def test_the_scale_never_sees_the_inner_block(swing, quick, trained_briefly):
    before = swing.time < swing.last_block(quick.inner_share)[1].time[0] - 0.3
    shifted = replace(swing, x=swing.x + 100.0 * ~before[:, None], y=swing.y - 50.0 * ~before[:, None])
    network = train(shifted, FeedForward, quick).network
    for found, wanted in ((network.x_scale, fit_scale(swing.x[before])), (network.y_scale, fit_scale(swing.y[before]))):
        np.testing.assert_array_equal(found.mean, wanted.mean)
        np.testing.assert_array_equal(found.sd, wanted.sd)


def test_the_last_layer_stays_as_it_was_descended_where_that_is_wanted(swing, quick, trained_briefly):
    done = train(swing, FeedForward, replace(quick, solved=False))
    assert not same_weights(done, train(swing, FeedForward, quick))


def test_numbers_of_the_training_are_told(swing, quick):
    told = []
    done = train(swing, FeedForward, replace(quick, decays=(0.1, 30.0)), told.append)
    assert (done.n_training, done.n_inner) == (2000, 300)
    assert len(done.losses) == 250  # 4 batches of 500: 1,000 steps
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert done.decay == 0.1


def test_decays_are_tried_each_from_the_one_before_until_the_inner_block_does_worse(swing, quick, monkeypatch):
    tried, first_losses = [], []

    def descend_and_tell(network, part, check, schedule, *rest):
        tried.append(schedule.decay)
        done = descend(network, part, check, schedule, *rest)
        first_losses.append(done[0])
        return done

    monkeypatch.setattr(trainer, "descend", descend_and_tell)
    train(swing, FeedForward, replace(quick, decays=(0.1, 0.1, 30.0, 0.2)))
    assert tried == [0.1, 0.1, 30.0]
    assert first_losses[1] < first_losses[0] / 10


def test_a_worse_decay_leaves_the_weights_of_the_better(swing, quick):
    alone = train(swing, FeedForward, replace(quick, decays=(0.1,)))
    assert same_weights(alone, train(swing, FeedForward, replace(quick, decays=(0.1, 30.0))))


def test_compiled_code_and_torch_give_one_r2(swing):
    """The pendulum with noise in its acceleration, so that no path can be perfect."""
    rng = np.random.default_rng(2)
    noisy = swing.with_outputs(swing.y + 0.3 * swing.y.std(axis=0) * rng.normal(size=swing.y.shape))
    part, later = noisy.rows(slice(0, 1500)), swing.rows(slice(1500, None))
    done = {name: train(part, FeedForward, TrainingSettings(arithmetic=name)) for name in ("auto", "torch")}
    assert done["auto"].losses != done["torch"].losses  # rounding shows that two codes were at work
    found, wanted = (r2(later.y, done[name].network(later.x)) for name in ("auto", "torch"))
    assert np.all(wanted > 0.9)
    np.testing.assert_allclose(found, wanted, atol=0.005)


def test_a_constant_input_weighs_nothing(swing, quick, trained_briefly):
    network = train(swing, FeedForward, quick).network
    assert network.x_scale.constant.tolist() == [name == "still" for name in swing.inputs]
    assert np.isfinite(network(swing.x)).all()


def test_too_few_samples_constant_outputs_and_missing_numbers_are_refused(swing, quick):
    with pytest.raises(TrainingError, match=r"3 inputs.*2 outputs.*50 samples.*49 usable"):
        train(swing.rows(slice(0, 49)), FeedForward, quick)
    sparse = replace(swing.rows(slice(0, 50)), time=np.full(50, 0.1))
    with pytest.raises(TrainingError, match=r"20 samples.*0 usable"):
        train(sparse, FeedForward, quick)
    with pytest.raises(TrainingError, match=r"3.*2000 samples"):
        train(swing.with_outputs(np.column_stack([swing.y[:, 0], np.full(2000, 3.0)])), FeedForward, quick)
    hole = swing.x.copy()
    hole[70, 1] = np.nan
    with pytest.raises(TrainingError, match=r"1 of 2000.*missing.*0\.700 s"):
        train(replace(swing, x=hole), FeedForward, quick)


@pytest.mark.skipif(torch.cuda.is_available(), reason="a GPU is there")
def test_a_gpu_that_is_not_there(swing, quick):
    with pytest.raises(TrainingError, match=r"'cuda'.*no GPU.*CPU"):
        train(swing, FeedForward, replace(quick, device="cuda"))
    assert choose_device("auto").type == "cpu"


@pytest.mark.skipif(not torch.cuda.is_available(), reason="no GPU")
def test_the_gpu_learns_the_same(swing):
    network = train(swing, FeedForward, TrainingSettings(device="cuda")).network
    missed = swing.y - network(swing.x)
    assert np.all(1 - missed.var(axis=0) / swing.y.var(axis=0) > 0.995)


def test_a_given_check_part_stops_and_is_never_fitted(swing, quick):
    part, check = swing.rows(slice(0, 1500)), swing.rows(slice(1550, None))
    done = train(part, FeedForward, quick, check=check)
    assert (done.n_training, done.n_inner) == (1500, 450)
    np.testing.assert_array_equal(done.network.x_scale.mean, fit_scale(part.x).mean)
    scaled = done.network.y_scale.scaled(check.y)
    missed = np.mean((done.network.y_scale.scaled(done.network(check.x)) - scaled) ** 2)
    assert missed < 2 * min(done.losses)


def test_the_weights_that_did_best_are_restored_when_the_descent_goes_astray(swing):
    """A copy, not a reference: `best = network.state_dict()` follows the descent, and restoring it restores nothing."""
    samples = swing.with_outputs(np.random.default_rng(0).normal(size=swing.y.shape))
    part, check = samples.rows(slice(0, 100)), samples.rows(slice(200, 400))
    scales = fit_scale(part.x), fit_scale(part.y)
    tensors = [trainer._tensors(each, *scales, torch.device("cpu")) for each in (part, check)]
    torch.manual_seed(0)
    network = ShallowDecoder(3, 2)
    settings = TrainingSettings(epochs=60, batch=20, decays=(0.0,))
    losses = descend(network, tensors[0], tensors[1], make_schedule(100, 0.0, settings), settings)
    with torch.no_grad():
        restored = float(torch.nn.functional.mse_loss(network(tensors[1].x), tensors[1].y))
    assert losses[-1] > 1.2 * min(losses)  # noise is learnt by heart after the best epoch
    assert restored == pytest.approx(min(losses), rel=1e-6)


def features_and_noise(count=300, noise=0.0, seed=0):
    torch.manual_seed(seed)
    network = FeedForward(2, 1, nodes=4)
    x = torch.randn(count, 2)
    with torch.no_grad():
        y = network.features(x) @ torch.tensor([[1.0], [-2.0], [0.5], [3.0]]) + 4 + noise * torch.randn(count, 1)
    return network, x, y


def test_the_solution_is_the_minimum_of_the_penalised_squares():
    network, x, y = features_and_noise(noise=0.3)
    solve_readout(network, ScaledSamples(x, y), 0.01)
    h = network.features(x).detach().double().numpy()
    w = network.readout.weight.detach().double().numpy()[0]
    rest = y.double().numpy()[:, 0] - h @ w - float(network.readout.bias.detach())
    np.testing.assert_allclose(h.T @ rest / len(h), 0.01 * w, atol=1e-5)
    np.testing.assert_allclose(rest.mean(), 0.0, atol=1e-6)


def test_the_penalty_is_weak_without_noise_and_strong_for_nothing_but_noise():
    network, x, y = features_and_noise()
    part, check = ScaledSamples(x[:200], y[:200]), ScaledSamples(x[200:], y[200:])
    before = network.readout.weight.detach().clone()
    assert choose_penalty(network, part, check)[0] == PENALTIES[0]
    torch.manual_seed(1)
    noise = [ScaledSamples(each, torch.randn(len(each), 1)) for each in (x[:20], x[200:])]
    assert choose_penalty(network, *noise)[0] >= 0.01
    assert torch.equal(before, network.readout.weight)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"epochs": 0}, "must have epochs above 0; epochs is 0"),
        ({"learning_rate": -1.0}, "must have learning_rate above 0; learning_rate is -1"),
        ({"decays": ()}, "must have at least one weight decay; there is none"),
        ({"decays": (0.1, -0.2)}, "must have weight decays of 0 or more; one is -0.2"),
        ({"inner_share": 1.0}, "must have an inner_share between 0 and 1; it is 1.0"),
        ({"arithmetic": "fast"}, "must have arithmetic 'auto' or 'torch'; it is 'fast'"),
        ({"precision": "float16"}, "must have precision 'float32' or 'bfloat16'; it is 'float16'"),
    ],
)
def test_settings_that_train_nothing_are_refused(wrong: dict[str, Any], words):
    with pytest.raises(TrainingError, match=words):
        TrainingSettings(**wrong)


def test_rates_are_those_of_torchs_cosine():
    schedule = make_schedule(300, 0.1, TrainingSettings(batch=100))
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
        rates = make_schedule(samples, 0.0, TrainingSettings()).rates
        assert rates.shape == (count_epochs(samples, TrainingSettings()), math.ceil(samples / 256))
        assert rates.size >= 1000


def test_going_on_takes_a_third_of_the_epochs_from_half_the_rate():
    first = make_schedule(2560, 0.1, TrainingSettings())
    second = first.continue_at(0.3)
    assert (second.rates.shape, second.decay, second.batch) == ((34, 10), 0.3, 256)
    assert second.rates[0, 0] == first.rates[0, 0] / 2
    assert np.all(np.diff(second.rates.ravel()) < 0)
