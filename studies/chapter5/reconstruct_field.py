"""Reconstruct a whole field from sensors on a route: every kind of model beside its floor and its ceiling."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.reconstruction.window_model import KINDS, Sensing, fit_reconstructor
from gaitdisc.reconstruction.windows import Lags, Parts, split_within, stacked
from gaitdisc.recording import Samples
from gaitdisc.recording.field import Field
from gaitdisc.saved.unit_folder import DamagedError, read_sealed, seal_text
from gaitdisc.whole_file import write_whole

from .modes import ENERGY, Modes, Season, fit_modes, season_of
from .routes import Route, fixed

BINS = 121
REACH_SD = 4.0  # of the field's own standard deviation: how far the bins of errors reach
SPLIT_SEED = 0  # windows drawn at random are the same ones in every run and for every route
MEAN, SEASON, CEILING = "mean (no sensor)", "season (no sensor)", "POD ceiling"
SIZES = (1, 2, 3, 5, 8, 12, 20, 32, 64)
COLUMNS = ("nodes", "split", "quantity", "relative_l2", "r2", "energy_left")
OWN, OTHER = "the fitted path", "another path, never fitted"
ALONE, MANY, MANY_PLACED = "fitted on one path", "fitted on {} paths", "fitted on {} paths, places given"


class Label(NamedTuple):
    """Which cell it is."""

    field: str
    route: str
    split: str
    model: str
    run: int


@dataclass(frozen=True)
class FieldTask:
    """What is the same for every route and model of a study."""

    name: str
    lags: Lags  # readings of a window, snapshots from one to the next, and how far ahead the field is forecast
    rule: str = "temporal"
    energy: float = ENERGY  # share of the training snapshots' energy that the modes keep
    season: int = 0  # snapshots of a year, whose mean course is a floor of its own; 0 where there is none
    positions: bool = False  # whether each sensor gives its place
    # whether sensors read, and models reconstruct, departures from the training part's mean at the place and time of
    # year: what a reading means then depends less on where the sensor is. The season is added afterwards
    departures: bool = False
    seed: int = 0

    def label(self, route: str, model: str) -> Label:
        """Return which cell a route and a model are."""
        return Label(self.name, route, self.rule, model, self.seed)

    def named(self, kind: str) -> str:
        """Return what a kind of model is called in this task."""
        return f"{kind}, departures" if self.departures else kind


@dataclass(frozen=True, eq=False)
class ErrorCounts:
    """How often an error of each size was made, over all points and test snapshots."""

    edges: NDArray[np.float64]  # (bin + 1,) [unit], of the bins; the outer two bins take what lies beyond
    counts: NDArray[np.int_]  # (bin,), values in each


@dataclass(frozen=True, eq=False)
class FieldCell:
    """How well one model reconstructs one quantity of a field."""

    field: str
    quantity: str
    unit: str
    route: str
    split: str
    model: str
    # norm of the error over the norm of the field about zero, of all test values at once (Eq. 2.21); 1 for a model
    # that says 0
    relative_l2: float
    rmse: float  # [unit], root mean square of reconstructed minus measured; its mean and standard deviation:
    bias: float
    sd: float
    # 1 - mean squared error over the mean squared distance from the training part's mean field; 0 for a model that says
    # that mean
    r2: float
    fitted: int
    tested: int
    seconds: float  # [s], processor time of the fit
    run: int  # number of the run, where one cell was computed several times with other seeds
    errors: ErrorCounts


def field_cells_table(cells: Sequence[FieldCell]) -> pd.DataFrame:
    """Numbers of all cells, one row each, without the counts of errors."""
    columns = pd.Index([name for name in FieldCell.__dataclass_fields__ if name != "errors"])
    return pd.DataFrame([vars(cell) for cell in cells], columns=columns)


def error_counts(errors: NDArray[np.floating], sd: float) -> ErrorCounts:
    """Count errors by size."""
    edges = np.linspace(-REACH_SD * sd, REACH_SD * sd, BINS + 1)
    place = np.clip(np.searchsorted(edges, errors.ravel(), side="right") - 1, 0, BINS - 1)
    return ErrorCounts(edges, np.bincount(place, minlength=BINS))


def save_cells(cells: Sequence[FieldCell], made_by: Mapping[str, Any], path: Path) -> None:
    """Keep cells, so that a study that was stopped goes on."""
    rows = [{**vars(cell), "errors": {k: v.tolist() for k, v in vars(cell.errors).items()}} for cell in cells]
    write_whole(path, seal_text({"made_by": dict(made_by), "cells": rows}))


def load_cells(made_by: Mapping[str, Any], path: Path) -> list[FieldCell] | None:
    """Cells that were kept, or None where there are none, other settings made them, or they were changed since."""
    try:
        held = read_sealed(path)
    except DamagedError:
        return None
    if held["made_by"] != json.loads(json.dumps(dict(made_by))):
        return None
    rows = [{"tested" if name == "judged" else name: value for name, value in row.items()} for row in held["cells"]]
    return [FieldCell(**{**row, "errors": ErrorCounts(*map(np.array, row["errors"].values()))}) for row in rows]


def reading_names(field: Field, route: Route, positions: bool = False) -> tuple[str, ...]:
    """Names of what one window holds for each of its times."""
    given = (*field.quantities, *(axis.name for axis in field.axes if positions))
    return tuple(f"{name} of sensor {k + 1}" for k in range(route.sensors) for name in given)


def field_windows(field: Field, route: Route, lags: Lags, positions: bool = False) -> Samples:
    """Every window along a field's whole time, still without outputs: those are modes of the part that is fitted."""
    if len(field) <= lags.reach + lags.ahead:
        forth = f" and {lags.ahead} ahead" if lags.ahead else ""
        raise SamplingError(
            f"a window reaches back {lags.reach} snapshots{forth}",
            f"{field.source.file or 'the field'} has {len(field)}",
            "Take fewer lags, or a longer field.",
        )
    readings = np.concatenate([route.readings(field), *([route.places(field)] if positions else [])], axis=2)
    readings = readings.reshape(len(field), -1)
    last = np.arange(lags.reach, len(field) - lags.ahead)
    rows = last[:, None] + (np.arange(lags.count) - lags.count + 1) * lags.spacing
    names = reading_names(field, route, positions)
    inputs = tuple(
        name if ago == 0 else f"{name} {ago * lags.spacing} {field.time_unit} ago"
        for ago in range(lags.count - 1, -1, -1)
        for name in names
    )
    x, none = readings[rows].reshape(len(last), -1), np.zeros((len(last), 0))
    return Samples(x, none, inputs, (), (last + lags.ahead).astype(float), np.zeros(len(last)))


def snapshots_of(windows: Samples) -> NDArray[np.intp]:
    """Number of the snapshot that each window reconstructs, (window,)."""
    return np.rint(windows.time).astype(int)


def with_coefficients(windows: Samples, coefficients: NDArray[np.float64], names: Sequence[str]) -> Samples:
    """Windows with the modes' coefficients of their snapshots as outputs."""
    return replace(windows, y=coefficients[snapshots_of(windows)], outputs=tuple(names))


@dataclass(frozen=True, eq=False)
class Targets:
    """What is reconstructed of a field, the same for every route of a task."""

    read: Field  # what sensors read: the field itself, or its departures
    modes: Modes
    coefficients: NDArray[np.float64]  # (snapshot, mode), of all snapshots
    mean: NDArray[np.float32]  # (point, quantity) [each quantity's unit], of the training part's snapshots
    season: Season
    departures: bool  # whether modes and readings are of departures from the season

    def fields(self, coefficients: NDArray[np.float64], windows: Samples) -> NDArray[np.float32]:
        """Field at each window, (window, point, quantity) [each quantity's unit]."""
        found = self.modes.fields(coefficients)
        return found + self.season.at(snapshots_of(windows)) if self.departures else found


@dataclass(frozen=True, eq=False)
class Prepared:
    """Windows of the three parts and the modes that they reconstruct."""

    training: Samples
    check: Samples
    test: Samples
    targets: Targets
    what: Sensing

    def reconstructed(self, model: Callable[[Samples], NDArray[np.float64]]) -> NDArray[np.float32]:
        """Field at each window of the test part, (window, point, quantity) [each quantity's unit]."""
        return self.targets.fields(model(self.test), self.test)


def targets_of(field: Field, task: FieldTask) -> Targets:
    """Fit the modes to the part that models are fitted to, which depends on times alone and not on a route."""
    parts = _parts(field, fixed(field, [0]), task)
    fitted = snapshots_of(parts.fitted())
    season = season_of(field, fitted, task.season)
    read = season.departures(field) if task.departures else field
    modes = fit_modes(read.values[fitted], task.energy)
    mean = season_of(field, fitted, 0).course[0]
    return Targets(read, modes, modes.coefficients(read.values), mean, season, task.departures)


def prepare(field: Field, route: Route, task: FieldTask, targets: Targets | None = None) -> Prepared:
    """Cut windows, part them, and set what they are to reconstruct beside them."""
    targets = targets or targets_of(field, task)
    parts, names = _parts(targets.read, route, task), reading_names(field, route, task.positions)
    windows = parts.fitted(), parts.checked(), parts.tested()
    training, check, test = (with_coefficients(each, targets.coefficients, targets.modes.names) for each in windows)
    return Prepared(training, check, test, targets, Sensing(names, targets.modes.names, task.lags, 1.0))


def _parts(field: Field, route: Route, task: FieldTask) -> Parts:
    windows = field_windows(field, route, task.lags, task.positions)
    return split_within([windows], task.rule, task.lags.reach + task.lags.ahead, SPLIT_SEED)


def reconstruct_field(
    field: Field,
    route: Route,
    task: FieldTask,
    kinds: Sequence[str] = tuple(KINDS),
    floors: bool = True,
    targets: Targets | None = None,
) -> list[FieldCell]:
    """Fit every kind of model and test it on the test part, in the field's own unit at every point."""
    ready = prepare(field, route, task, targets)
    cells = []
    if floors:
        rows, there = snapshots_of(ready.test), ready.targets
        found = {MEAN: np.broadcast_to(there.mean, (len(rows), *there.mean.shape))}
        found |= {SEASON: there.season.at(rows)} if task.season else {}
        found[CEILING] = there.fields(ready.test.y, ready.test)
        for model, values in found.items():
            cells += field_cells(field, ready, task.label(route.name, model), values)
    for kind in kinds:
        done = fit_reconstructor(kind, ready.what, ready.training, ready.check, task.seed)
        label = task.label(route.name, task.named(kind))
        cells += field_cells(field, ready, label, ready.reconstructed(done), done.seconds)
    return cells


def field_cells(
    field: Field, ready: Prepared, label: Label, reconstructed: NDArray[np.float32], seconds: float = 0.0
) -> list[FieldCell]:
    """Compare what was reconstructed with the test part, a cell for each quantity."""
    rows, cells = snapshots_of(ready.test), []
    for k, quantity in enumerate(field.quantities):
        y = field.values[rows, :, k].astype(float)
        error = reconstructed[:, :, k] - y
        square, bias = float(np.mean(error**2)), float(np.mean(error))
        about = float(np.mean((y - ready.targets.mean[:, k]) ** 2))
        head: dict[str, Any] = label._asdict() | {"quantity": quantity, "unit": field.units[k], "seconds": seconds}
        head |= {"fitted": len(ready.training), "tested": len(rows)}
        sizes: dict[str, Any] = {
            "relative_l2": float(np.sqrt(square / np.mean(y**2))),
            "rmse": float(np.sqrt(square)),
            "bias": bias,
        }
        sizes |= {"sd": float(np.sqrt(max(square - bias**2, 0.0))), "r2": 1 - square / about}
        cells.append(FieldCell(**head, **sizes, errors=error_counts(error, float(np.std(y)))))
    return cells


def latent_sizes(
    field: Field, route: Route, task: FieldTask, sizes: Sequence[int] = SIZES, epochs: int = 20
) -> pd.DataFrame:
    """Error of SHRED with recurrent layers of several sizes, beside what as many singular values leave.

    Source: Ebers 2023, section 5.2 and Fig. 5.1: both elbows are seen near 5, and a relation is conjectured.
    """
    from gaitdisc.models.networks import Shred
    from gaitdisc.models.trainer import train
    from gaitdisc.models.training_settings import TrainingSettings

    ready = prepare(field, route, task)
    settings = TrainingSettings(epochs=epochs, batch=128, decays=(0.01,), seed=task.seed)
    rows = []
    for nodes in sizes:
        build = partial(Shred, sensors=len(ready.what.sensors), nodes=nodes)
        model = train(ready.training, build, settings, check=ready.check).network
        left, label = float(1 - np.sum(ready.targets.modes.energies[:nodes])), task.label(route.name, f"shred {nodes}")
        for cell in field_cells(field, ready, label, ready.reconstructed(lambda test, model=model: model(test.x))):
            rows.append((nodes, task.rule, cell.quantity, cell.relative_l2, cell.r2, left))
    return pd.DataFrame(rows, columns=pd.Index(list(COLUMNS)))


def unseen_path(
    field: Field, routes: Sequence[Route], unseen: Route, task: FieldTask, kinds: Sequence[str]
) -> list[FieldCell]:
    """Error on a path never fitted, beside that on the fitted one.

    For a model fitted on one path, on many, and on many with each sensor's place beside its reading. The test times are
    those of the split, and were not fitted on any path.
    """
    if len(routes) < 2 or {route.sensors for route in routes} != {unseen.sensors}:
        counts = ", ".join(str(route.sensors) for route in routes) or "none"
        raise ChannelError(
            f"a path never seen needs two other paths or more, each with {unseen.sensors} sensors",
            f"found {len(routes)} paths, with {counts} sensors",
            "Give more paths, alike in their sensors.",
        )
    cells, targets, many = [], targets_of(field, task), len(routes)
    for fitted, placed in ((ALONE, False), (MANY.format(many), False), (MANY_PLACED.format(many), True)):
        placed_task = replace(task, positions=placed)
        ready = [prepare(field, route, placed_task, targets) for route in (routes[:1] if fitted == ALONE else routes)]
        training, check = stacked([each.training for each in ready]), stacked([each.check for each in ready])
        tested = {OTHER: replace(prepare(field, unseen, placed_task, targets), training=training)}
        if fitted == ALONE:
            tested = {OWN: ready[0]} | tested
        for kind in kinds:
            done = fit_reconstructor(kind, ready[0].what, training, check, task.seed)
            for where, each in tested.items():
                label = task.label(f"{where}; {fitted}", task.named(kind))
                cells += field_cells(field, each, label, each.reconstructed(done), done.seconds)
    return cells
