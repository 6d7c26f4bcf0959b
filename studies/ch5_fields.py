"""What the field studies of chapter 5 have in common: their fields and routes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
from chapter5.files import read_navy_winds, read_oisst, read_sst_mat, read_sst_pacific
from chapter5.reconstruct_field import (
    FieldCell,
    FieldTask,
    Targets,
    load_cells,
    prepare,
    reconstruct_field,
    save_cells,
    snapshots_of,
    targets_of,
    unseen_path,
)
from chapter5.routes import Route, fixed_at_random, random_walk
from command_line import SHARED

import gaitdisc as gd
from gaitdisc.reconstruction.window_model import fit_reconstructor
from gaitdisc.reconstruction.windows import Lags

FIELDS = SHARED / "fields"
WALKS = 12  # fitted, before one that never was
ABOUT = "chapter 5, on fields that can be had."


def fields() -> Iterator[tuple[gd.Field, FieldTask, str]]:
    """Every field that is there, its task, and whose circuits it has."""
    noaa = FIELDS / "noaa"
    if (noaa / "sst.wkmean.1990-present.nc").exists():
        sst = read_oisst(noaa / "sst.wkmean.1990-present.nc", noaa / "lsmask.nc")
        yield sst, FieldTask("NOAA weekly temperature", Lags(52, 1), season=52), "globe"
    if (noaa / "SST_data.mat").exists():
        yield read_sst_mat(noaa / "SST_data.mat"), FieldTask("SST_data.mat", Lags(52, 1), season=52), "globe"
    sst = read_sst_pacific(FIELDS / "sst_pacific" / "sst_pacific_monthly_1970_2003.npz")
    yield sst, FieldTask("Pacific temperature anomaly", Lags(12, 1), season=12), "pacific"
    winds = read_navy_winds(FIELDS / "navy_winds" / "monthly_navy_winds.npz")
    yield winds, FieldTask("winds of the globe", Lags(7, 1), season=12), "globe"


def route_cells(
    field: gd.Field, route: Route, task: FieldTask, kinds: Sequence[str], targets: Targets, path: Path
) -> list[FieldCell]:
    """Every kind of model on one route, kept in a file; floor and ceiling with the first seed alone."""
    made_by = {"task": asdict(task), "field": [*vars(field.source).values(), *field.values.shape], "kinds": kinds}
    found = load_cells(made_by, path)
    if found is None:
        found = reconstruct_field(field, route, task, kinds, task.seed == 0, targets)
        save_cells(found, made_by, path)
    return found


def reconstructed_maps(field: gd.Field, route: Route, task: FieldTask, kind: str, rules: Sequence[str]) -> dict:
    """One snapshot of the test part as measured, and as reconstructed, under each split."""
    shown = {}
    for rule in rules:
        ready = prepare(field, route, replace(task, rule=rule))
        fitted = fit_reconstructor(kind, ready.what, ready.training, ready.check, task.seed)
        middle, snapshot = middle_of(ready.test)
        date = np.datetime64(int(field.time[snapshot]), "M") if field.time_unit == "month" else f"week {snapshot + 1}"
        shown[f"measured, {date}"] = field.values[snapshot, :, 0]
        shown[f"reconstructed by {kind}, {rule}"] = ready.targets.fields(fitted(middle), middle)[0, :, 0]
    return shown


def middle_of(test: gd.Samples) -> tuple[gd.Samples, int]:
    """Return the window in the middle of the test part, and the number of its snapshot."""
    middle = test.rows(slice(len(test) // 2, len(test) // 2 + 1))
    return middle, int(snapshots_of(middle)[0])


def on_departures(field: gd.Field, routes: Sequence[Route], task: FieldTask, rules: Sequence[str]) -> list[FieldCell]:
    """Every route again, with readings and field taken as departures from the season: the cheap models."""
    cells = []
    for rule in rules:
        departing = replace(task, rule=rule, departures=True)
        targets = targets_of(field, departing)
        for route in routes:
            cells += reconstruct_field(field, route, departing, ("linear", "delay ridge"), False, targets)
    return cells


def unseen_walks(field: gd.Field, task: FieldTask, kinds: Sequence[str]) -> list[FieldCell]:
    """Random walks from starts all over the field: one that was never fitted, after one and after twelve others."""
    starts = fixed_at_random(field, WALKS + 1, 0).points[0]
    unseen, *walks = [random_walk(field, 100 + k, start=int(start)) for k, start in enumerate(starts)]
    apart = unseen_path(field, walks, unseen, replace(task, departures=True), ("delay ridge",))
    return unseen_path(field, walks, unseen, task, kinds) + apart
