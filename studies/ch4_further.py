"""Chapter 4, 4.4 and 6.2.2 beyond their figures, on two real runners: bands, sparse terms, a search, a smooth curve.

    python studies/ch4_further.py [FOLDER] [--tables band terms search curve] [--keep] [--quick]
    python studies/ch4_further.py --print TABLE

welk007 runs a minute without and a minute with a spring between the feet, welk002 without; ten angles, the last 12.5 %
of each run held out. `band`: what 90 % bands from refits on blocks cover. `terms`: which terms of a sparse Discrepancy
are selected in refits on random halves of 16 blocks, beside a control: the first half of the run without the device
against its second. `search`: layers, nodes and activations by successive halving. `curve`: the Discrepancy over the
stride by Gaussian processes on the circle, random Fourier features and plain means, with the processes' own bands.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

TABLES = ("band", "terms", "search", "curve")
GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", "a file for each table that was computed", Path("ch4_further")),
    argument("--tables", "which of them are computed", list(TABLES)),
    argument("--keep", "write studies/ch4_further.csv as well", False),
    argument("--print", "compute nothing; print this table", "", metavar="TABLE"),
    QUICK,
)  # before the slow imports

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from itertools import pairwise

import numpy as np
import torch
from ch5_gait import DATA, RUNS, exotendon
from further import Made, Number, main
from numpy.typing import NDArray
from real_people import ANGLES
from torch import nn

import gaitdisc as gd
from gaitdisc.chapters.regression.gaussian_process import fit_gaussian_process
from gaitdisc.chapters.regression.kernels import KernelKind
from gaitdisc.chapters.regression.sindy import fit_sindy
from gaitdisc.ingest.study import Models
from gaitdisc.networks.feedforward import FeedForward
from gaitdisc.networks.trainer import train
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.processing.process import processed
from gaitdisc.regression.fourier_ridge import fit_fourier_ridge
from gaitdisc.response.band import Refit, covered, response_bands
from gaitdisc.response.fit_response import ResponseSettings, held_out_part
from gaitdisc.response.models import ResponseModels, fit_linear, fit_models, fit_network, refitted_network
from gaitdisc.response.samples import gait_samples

SETTINGS = ResponseSettings(ANGLES)
REFITS, BLOCKS, SIDES = 50, 16, 1.645
OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")
Parts = tuple[gd.Samples, gd.Samples]
Values = NDArray[np.float64]


@cache
def run(who: str, condition: str) -> Parts:
    """Training part and held-out part of a run, all ten accelerations to be predicted."""
    found = {"natural": "manual_ik.mot" if who == "welk002" else RUNS[who]["natural"]}
    name = found.get(condition) or RUNS[who][condition]
    study = exotendon(DATA).model_copy(update={"models": Models(angles=ANGLES, emg=(), outputs=ANGLES)})
    trial = gd.read(next((DATA / "exotendon_run").rglob(name)))
    before, held = held_out_part(processed(trial, study).trajectory, SETTINGS)
    return gait_samples(before, ANGLES)[0], gait_samples(held, ANGLES)[0]


def band(quick: bool) -> Iterator[Number]:
    """Bands by what is fitted again on the blocks: all of a network, its last layer, a ridge regression."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    ridge = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part))
    kinds: dict[str, tuple[ResponseModels, Refit]] = {"ridge": (ridge, lambda _, part: fit_linear(part).model)}
    if not quick:
        network = fit_models(nominal, exo, fit=lambda part, told: fit_network(part, TrainingSettings(), told))
        kinds["network, last layer"] = (network, refitted_network)
        kinds["network, whole"] = (network, lambda _, part: fit_network(part, TrainingSettings()).model)
    for kind, (models, refit) in kinds.items():
        for model, found in response_bands(models, refit, nominal, exo, held).items():
            inside, width = covered(held.y, found), np.mean(found[1] - found[0], axis=0) / held.y.std(axis=0)
            for which, share, wide in zip(ANGLES, inside, width, strict=True):
                yield Number(f"{model.capitalize()}, {kind} refitted", "covered [%]", which, 100 * float(share))
                yield Number(f"{model.capitalize()}, {kind} refitted", "width [SD of measured]", which, float(wide))


def discrepancy(nominal: gd.Samples, other: gd.Samples) -> gd.Samples:
    """What a Nominal ridge model misses of another walk, over the right leg and the place in the stride."""
    missed = other.y - fit_linear(nominal).model(other.x)
    names = (*OUTPUTS, *(f"d({name})/dt" for name in OUTPUTS))
    inputs = other.x[:, [other.inputs.index(name) for name in names]]
    turn = 2 * np.pi * other.phi[:, None] / 100
    state, harmonics = inputs / inputs.std(axis=0), [np.cos(turn), np.sin(turn), np.cos(2 * turn), np.sin(2 * turn)]
    x = np.hstack([state, *harmonics, state * harmonics[0], state * harmonics[1]])
    plain = ("hip", "knee", "ankle", "hip rate", "knee rate", "ankle rate")
    words = (*plain, "cos", "sin", "cos2", "sin2", *(f"{n} x {turned}" for turned in ("cos", "sin") for n in plain))
    columns = [ANGLES.index(name) for name in OUTPUTS]
    return gd.Samples(x, missed[:, columns], words, OUTPUTS, other.time, other.phi)


def terms(quick: bool) -> Iterator[Number]:
    """How often each term is selected, for the device and for nothing."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    half = len(nominal) // 2
    first, second = nominal.rows(slice(0, half)), nominal.rows(slice(half, None))
    for column, before, after, later in (
        ("device", nominal, exo, held),
        ("control", first, second, run("welk007", "natural")[1]),
    ):
        samples, judged = discrepancy(before, after), discrepancy(before, later)
        rng = np.random.default_rng(0)
        counts: dict[tuple[str, str], list[float]] = {}
        blocks = np.array_split(np.arange(len(samples)), BLOCKS)
        for _ in range(5 if quick else REFITS):
            some = np.sort(rng.permutation(BLOCKS)[: BLOCKS // 2])
            model = fit_sindy(samples.rows(np.concatenate([blocks[k] for k in some])), 1)
            for name in OUTPUTS:
                for term, value in model.terms(name).items():
                    counts.setdefault((name, term), []).append(value)
        whole = fit_sindy(samples, 1)
        error = 1 - np.mean((whole(judged.x) - judged.y) ** 2, axis=0) / np.mean(judged.y**2, axis=0)
        for name, held_r2 in zip(OUTPUTS, error, strict=True):
            often = [v for (which, _), v in counts.items() if which == name]
            share = np.array([len(v) for v in often]) / (5 if quick else REFITS)
            size = float(np.sqrt(np.mean(judged.y[:, OUTPUTS.index(name)] ** 2)))
            yield Number(f"{name}: size of the discrepancy [deg/s2]", column, "", size)
            yield Number(f"{name}: terms of the fit to all", column, "", float(len(whole.terms(name))))
            yield Number(f"{name}: share of it explained, held out [1]", column, "", float(held_r2))
            yield Number(f"{name}: terms selected in 9 of 10 refits", column, "", float((share >= 0.9).sum()))
            yield Number(f"{name}: terms selected at least once", column, "", float(len(share)))
            if column == "device":
                own = sorted(((len(v), t) for (which, t), v in counts.items() if which == name), reverse=True)
                for count, term in own[:4]:
                    yield Number(f"{name}: {term} selected [%]", column, "", 100 * count / (5 if quick else REFITS))


class Layers(nn.Module):
    """Hidden layers of one activation and a linear readout."""

    def __init__(self, inputs: int, outputs: int, layers: int, nodes: int, activation: type[nn.Module]) -> None:
        super().__init__()
        sizes = [inputs, *[nodes] * layers]
        pairs = [(nn.Linear(a, b), activation()) for a, b in pairwise(sizes)]
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
        gains = np.array([1 - np.sum(missed["winner"][strides == k] ** 2 / held.y.var(axis=0))
                          / np.sum(missed["text, 64 nodes"][strides == k] ** 2 / held.y.var(axis=0))
                          for k in np.unique(strides)[1:-1]])  # fmt: skip
        drawn = np.random.default_rng(0).choice(gains, (2000, len(gains))).mean(axis=1)
        for word, value in zip(
            ("low", "mean", "high"),
            (*np.quantile(drawn, [0.025]), gains.mean(), *np.quantile(drawn, [0.975])),
            strict=True,
        ):
            yield Number(f"error taken off by the winner, 95 % {word} [%]", column, "", 100 * float(value))
        yield Number(f"winner: {left[0]}", column, "", 1.0)


def curve(quick: bool) -> Iterator[Number]:
    """The mean Discrepancy over the stride: error and band of each way to draw it, on the held-out strides."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    model = fit_linear(nominal).model

    def circle(samples: gd.Samples) -> gd.Samples:
        turn = 2 * np.pi * samples.phi / 100
        x = np.column_stack([np.cos(turn), np.sin(turn)])
        return gd.Samples(x, samples.y - model(samples.x), ("cos", "sin"), samples.outputs, samples.time, samples.phi)

    fitted, judged = circle(exo), circle(held)
    line = tuple(replace(each, x=each.phi[:, None], inputs=("phi",)) for each in (fitted, judged))
    bins = [np.minimum(each.phi.astype(int) // 2, 49) for each in (fitted, judged)]
    means = np.array([judged.y[bins[1] == k].mean(axis=0) for k in range(50)])[bins[1]]  # the held-out strides' own

    def said(row: str, told: Values, sd: Values | None = None, noise: Values | None = None) -> Iterator[Number]:
        for which, column in enumerate(ANGLES):
            of_mean = np.sqrt(np.mean((told - means)[:, which] ** 2)) / judged.y[:, which].std()
            yield Number(row, "error of the held-out mean curve [SD]", column, float(of_mean))
            if sd is not None and noise is not None:
                inside = np.abs(told - means)[:, which] <= SIDES * sd[:, which]
                yield Number(row, "held-out mean curve inside the band [%]", column, 100 * float(inside.mean()))
                inside = np.abs(told - judged.y)[:, which] <= SIDES * np.hypot(sd, noise)[:, which]
                yield Number(row, "held-out samples inside, noise added [%]", column, 100 * float(inside.mean()))

    plain = np.array([fitted.y[bins[0] == k].mean(axis=0) for k in range(50)])[bins[1]]
    yield from said("means of 2 %", plain)
    features = fit_fourier_ridge(*fitted.last_block(0.15, 0.3), features=200, seed=0)
    yield from said("200 random Fourier features, circle", features(judged.x))
    processes: dict[str, tuple[KernelKind, tuple[gd.Samples, ...]]]
    processes = {"squared exponential, line": ("squared_exponential", line)}
    if not quick:
        processes["squared exponential, circle (periodic)"] = ("squared_exponential", (fitted, judged))
        processes["Matern 5/2, circle (periodic)"] = ("matern_5_2", (fitted, judged))
    for row, (kind, (training, later)) in processes.items():
        found = fit_gaussian_process(training.rows(slice(None, None, 4)), kind=kind, variance=True)
        yield from said(f"Gaussian process, {row}", found(later.x), found.sd(later.x), found.noise)


MADE = {
    "band": Made(band, "running, n = 10 outputs of one person, last 12.5 % held out"),
    "terms": Made(terms, "welk007, running, last 12.5 % held out"),
    "search": Made(search, "runs, ten outputs, last 12.5 % held out"),
    "curve": Made(curve, "Discrepancy of welk007, n = 10 outputs, last 12.5 % held out"),
}

if __name__ == "__main__":
    main(GIVEN, MADE, Path(__file__).with_suffix(".csv"))
