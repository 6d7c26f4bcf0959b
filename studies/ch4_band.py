"""Bands of chapter 4 by refits on blocks, and the mean Discrepancy over the stride with bands of its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from ch4_runs import run
from chapter3.gaussian_process import KernelKind, fit_gaussian_process
from further import Number
from numpy.typing import NDArray
from real_people import ANGLES

import gaitdisc as gd
from gaitdisc.batch.demonstration import MUSCLES, OUTPUTS
from gaitdisc.batch.participant_unit import response_settings
from gaitdisc.cohort.cohort import walks_of
from gaitdisc.cohort.person import drawn
from gaitdisc.ingest.study import Conditions, Models, Participant, Study
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.processing.process import processed
from gaitdisc.regression.fourier_ridge import fit_fourier_ridge
from gaitdisc.response.band import Refit, covered, response_bands
from gaitdisc.response.fit_response import fit_response
from gaitdisc.response.models import ResponseModels, fit_linear, fit_models, fit_network, refitted_network

FRESH = range(70_000, 70_040)  # seeds; those from 50,000 on were developed on
SIDES = 1.645  # standard deviations of a normal law's 90 %
Values = NDArray[np.float64]


def band(quick: bool) -> Iterator[Number]:
    """Bands by what is fitted again on the blocks: all of a network, its last layer, a ridge regression."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    ridge = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part))
    kinds: dict[str, tuple[ResponseModels, Refit]] = {"ridge": (ridge, lambda _, part: fit_linear(part).model)}
    if not quick:
        network = fit_models(nominal, exo, fit=lambda part, progress: fit_network(part, TrainingSettings(), progress))
        kinds["network, last layer"] = (network, refitted_network)
        kinds["network, whole"] = (network, lambda _, part: fit_network(part, TrainingSettings()).model)
    for kind, (models, refit) in kinds.items():
        for model, found in response_bands(models, refit, nominal, exo, held).items():
            inside, width = covered(held.y, found), np.mean(found[1] - found[0], axis=0) / held.y.std(axis=0)
            for which, share, wide in zip(ANGLES, inside, width, strict=True):
                yield Number(f"{model.capitalize()}, {kind} refitted", "covered [%]", which, 100 * float(share))
                yield Number(f"{model.capitalize()}, {kind} refitted", "width [SD of measured]", which, float(wide))


def people(quick: bool) -> Iterator[Number]:
    """Share of the held-out samples inside the bands of `gaitdisc run`; people on whom nothing was set."""
    emg = tuple(f"emg_{muscle}_{side}" for side in "rl" for muscle in MUSCLES)
    both = Conditions(nominal="nominal", device="exo")
    for seed in FRESH[: 2 if quick else None]:
        person = drawn(f"P{seed}", seed, "fm"[seed % 2])
        study = Study(
            conditions=both, models=Models(emg=emg, outputs=OUTPUTS), participants=(Participant(id=person.name),)
        )
        walks = walks_of(person, 20.0 if quick else 60.0).trials
        nominal, exo = (processed(walks[word], study).trajectory for word in both.both)
        held = fit_response(nominal, exo, response_settings(study), banded=True).held_out
        for model, found in held.bands.items():
            inside = 100 * float(covered(held.measured, found).mean())
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
