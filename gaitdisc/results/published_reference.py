"""A published reference as a table: mean and standard deviation of curves, by groups of speed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.errors import SchemaError
from gaitdisc.recording import PERCENT
from gaitdisc.results.clinical_reading import Band
from gaitdisc.results.clinical_variables import BY_NAME
from gaitdisc.spreadsheet import read_csv

COLUMNS = ("group", "speed_low", "speed_high", "people", "variable", "percent", "mean", "sd")
FEWEST_POINTS = 20  # a curve of fewer is none
FORM = f"a published reference is a CSV with {', '.join(COLUMNS)}, after a line '# source, who, licence'"


@dataclass(frozen=True, eq=False)
class PublishedGroup:
    """People of one group."""

    name: str
    speeds: tuple[float, float]  # tuple of (float, float), dimensionless, from and to; NaN where the table has none
    people: int
    bands: dict[str, Band]


def read_published(path: Path) -> tuple[str, tuple[PublishedGroup, ...]]:
    """Source of a published reference, as its first line has it, and its groups."""
    try:
        first = path.open(encoding="utf-8").readline()
        table = read_csv(path, ("group", "variable"), skiprows=1) if first.startswith("#") else pd.DataFrame()
    except (OSError, ValueError) as error:
        raise SchemaError(FORM, f"{path.name}: {str(error)[:200]}", "Correct the table.") from error
    source, lacking = first.lstrip("# ").strip(), [name for name in COLUMNS if name not in table]
    if lacking or not source:
        found = "no source" if not source or not first.startswith("#") else f"no column {', '.join(lacking)}"
        raise SchemaError(FORM, f"{path.name} has {found}", "Write it as docs/clinic.md shows.")
    groups = [_group(str(name), own, path.name) for name, own in table.groupby("group", sort=False)]
    return source, tuple(groups)


def _group(name: str, rows: pd.DataFrame, file: str) -> PublishedGroup:
    bands, first = {}, rows.iloc[0]
    for variable, own in rows.groupby("variable", sort=False):
        where = f"{file}, {name} {variable}"
        if variable not in BY_NAME:
            raise SchemaError(f"{where}: a variable is one of {', '.join(BY_NAME)}", "it is none", "Correct the name.")
        curve = own.sort_values("percent")[["percent", "mean", "sd"]].to_numpy(float)
        at, mean, sd = curve.T
        whole = len(at) >= FEWEST_POINTS and np.isfinite(curve).all() and (np.diff(at) > 0).all() and (sd >= 0).all()
        if not (whole and at[0] <= PERCENT[0] + 2.5 and at[-1] >= PERCENT[-1] - 2.5):
            raise SchemaError(
                f"{where}: a curve needs {FEWEST_POINTS} points or more from 0 to 100 % once each, with mean and sd",
                f"found {len(at)} from {at.min():g} to {at.max():g} %",
                "Correct the table.",
            )
        bands[str(variable)] = Band(
            np.interp(PERCENT, at, mean), np.interp(PERCENT, at, sd), int(own["people"].iloc[0])
        )
    people = max(band.people for band in bands.values())
    return PublishedGroup(name, (float(first["speed_low"]), float(first["speed_high"])), people, bands)
