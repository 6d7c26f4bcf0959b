"""Chapter 4 on two real runners: bands by refits, the Discrepancy over the stride, a search, terms of a sparse one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from itertools import pairwise

import numpy as np
import torch
from chapter3.gaussian_process import KernelKind, fit_gaussian_process
from chapter3.sindy import fit_sindy
from chapter5.gait import DATA, RUNS, exotendon
from chapter5.people import ANGLES
from further import Number
from numpy.typing import NDArray
from torch import nn

import gaitdisc as gd
from gaitdisc.cohort.cohort import make_walks
from gaitdisc.cohort.demonstration import OUTPUTS
from gaitdisc.cohort.person import MUSCLES, draw_one
from gaitdisc.ingest.study import Conditions, Models, Participant, Study
from gaitdisc.models.fourier_ridge import fit_fourier_ridge
from gaitdisc.models.networks import FeedForward
from gaitdisc.models.trainer import train
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.processing.process import processed
from gaitdisc.processing.samples import gait_samples
from gaitdisc.response.fit_response import (
    Refit,
    ResponseModels,
    ResponseSettings,
    fit_linear,
    fit_models,
    fit_network,
    fit_response,
    refit_network,
    response_bands,
    split_held_out,
)
from gaitdisc.run.run_study import response_settings

SETTINGS = ResponseSettings(ANGLES)
Parts = tuple[gd.Samples, gd.Samples]
FRESH = range(70_000, 70_040)  # seeds; those from 50,000 on were developed on
SIDES = 1.645  # standard deviations of a normal law's 90 %
Values = NDArray[np.float64]
REFITS, BLOCKS = 50, 16
RIGHT_LEG = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")


@cache
def run(who: str, condition: str) -> Parts:
    """Training part and held-out part of a run, all ten accelerations to be predicted."""
    found = {"natural": "manual_ik.mot" if who == "welk002" else RUNS[who]["natural"]}
    name = found.get(condition) or RUNS[who][condition]
    study = exotendon(DATA).model_copy(update={"models": Models(angles=ANGLES, emg=(), outputs=ANGLES)})
    trial = gd.read(next((DATA / "exotendon_run").rglob(name)))
    before, held = split_held_out(processed(trial, study).trajectory, SETTINGS)
    return gait_samples(before, ANGLES)[0], gait_samples(held, ANGLES)[0]


def band(quick: bool) -> Iterator[Number]:
    """Bands by what is fitted again on the blocks: all of a network, its last layer, a ridge regression."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    ridge = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part))
    kinds: dict[str, tuple[ResponseModels, Refit]] = {"ridge": (ridge, lambda _, part: fit_linear(part).model)}
    if not quick:
        network = fit_models(nominal, exo, fit=lambda part, progress: fit_network(part, TrainingSettings(), progress))
        kinds["network, last layer"] = (network, refit_network)
        kinds["network, whole"] = (network, lambda _, part: fit_network(part, TrainingSettings()).model)
    for kind, (models, refit) in kinds.items():
        for model, found in response_bands(models, refit, nominal, exo, held).items():
            inside = np.mean((found[0] <= held.y) & (held.y <= found[1]), axis=0)
            width = np.mean(found[1] - found[0], axis=0) / held.y.std(axis=0)
            for which, share, wide in zip(ANGLES, inside, width, strict=True):
                yield Number(f"{model.capitalize()}, {kind} refitted", "covered [%]", which, 100 * float(share))
                yield Number(f"{model.capitalize()}, {kind} refitted", "width [SD of measured]", which, float(wide))


def people(quick: bool) -> Iterator[Number]:
    """Share of the held-out samples inside the bands of `gaitdisc run`; people on whom nothing was set."""
    emg = tuple(f"{muscle}_{side}" for side in "rl" for muscle in MUSCLES)
    both = Conditions(nominal="nominal", device="exo")
    models = Models(emg=emg, outputs=OUTPUTS)
    for seed in FRESH[: 2 if quick else None]:
        person = draw_one(f"P{seed}", seed, "fm"[seed % 2])
        study = Study(conditions=both, models=models, participants=(Participant(id=person.name),))
        walks = make_walks(person, 20.0 if quick else 60.0).trials
        nominal, exo = (processed(walks[word], study).trajectory for word in both.both)
        held = fit_response(nominal, exo, response_settings(study), banded=True).held_out
        for model, found in held.bands.items():
            inside = 100 * float(np.mean((found[0] <= held.measured) & (held.measured <= found[1])))
            yield Number(model.capitalize(), "mean of the outputs [%]", str(seed), inside)


def quartiles(numbers: Iterator[Number]) -> Iterator[Number]:
    """Numbers of a table, and beside them the quartiles of each row."""
    rows: dict[str, list[float]] = {}
    for number in numbers:
        rows.setdefault(number.row, []).append(number.value)
        yield number
    for row, values in rows.items():
        for share in (25, 75):
            yield Number(row, f"quartile, {share} %", "all", float(np.percentile(values, share)))


def curve(quick: bool) -> Iterator[Number]:
    """The mean Discrepancy over the stride: error and band of each way to draw it, on the held-out strides."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    model = fit_linear(nominal).model

    def circle(samples: gd.Samples) -> gd.Samples:
        turn = 2 * np.pi * samples.phi / 100
        x = np.column_stack([np.cos(turn), np.sin(turn)])
        return gd.Samples(x, samples.y - model(samples.x), ("cos", "sin"), samples.outputs, samples.time, samples.phi)

    fitted, test = circle(exo), circle(held)
    line = tuple(replace(each, x=each.phi[:, None], inputs=("phi",)) for each in (fitted, test))
    bins = [np.minimum(each.phi.astype(int) // 2, 49) for each in (fitted, test)]
    means = np.array([test.y[bins[1] == k].mean(axis=0) for k in range(50)])[bins[1]]  # the held-out strides' own

    def said(row: str, predicted: Values, sd: Values | None = None, noise: Values | None = None) -> Iterator[Number]:
        for which, column in enumerate(ANGLES):
            of_mean = np.sqrt(np.mean((predicted - means)[:, which] ** 2)) / test.y[:, which].std()
            yield Number(row, "error of the held-out mean curve [SD]", column, float(of_mean))
            if sd is not None and noise is not None:
                inside = np.abs(predicted - means)[:, which] <= SIDES * sd[:, which]
                yield Number(row, "held-out mean curve inside the band [%]", column, 100 * float(inside.mean()))
                inside = np.abs(predicted - test.y)[:, which] <= SIDES * np.hypot(sd, noise)[:, which]
                yield Number(row, "held-out samples inside, noise added [%]", column, 100 * float(inside.mean()))

    plain = np.array([fitted.y[bins[0] == k].mean(axis=0) for k in range(50)])[bins[1]]
    yield from said("means of 2 %", plain)
    features = fit_fourier_ridge(*fitted.last_block(0.15, 0.3), features=200, seed=0)
    yield from said("200 random Fourier features, circle", features(test.x))
    processes: dict[str, tuple[KernelKind, tuple[gd.Samples, ...]]]
    processes = {"squared exponential, line": ("squared_exponential", line)}
    if not quick:
        processes["squared exponential, circle (periodic)"] = ("squared_exponential", (fitted, test))
        processes["Matern 5/2, circle (periodic)"] = ("matern_5_2", (fitted, test))
    for row, (kind, (training, later)) in processes.items():
        found = fit_gaussian_process(training.rows(slice(None, None, 4)), kind=kind, variance=True)
        yield from said(f"Gaussian process, {row}", found(later.x), found.sd(later.x), found.noise)


class Layers(nn.Module):
    """Hidden layers of one activation and a linear readout."""

    def __init__(self, inputs: int, outputs: int, layers: int, nodes: int, activation: type[nn.Module]) -> None:
        super().__init__()
        pairs = [(nn.Linear(a, b), activation()) for a, b in pairwise([inputs, *[nodes] * layers])]
        self.hidden = nn.Sequential(*(each for pair in pairs for each in pair))
        self.readout = nn.Linear(nodes, outputs)

    def features(self, x: torch.Tensor) -> torch.Tensor:
        """What the linear layer reads."""
        return self.hidden(x)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Scaled outputs."""
        return self.readout(self.hidden(x))


def search(quick: bool) -> Iterator[Number]:
    """The text's network against the winner of successive halving on inner blocks, on what neither saw."""
    of_text: dict[str, Callable] = {f"text, {n} nodes": partial(FeedForward, nodes=n) for n in (32, 64, 128)}
    others = {
        f"{layers} x {nodes} {word}": partial(Layers, layers=layers, nodes=nodes, activation=activation)
        for layers in (1, 2, 3)
        for nodes in (32, 64, 128)
        for word, activation in (("tanh", nn.Tanh), ("relu", nn.ReLU), ("logistic", nn.Sigmoid))
    }
    chosen = np.random.default_rng(0).permutation(len(others))[: 1 if quick else 5]
    builds = of_text | {name: others[name] for name in (list(others)[k] for k in chosen)}
    settings = TrainingSettings(epochs=1, decays=(0.1,))
    for who, condition in (("welk007", "natural"), ("welk007", "exotendon"), ("welk002", "natural")):
        training, held = run(who, condition)
        before, inner = training.last_block(0.15, 0.3)
        left, share = list(builds), 0.25
        while len(left) > 1:  # rungs: a quarter, a half, the whole of what is fitted
            part = before.last_block(share)[1] if share < 1 else before
            losses = {name: train(part, builds[name], settings, check=inner).losses for name in left}
            left = sorted(left, key=lambda name: min(losses[name]))[: max(1, len(left) // (4 if share == 1 else 2))]
            share = min(1.0, 2 * share)
        full = replace(settings, decays=TrainingSettings().decays)
        found = {"text, 64 nodes": FeedForward, "winner": builds[left[0]]}
        missed = {name: held.y - train(training, build, full).network(held.x) for name, build in found.items()}
        column = f"{who}, {condition}"
        for name, each in missed.items():
            share_left = np.mean(each**2, axis=0) / held.y.var(axis=0)
            yield Number(f"1 - R2, {name}", column, "", float(np.median(share_left)))
        strides = np.cumsum(np.diff(held.phi, prepend=0.0) < 0)
        text, winner = (np.sum(missed[name] ** 2 / held.y.var(axis=0), axis=1) for name in found)
        inner = [strides == k for k in np.unique(strides)[1:-1]]
        gains = np.array([1 - winner[stride].sum() / text[stride].sum() for stride in inner])
        drawn = np.random.default_rng(0).choice(gains, (2000, len(gains))).mean(axis=1)
        low, high = np.quantile(drawn, [0.025, 0.975])
        for word, value in (("low", low), ("mean", gains.mean()), ("high", high)):
            yield Number(f"error taken off by the winner, 95 % {word} [%]", column, "", 100 * float(value))
        yield Number(f"winner: {left[0]}", column, "", 1.0)


def discrepancy(nominal: gd.Samples, other: gd.Samples) -> gd.Samples:
    """What a Nominal ridge model misses of another walk, over the right leg and the place in the stride."""
    missed = other.y - fit_linear(nominal).model(other.x)
    names = (*RIGHT_LEG, *(f"d({name})/dt" for name in RIGHT_LEG))
    inputs = other.x[:, [other.inputs.index(name) for name in names]]
    turn = 2 * np.pi * other.phi[:, None] / 100
    state, harmonics = inputs / inputs.std(axis=0), [np.cos(turn), np.sin(turn), np.cos(2 * turn), np.sin(2 * turn)]
    x = np.hstack([state, *harmonics, state * harmonics[0], state * harmonics[1]])
    plain = ("hip", "knee", "ankle", "hip rate", "knee rate", "ankle rate")
    words = (*plain, "cos", "sin", "cos2", "sin2", *(f"{n} x {turned}" for turned in ("cos", "sin") for n in plain))
    columns = [ANGLES.index(name) for name in RIGHT_LEG]
    return gd.Samples(x, missed[:, columns], words, RIGHT_LEG, other.time, other.phi)


def terms(quick: bool) -> Iterator[Number]:
    """How often each term is selected, for the device and for nothing."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    half = len(nominal) // 2
    first, second = nominal.rows(slice(0, half)), nominal.rows(slice(half, None))
    pairs = (("device", nominal, exo, held), ("control", first, second, run("welk007", "natural")[1]))
    refits = 5 if quick else REFITS
    for column, before, after, later in pairs:
        samples, test = discrepancy(before, after), discrepancy(before, later)
        rng, counts = np.random.default_rng(0), {name: Counter() for name in RIGHT_LEG}
        blocks = np.array_split(np.arange(len(samples)), BLOCKS)
        for _ in range(refits):
            some = np.sort(rng.permutation(BLOCKS)[: BLOCKS // 2])
            model = fit_sindy(samples.rows(np.concatenate([blocks[k] for k in some])), 1)
            for name in RIGHT_LEG:
                counts[name].update(model.terms(name).keys())
        whole = fit_sindy(samples, 1)
        explained = 1 - np.mean((whole(test.x) - test.y) ** 2, axis=0) / np.mean(test.y**2, axis=0)
        sizes = np.sqrt(np.mean(test.y**2, axis=0))
        for name, size, held_r2 in zip(RIGHT_LEG, sizes, explained, strict=True):
            often = sum(count >= 0.9 * refits for count in counts[name].values())
            for words, value in (
                ("size of the discrepancy [deg/s2]", size),
                ("terms of the fit to all", len(whole.terms(name))),
                ("share of it explained, held out [1]", held_r2),
                ("terms selected in 9 of 10 refits", often),
                ("terms selected at least once", len(counts[name])),
            ):
                yield Number(f"{name}: {words}", column, "", float(value))
            own = sorted(((count, term) for term, count in counts[name].items()), reverse=True)
            for count, term in own[: 4 if column == "device" else 0]:
                yield Number(f"{name}: {term} selected [%]", column, "", 100 * count / refits)
