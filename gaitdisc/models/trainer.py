"""One trainer for every network: the inner block decides, the held-out part is never seen."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, cast

import numpy as np
import torch
from torch import Tensor, nn

from gaitdisc.errors import TrainingError
from gaitdisc.models.descent import Descent, descend
from gaitdisc.models.ridge import LEAST_BEFORE_INNER, LEAST_SAMPLES, SEAM_S
from gaitdisc.models.trained_network import TrainedNetwork, pin_threads
from gaitdisc.models.training_settings import ScaledSamples, TrainingSettings, make_schedule
from gaitdisc.recording import Samples, Scale, fit_scale
from gaitdisc.recording.arrays import Values


@dataclass(frozen=True, eq=False)
class Training:
    """A trained network and how it came about."""

    network: TrainedNetwork
    decay: float  # weight decay that did best on the inner block
    penalty: float  # readout penalty that did best there; 0 where nothing is solved
    epochs: int  # of the descent with that decay
    best_epoch: int  # the one whose weights were kept
    # mean squared error of the scaled outputs on the inner block after every one of these epochs
    losses: tuple[float, ...]
    n_training: int  # samples of the whole training part
    n_inner: int  # samples of its inner block
    seconds: float  # Wall-clock time of everything, all candidates included [s]
    # what computed the descent: `fused`, the compiled code for the dissertation's network on the CPU, or `torch`
    arithmetic: str


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
    of the epochs at half the learning rate, so that a further decay is also a further descent. That takes 0.6 of the
    time of descents from scratch; R2 on signals like gait was the same (studies/results/speed.md).

    The hidden layers are not descended again on all samples: checked on a further block of the training part of two
    runs of 60 s (ten angles; two seeds), keep-and-solve had a mean R2 of 0.9842 and 0.9794, refit-and-solve 0.9843 and
    0.9797 (decay 0.1, penalty 1e-4), at half the time.

    Where a check part is given, it is the inner block, and takes no part in the last layer either: its errors remain
    errors on samples that were not fitted.

    build: makes a torch module with `features` and a linear `readout`, of the numbers of inputs and outputs
    check: what stops and chooses in place of the last `inner_share`: another stretch of time, or another person
    """
    begun = time.perf_counter()
    settings, progress = settings or TrainingSettings(), progress or (lambda _: None)
    samples.trainable(LEAST_SAMPLES, settings.missing_inputs)
    before, inner = samples.last_block(settings.inner_share, SEAM_S) if check is None else (samples, check)
    before.trainable(LEAST_BEFORE_INNER, settings.missing_inputs)
    device = choose_device(settings.device)
    x_scale, y_scale = fit_scale(before.x), fit_scale(before.y)
    part, checked, whole = (_tensors(s, x_scale, y_scale, device) for s in (before, inner, samples))
    with pin_threads(settings.threads), torch.random.fork_rng():
        best = _best_candidate(build, part, checked, settings, progress)
        if settings.solved:
            solve_readout(best.network, whole, best.penalty)
    progress(1.0)
    return Training(
        network=TrainedNetwork(samples.inputs, samples.outputs, x_scale, y_scale, best.network.cpu()),
        decay=best.decay,
        penalty=best.penalty,
        epochs=len(best.descent.losses),
        best_epoch=best.descent.best_epoch,
        losses=best.descent.losses,
        n_training=len(samples),
        n_inner=len(inner),
        seconds=time.perf_counter() - begun,
        arithmetic=best.descent.arithmetic,
    )


def resolve(model: TrainedNetwork, samples: Samples, inner_share: float = 0.15) -> TrainedNetwork:
    """Return a network with the same hidden layers and its last layer solved for other samples."""
    before, inner = samples.last_block(inner_share, SEAM_S)
    scales = model.x_scale, model.y_scale
    part, checked, whole = (_tensors(each, *scales, torch.device("cpu")) for each in (before, inner, samples))
    network = copy.deepcopy(model.network)
    with pin_threads(1):
        solve_readout(network, whole, choose_penalty(network, part, checked)[0])
    return replace(model, network=network)


@dataclass(frozen=True, eq=False)
class _Candidate:
    network: nn.Module
    descent: Descent
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
        descent = descend(network, part, check, steps, settings, shared)
        scored = choose_penalty(network, part, check) if settings.solved else (0.0, min(descent.losses))
        candidate = _Candidate(network, descent, decay, *scored)
        if best is not None and candidate.loss >= best.loss:
            break
        best, network = candidate, copy.deepcopy(network)
    assert best is not None  # settings refuse to be without a decay
    return best


def choose_device(wanted: str) -> torch.device:
    """Device to train on.

    wanted: `cpu`, `cuda`, or `auto`: the GPU where there is one

    >>> choose_device("cpu")
    device(type='cpu')
    """
    there = torch.cuda.is_available()
    if wanted == "auto":
        return torch.device("cuda" if there else "cpu")
    if wanted == "cpu" or (wanted == "cuda" and there):
        return torch.device(wanted)
    raise TrainingError(
        f"torch must find the requested device, {wanted!r}",
        "it finds " + ("a GPU and the CPU" if there else "no GPU, only the CPU"),
        "Use device 'auto', which uses a GPU if there is one.",
    )


def _tensors(samples: Samples, x_scale: Scale, y_scale: Scale, device: torch.device) -> ScaledSamples:
    x, y = x_scale.scaled(samples.x), y_scale.scaled(samples.y)
    return ScaledSamples(*(torch.from_numpy(one.astype(np.float32)).to(device) for one in (x, y)))


PENALTIES = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


def solve_readout(network: nn.Module, part: ScaledSamples, penalty: float) -> None:
    """Replace the last layer by its ridge least squares solution for the features as they are.

    Minimises sum (y - W h - b)^2 / samples + penalty sum W^2, in double precision; b is not penalised.

    network: with `features` and a linear layer `readout`; its readout is changed in place
    """
    readout = cast(nn.Linear, network.readout)
    network.eval()
    with torch.no_grad():
        weights, offset = _ridge(_features(network, part.x), part.y.cpu().double().numpy())(penalty)
        readout.weight.copy_(torch.from_numpy(weights))
        readout.bias.copy_(torch.from_numpy(offset))


def choose_penalty(network: nn.Module, part: ScaledSamples, check: ScaledSamples) -> tuple[float, float]:
    """Penalty of the readout that does best on a check part, and the mean squared error it reaches there.

    part, check: what it solves on, and is checked by
    returns penalty, loss: one of `PENALTIES`; mean squared error of the scaled outputs
    """
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
