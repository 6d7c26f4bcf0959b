"""Which method for which record: the guidelines of section 3.5, answered from measured cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd

from gaitdisc.errors import SchemaError

from .cell import FORECAST, ORACLE, DiscrepancyCell, cells_table
from .dmd import DELAYS, RANK
from .methods import OF_TIME

Want = Literal["interpretability", "speed", "forecast"]
WANTS: tuple[Want, ...] = ("interpretability", "speed", "forecast")
INTERPRETABLE = ("sindy", *OF_TIME)
READER = {"interpretability": "that a person can read ", "speed": "", "forecast": ""}
BEYOND = 2.0  # times as many samples as were measured, or as few: said
NEAR = 5.0  # points of accuracy that the fastest method may lose to the best
FOUND = Path(__file__).with_name("measured_cells.csv")  # what the studies of chapter 3 measured
COLUMNS = (
    "system", "method", "noise", "dt_s", "samples", "start", "accuracy", "least", "greatest", "valid_s", "seconds",
    "diverged", "seeds", "valid_known_s",
)  # fmt: skip
ESTIMATED, TRUE = "estimated", "true state (oracle)"  # what a forecast started from
STARTS = {FORECAST: ESTIMATED, ORACLE: TRUE}


@dataclass(frozen=True, eq=False)
class Recommendation:
    """A method and what speaks for it."""

    method: str  # `sindy`, `dmd`, `bopdmd`, `gp`, `nn`; empty where none did better than the known model
    why: str  # one or two sentences with the numbers
    # the measured cells that it rests on, best first: system, method, noise, samples learned from, start, forecast
    # accuracy with the least and greatest of the seeds [%], valid time [s], seconds. First those that started from the
    # estimated state, then the same from the true state, an oracle
    evidence: pd.DataFrame


def recommend(
    noise: float,
    samples: int,
    want: Want,
    chaotic: bool = False,
    dt_s: float | None = None,
    evidence: pd.DataFrame | None = None,
) -> Recommendation:
    """Recommend a method for learning the missing rates of a known model.

    The measured cells nearest in noise, then in the step between samples, then in samples, decide, by their forecasts
    from a start that was estimated from the noisy measurement; what the same forecasts reach from the true state, which
    nobody has, is said beside it as an oracle. A method counts by the system on which it did worst, and not at all
    where it diverged, or where its forecast is worse than the known model's alone or valid for a shorter time. Where a
    step, or a length, is more than twice or less than half of what was measured at that noise, `why` says so.

    want: `interpretability`: terms or frequencies that a person can read; `speed`: the fastest within 5 points of the
        best; `forecast`: the best forecast
    chaotic: rank by the Lorenz system's valid time, of equal ones by the accuracy, instead of the Van der Pol
        oscillator's accuracy
    dt_s: between samples [s], for systems that turn once in 0.7 (Lorenz) to 6 s (Van der Pol) as the measured ones;
        where absent, the step at which most was measured
    evidence: as `measured_cells` makes it; what the studies of chapter 3 measured where absent

    >>> recommend(0.001, 3000, "interpretability").method
    'sindy'
    """
    if want not in WANTS:
        raise SchemaError("a want is one of " + ", ".join(WANTS), f"found {want!r}", "Choose one of them.")
    table = pd.read_csv(FOUND) if evidence is None else evidence
    missing = [name for name in COLUMNS if name not in table]
    if missing:
        absent = f"{', '.join(missing)} missing"
        raise SchemaError("evidence has the columns of measured_cells", absent, "Make it with measured_cells.")
    table = _nearest(table[table["system"].str.contains("Lorenz") == chaotic], noise, samples, dt_s)
    near, step, length = float(table["noise"].iloc[0]), float(table["dt_s"].iloc[0]), int(table["samples"].iloc[0])
    by = "valid_s" if chaotic else "accuracy"
    order = [by, "accuracy", "method"]
    oracle, table = table[table["start"] == TRUE], table[table["start"] == ESTIMATED]
    lost = table.loc[table["diverged"] > 0, "method"]
    rows = table[~table["method"].isin(lost)].sort_values(order, ascending=False)
    shown = pd.concat([rows, oracle.sort_values(order, ascending=False)], ignore_index=True)
    better = _allowed(rows, want, samples)
    if not len(better):
        why = (
            f"At {near:.1%} noise and {length:,} samples, {step:g} s apart, none of the methods {READER[want]}forecast "
            f"better than the known model from a start estimated from the data: the known model alone is best there, "
            f"valid for {table['valid_known_s'].median():.2f} s."
        )
        return Recommendation("", why, shown)
    best = better.iloc[0]
    if want == "speed":
        close = better[better[by] >= best[by] - (NEAR if by == "accuracy" else NEAR / 100 * best[by])]
        best = close.sort_values("seconds", kind="stable").iloc[0]
    same, also = oracle[(oracle["method"] == best["method"]) & (oracle["system"] == best["system"])], ""
    if len(same):
        accuracy, valid_s = same[["accuracy", "valid_s"]].iloc[0]
        also = f" (from the true state, an oracle: {accuracy:.1f} %, {valid_s:.1f} s)"
    why = (
        f"Measured at {near:.1%} noise and {length:,} samples, {step:g} s apart, on {best['system']}: forecast error "
        f"{best['accuracy']:.1f} % smaller than the known model's ({best['least']:.1f} to {best['greatest']:.1f} %, "
        f"n = {best['seeds']:.0f} seeds), valid for {best['valid_s']:.1f} s, from a start estimated from the data"
        f"{also}; {best['seconds']:.1f} s of processor time."
    )
    if not 1 / BEYOND <= samples / length <= BEYOND:
        why += f" This record has {samples:,} samples: there it was not measured."
    if dt_s is not None and not 1 / BEYOND <= dt_s / step <= BEYOND:
        why += f" This record has a sample every {dt_s:g} s: at this noise nothing was measured there."
    return Recommendation(str(best["method"]), why, shown)


def _nearest(table: pd.DataFrame, noise: float, samples: int, dt_s: float | None) -> pd.DataFrame:
    """Cells nearest in noise, of these nearest in step, and of these nearest in samples, by their ratio."""
    levels = np.sort(table["noise"].unique())
    table = table[table["noise"] == levels[np.argmin(np.abs(np.log(levels + 1e-4) - np.log(noise + 1e-4)))]]
    steps = np.sort(table["dt_s"].unique())
    step = float(table["dt_s"].mode().iloc[0] if dt_s is None else steps[np.argmin(np.abs(np.log(steps / dt_s)))])
    table = table[table["dt_s"] == step]
    lengths = np.sort(table["samples"].unique())
    return table[table["samples"] == lengths[np.argmin(np.abs(np.log(lengths / samples)))]]


def _allowed(rows: pd.DataFrame, want: Want, samples: int) -> pd.DataFrame:
    """Methods that give what is wanted and beat the known model, each on the system on which it did worst."""
    worst = rows.groupby("method", sort=False).tail(1)
    allowed = worst[worst["method"].isin(INTERPRETABLE)] if want == "interpretability" else worst
    if samples < DELAYS + 2 * RANK:
        allowed = allowed[~allowed["method"].isin(OF_TIME)]
    return allowed[(allowed["accuracy"] > 0) & (allowed["valid_s"] >= allowed["valid_known_s"])]


def measured_cells(cells: Sequence[DiscrepancyCell]) -> pd.DataFrame:
    """Evidence of a study: forecasts with learned rates, medians over channels, then over seeds with their range."""
    table = cells_table([c for c in cells if (c.approach, c.variant) == ("dynamics", "right") and c.parts])
    table["seconds"] = table["fit_s"] + table["run_s"]
    keys = ["system", "method", "noise", "dt_s", "samples", "part", "seed"]
    seeds = table.groupby(keys, sort=False)[["accuracy", "valid_s", "seconds", "diverged_s", "valid_known_s"]].median()
    return evidence_of(seeds.reset_index())


def evidence_of(seeds: pd.DataFrame) -> pd.DataFrame:
    """Evidence of forecasts: medians over seeds with their range, by start.

    seeds: a row a seed and part: system, method, noise, dt_s, samples, part, accuracy [%], valid_s, seconds,
        diverged_s, valid_known_s (of the known model alone)
    """
    table = seeds[seeds["part"].isin(list(STARTS))].copy()
    table["start"] = table["part"].map(STARTS)
    table["diverged"] = table["diverged_s"].notna()
    found = table.groupby(["system", "method", "noise", "dt_s", "samples", "start"], sort=False).agg(
        accuracy=("accuracy", "median"), least=("accuracy", "min"), greatest=("accuracy", "max"),
        valid_s=("valid_s", "median"), seconds=("seconds", "median"), diverged=("diverged", "mean"),
        seeds=("accuracy", "size"), valid_known_s=("valid_known_s", "median"),
    )  # fmt: skip
    return found.reset_index()[list(COLUMNS)]
