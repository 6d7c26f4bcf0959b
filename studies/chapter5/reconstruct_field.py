"""Reconstruct a whole field from sensors on a route: every kind of model beside its floor and its ceiling."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Field, Samples
from gaitdisc.sensing.reconstructor import KINDS, Sensing, fit_reconstructor
from gaitdisc.sensing.splits import Parts, split_within

from .field_cell import FieldCell, error_counts
from .field_task import FieldTask, Label
from .field_windows import field_windows, reading_names, snapshots_of, with_coefficients
from .modes import Modes, fit_modes
from .routes import Route, fixed
from .season import Season, season_of

SPLIT_SEED = 0  # windows drawn at random are the same ones in every run and for every route
MEAN, SEASON, CEILING = "mean (no sensor)", "season (no sensor)", "POD ceiling"


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
    parts = _parts(targets.read, route, task)
    names = reading_names(field, route, task.positions)
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
    for model, found in (_floors(ready, task) if floors else {}).items():
        cells += field_cells(field, ready, task.label(route.name, model), found)
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
        cells.append(
            FieldCell(
                field=label.field,
                quantity=quantity,
                unit=field.units[k],
                route=label.route,
                split=label.split,
                model=label.model,
                relative_l2=float(np.sqrt(square / np.mean(y**2))),
                rmse=float(np.sqrt(square)),
                bias=bias,
                sd=float(np.sqrt(max(square - bias**2, 0.0))),
                r2=1 - square / about,
                fitted=len(ready.training),
                tested=len(rows),
                seconds=seconds,
                run=label.run,
                errors=error_counts(error, float(np.std(y))),
            )
        )
    return cells


def _floors(ready: Prepared, task: FieldTask) -> dict[str, NDArray[np.float32]]:
    rows, targets = snapshots_of(ready.test), ready.targets
    found = {MEAN: np.broadcast_to(targets.mean, (len(rows), *targets.mean.shape))}
    if task.season:
        found[SEASON] = targets.season.at(rows)
    found[CEILING] = targets.fields(ready.test.y, ready.test)
    return found
