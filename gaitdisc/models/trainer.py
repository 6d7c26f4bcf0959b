"""One trainer for every network: Adam along a cosine; the inner block decides, the held-out part is never seen."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import torch
from torch import Tensor, nn

from gaitdisc.errors import TrainingError
from gaitdisc.models.networks import FeedForward
from gaitdisc.models.ridge import INNER_SHARE, LEAST_BEFORE_INNER, LEAST_SAMPLES, SEAM_S
from gaitdisc.models.trained_network import TrainedNetwork, pin_threads
from gaitdisc.models.training_settings import ScaledSamples, Schedule, TrainingSettings, make_schedule
from gaitdisc.recording import Samples, Scale, fit_scale
from gaitdisc.recording.arrays import Values

if TYPE_CHECKING:
    from gaitdisc.models.fused_steps import FusedSteps


@dataclass(frozen=True, eq=False)
class Training:
    """A trained network and how it came about."""

    network: TrainedNetwork
    decay: float  # weight decay that did best on the inner block
    losses: tuple[float, ...]  # of the descent with that decay, as `descend` gives them for the inner block
    n_training: int  # samples of the whole training part
    n_inner: int  # samples of its inner block


def train(
    samples: Samples,
    build: Callable[[int, int], nn.Module],
    settings: TrainingSettings | None = None,
    progress: Callable[[float], None] | None = None,
    check: Samples | None = None,
) -> Training:
    """Train a network on samples in order of time.

    The last `inner_share` of the samples (the inner block, contiguous, 0.3 s apart) takes no part in the descent nor in
    the scale: it stops each candidate's descent, and chooses among decays and readout penalties. Then the last layer is
    solved by ridge least squares on all samples, inner block included.

    Only the first decay starts from scratch. Each further one goes on from the weights of the one before, for a third
    of the epochs at half the learning rate, so that a further decay is also a further descent: R2 on signals like gait
    was the same in 0.6 of the time (studies/results/speed.md). The hidden layers are not descended again on all
    samples, which doubled the time for no more than 0.0003 of R2.

    Where a check part is given, it is the inner block, and takes no part in the last layer either: its errors remain
    errors on samples that were not fitted.

    build: makes a torch module with `features` and a linear `readout`, of the numbers of inputs and outputs
    check: what stops and chooses in place of the last `inner_share`: another stretch of time, or another person
    """
    settings, progress = settings or TrainingSettings(), progress or (lambda _: None)
    samples.trainable(LEAST_SAMPLES, settings.missing_inputs)
    before, inner = samples.last_block(settings.inner_share, SEAM_S) if check is None else (samples, check)
    before.trainable(LEAST_BEFORE_INNER, settings.missing_inputs)
    device = choose_device(settings.device)
    x_scale, y_scale = fit_scale(before.x), fit_scale(before.y)
    part, checked, all_data = (_tensors(s, x_scale, y_scale, device) for s in (before, inner, samples))
    with pin_threads(settings.threads), torch.random.fork_rng():
        best = _best_candidate(build, part, checked, settings, progress)
        if settings.solved:
            solve_readout(best.network, all_data, best.penalty)
    progress(1.0)
    network = TrainedNetwork(samples.inputs, samples.outputs, x_scale, y_scale, best.network.cpu())
    return Training(network, best.decay, best.losses, len(samples), len(inner))


def resolve(model: TrainedNetwork, samples: Samples) -> TrainedNetwork:
    """Return a network with the same hidden layers and its last layer solved for other samples."""
    before, inner = samples.last_block(INNER_SHARE, SEAM_S)
    scales = model.x_scale, model.y_scale
    part, checked, all_data = (_tensors(s, *scales, torch.device("cpu")) for s in (before, inner, samples))
    network = copy.deepcopy(model.network)
    with pin_threads(1):
        solve_readout(network, all_data, choose_penalty(network, part, checked)[0])
    return replace(model, network=network)


@dataclass(frozen=True, eq=False)
class _Candidate:
    network: nn.Module
    losses: tuple[float, ...]
    decay: float
    penalty: float
    loss: float


def _best_candidate(
    build: Callable[[int, int], nn.Module],
    part: ScaledSamples,
    check: ScaledSamples,
    settings: TrainingSettings,
    progress: Callable[[float], None],
) -> _Candidate:
    """Try decays from weak to strong, each from the weights of the one before, until the inner block does worse."""
    count = len(settings.decays)
    torch.manual_seed(settings.seed)
    network = build(part.x.shape[1], part.y.shape[1]).to(part.x.device)
    schedule = make_schedule(len(part.x), settings.decays[0], settings)
    best = None
    for number, decay in enumerate(settings.decays):
        shared = partial(lambda number, fraction: progress((number + fraction) / count), number)
        steps = schedule if number == 0 else schedule.continue_at(decay)
        losses = descend(network, part, check, steps, settings, shared)
        scored = choose_penalty(network, part, check) if settings.solved else (0.0, min(losses))
        candidate = _Candidate(network, losses, decay, *scored)
        if best is not None and candidate.loss >= best.loss:
            break
        best, network = candidate, copy.deepcopy(network)
    assert best is not None  # settings refuse to be without a decay
    return best


def choose_device(device: str) -> torch.device:
    """Device to train on.

    device: `cpu`, `cuda`, or `auto`: the GPU where there is one

    >>> choose_device("cpu")
    device(type='cpu')
    """
    there = torch.cuda.is_available()
    if device == "auto":
        return torch.device("cuda" if there else "cpu")
    if device == "cpu" or (device == "cuda" and there):
        return torch.device(device)
    raise TrainingError(
        f"torch must find the requested device, {device!r}",
        "it finds " + ("a GPU and the CPU" if there else "no GPU, only the CPU"),
        "Use device 'auto', which uses a GPU if there is one.",
    )


def _tensors(samples: Samples, x_scale: Scale, y_scale: Scale, device: torch.device) -> ScaledSamples:
    x, y = x_scale.scaled(samples.x), y_scale.scaled(samples.y)
    return ScaledSamples(*(torch.from_numpy(array.astype(np.float32)).to(device) for array in (x, y)))


PENALTIES = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


def solve_readout(network: nn.Module, part: ScaledSamples, penalty: float) -> None:
    """Replace the last layer by its ridge least squares solution for the features as they are.

    Minimises sum (y - W h - b)^2 / samples + penalty sum W^2, in double precision; b is not penalised.
    """
    readout = cast(nn.Linear, network.readout)
    network.eval()
    with torch.no_grad():
        weights, offset = _ridge(_features(network, part.x), part.y.cpu().double().numpy())(penalty)
        readout.weight.copy_(torch.from_numpy(weights))
        readout.bias.copy_(torch.from_numpy(offset))


def choose_penalty(network: nn.Module, part: ScaledSamples, check: ScaledSamples) -> tuple[float, float]:
    """Penalty of the readout that does best on a check part, and the mean squared error that it reaches there."""
    network.eval()
    solve = _ridge(_features(network, part.x), part.y.cpu().double().numpy())
    h, y = _features(network, check.x), check.y.cpu().double().numpy()
    losses = []
    for penalty in PENALTIES:
        weights, offset = solve(penalty)
        losses.append(float(np.mean((y - h @ weights.T - offset) ** 2)))
    best = int(np.argmin(losses))
    return PENALTIES[best], losses[best]


def _ridge(h: Values, y: Values) -> Callable[[float], tuple[Values, Values]]:
    """Ridge regression of outputs on features: penalty -> weights (output, node) and offset (output,)."""
    h_mean, y_mean = np.asarray(h.mean(axis=0), float), np.asarray(y.mean(axis=0), float)
    h, y = h - h_mean, y - y_mean
    h_h, h_y = h.T @ h / len(h), h.T @ y / len(h)

    def solve(penalty: float) -> tuple[Values, Values]:
        weights = np.asarray(np.linalg.solve(h_h + penalty * np.eye(len(h_h)), h_y).T, float)
        return weights, y_mean - weights @ h_mean

    return solve


def _features(network: nn.Module, x: Tensor) -> Values:
    with torch.no_grad():
        return cast(Any, network).features(x).cpu().double().numpy()


class TorchSteps:
    """Adam with decoupled decay on any torch module.

    Decay acts on weight matrices only; weights stay float32.

    precision: of the matrix products, `float32` or `bfloat16` (needs AVX-512 or a GPU: else torch has no LSTM)
    Source: Loshchilov and Hutter 2019, Decoupled weight decay regularization. The dissertation does not say how it
        trained.
    """

    def __init__(
        self,
        network: nn.Module,
        part: ScaledSamples,
        check: ScaledSamples,
        schedule: Schedule,
        precision: str = "float32",
    ) -> None:
        self._network, self._part, self._check, self._batch = network, part, check, schedule.batch
        able = part.x.is_cuda or "AVX512" in torch.backends.cpu.get_cpu_capability()
        self._short = able and precision == "bfloat16"
        matrices = [p for p in network.parameters() if p.ndim > 1]
        others = [p for p in network.parameters() if p.ndim <= 1]
        groups = [{"params": matrices, "weight_decay": schedule.decay}, {"params": others, "weight_decay": 0.0}]
        self._adam = torch.optim.AdamW(groups, fused=True)

    def epoch(self, order: Tensor, rates: Values) -> None:
        """Step through all samples once, in an order (sample,), at the learning rate of each step (step,)."""
        self._network.train()
        x, y = (values[order.to(values.device)] for values in self._part)
        for step, rate in enumerate(rates.tolist()):
            rows = slice(step * self._batch, (step + 1) * self._batch)
            for group in self._adam.param_groups:
                group["lr"] = rate
            self._adam.zero_grad()
            with torch.autocast(x.device.type, torch.bfloat16, enabled=self._short):
                estimate = self._network(x[rows])
            nn.functional.mse_loss(estimate.float(), y[rows]).backward()
            self._adam.step()

    def loss(self) -> float:
        """Mean squared error of the scaled outputs on the check part."""
        self._network.eval()
        with torch.no_grad():
            return float(nn.functional.mse_loss(self._network(self._check.x), self._check.y))

    def weights(self) -> dict[str, Any]:
        """Copy of the weights as they are: a reference would follow the descent."""
        return copy.deepcopy(self._network.state_dict())

    def restore(self, weights: dict[str, Any]) -> None:
        """Give the network weights that it had before."""
        self._network.load_state_dict(weights)


def descend(
    network: nn.Module,
    part: ScaledSamples,
    check: ScaledSamples,
    schedule: Schedule,
    settings: TrainingSettings,
    progress: Callable[[float], None] = lambda _: None,
) -> tuple[float, ...]:
    """Train a network on a part and give it back the weights that did best on the check part.

    returns: mean squared error of the scaled outputs on the check part, after every epoch
    """
    steps: TorchSteps | FusedSteps | None = None
    if settings.arithmetic == "auto" and settings.precision == "float32":
        from gaitdisc.models.fused_steps import FusedSteps, can_be_fused

        if can_be_fused(network):
            steps = FusedSteps(cast(FeedForward, network), part, check, schedule)
    steps = steps or TorchSteps(network, part, check, schedule, settings.precision)
    order = torch.Generator().manual_seed(settings.seed)
    losses: list[float] = []
    best: Any = steps.weights()
    epochs = len(schedule.rates)
    for epoch in range(1, epochs + 1):
        steps.epoch(torch.randperm(len(part.x), generator=order), schedule.rates[epoch - 1])
        losses.append(steps.loss())
        if not math.isfinite(losses[-1]):
            raise TrainingError(
                "the training loss must stay finite",
                f"it was {losses[-1]} after epoch {epoch} of {epochs} at learning rate {schedule.rates[0, 0]:g}",
                "Use another seed or a tenth of the learning rate. Check the findings for samples far out of range.",
            )
        if losses[-1] <= min(losses):
            best = steps.weights()
        progress(epoch / epochs)
        if settings.patience and epoch - losses.index(min(losses)) > settings.patience:
            break
    steps.restore(best)
    network.eval()
    return tuple(losses)
