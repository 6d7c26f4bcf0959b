"""A band on what the models of a person predict, from refits that leave one block of the walk out after the other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gaitdisc.model import Model, augment
from gaitdisc.recording import Samples
from gaitdisc.response.models import ResponseModels
from gaitdisc.results.participant_response import MODELS

BLOCKS, LEVEL = 8, 0.9
STRIDES = 2  # of a block that counts as one: 24 simulated people of 60 s had 90.2 % inside, with single strides 88.4 %
PARTS = 20  # of the stride: errors are larger where a foot lands than where it hangs
FEWEST_ERRORS, MOST_ERRORS = 20, 400  # of a part; with fewer, those of the whole stride count
SHORTEST_S = 16.0  # of a training part: two seconds a block, a stride or two
SEAM_S = 0.3  # zero-lag filters look ahead over the seam

Refit = Callable[[Model, Samples], Model]
Member = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int_]]


def response_bands(
    models: ResponseModels, refit: Refit, nominal: Samples, exo: Samples, held: Samples
) -> dict[str, NDArray[np.float64]]:
    """Lower and upper bound of each model's prediction, (bound, sample, output) [unit/s2], by model.

    Of eight contiguous blocks of the training part one after the other is left out, the models are fitted to the rest,
    and their errors on the block, at the same part of the stride, stand around their predictions. What a Nominal model
    misses of device walking was in no block of nominal walking: its band covers less there, which is a finding. The
    samples of a stride err together: the unit that is exchangeable is a block of two strides, and with K of them the
    quantile is that of 90 % times (1 + 1/K). None where a training part is shorter than 16 s.

    refit: takes a model and samples, and gives the model as it is fitted to these
    nominal, exo: training parts of both walks
    held: Held-out device walking, at which the models predict
    Source: Barber, Candes, Ramdas and Tibshirani 2021, Predictive inference with the jackknife+ (CV+); Dunn, Wasserman
        and Ramdas 2023, Distribution-free prediction sets for two-layer hierarchical models (pooled within groups, the
        groups counted); by part of the stride is our addition.
    """
    if min(each.time[-1] - each.time[0] for each in (nominal, exo)) < SHORTEST_S:
        return {}
    members: dict[str, list[Member]] = {name: [] for name in MODELS}
    for number in range(BLOCKS):
        (rest_nominal, left_nominal), (rest, left) = (parted(each, number) for each in (nominal, exo))
        f, y = refit(models.nominal.model, rest_nominal), refit(models.exo.model, rest)
        g = refit(models.discrepancy.model, rest.with_outputs(rest.y - f(rest.x)))
        for name, model, block in (("nominal", f, left_nominal), ("augmented", augment(f, g), left), ("exo", y, left)):
            members[name].append((model(held.x), np.abs(block.y - model(block.x)), _part(block.phi)))
    return {name: _bounds(each, _part(held.phi)) for name, each in members.items()}


def parted(samples: Samples, number: int) -> tuple[Samples, Samples]:
    """Samples without one of the blocks and what lies within 0.3 s of it, and that block."""
    cuts = np.linspace(0, len(samples), BLOCKS + 1).astype(int)
    block = samples.rows(slice(cuts[number], cuts[number + 1]))
    apart = (samples.time < block.time[0] - SEAM_S) | (samples.time > block.time[-1] + SEAM_S)
    return samples.rows(apart), block


def covered(measured: NDArray[np.float64], band: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of samples inside the band, (output,).

    >>> covered(np.array([[1.0], [3.0]]), np.array([[[0.0], [0.0]], [[2.0], [2.0]]]))
    array([0.5])
    """
    return np.mean((band[0] <= measured) & (measured <= band[1]), axis=0)


def _part(phi: NDArray[np.float64]) -> NDArray[np.int_]:
    return np.clip((phi * PARTS / 100).astype(int), 0, PARTS - 1)


def _bounds(members: list[Member], parts: NDArray[np.int_]) -> NDArray[np.float64]:
    """CV+ in each part of the stride, at the level of so many blocks of strides."""
    predicted = np.array([member[0] for member in members])
    whose = np.concatenate([np.full(len(missed), k) for k, (_, missed, _) in enumerate(members)])
    missed, where = np.concatenate([m[1] for m in members]), np.concatenate([m[2] for m in members])
    strides = sum(1 + int(np.sum(np.diff(member[2]) < -PARTS / 2)) for member in members)
    high = min(LEVEL * (1 + STRIDES / strides), 1.0)
    bounds = np.empty((2, *predicted.shape[1:]))
    for part in np.unique(parts):
        at, errors = parts == part, where == part
        errors = np.flatnonzero(errors if errors.sum() >= FEWEST_ERRORS else np.ones(len(where), bool))
        errors = errors[:: -(-len(errors) // MOST_ERRORS)]
        around, reach = predicted[whose[errors]][:, at], missed[errors, None]
        for bound, sign, level in ((0, -1, 1 - high), (1, 1, high)):
            bounds[bound, at] = np.quantile(around + sign * reach, level, axis=0)
    return bounds
