"""Chapter 5: every sensor set and model beside Table 5.2."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from gaitdisc.report.reconstruction_page import NOT_MSE
from gaitdisc.report.table import Table
from gaitdisc.results.reconstruction import mean_over_people
from gaitdisc.words import number

MEASURES = ("rmse_deg", "relative_l2", "relative_l2_whole", "r2", "coverage", "seconds")
LESS_THAN_NOTHING = (
    "A relative L2 above 1 is worse than estimating zero; the table prints such values for linear and SDN, so its norm "
    "may be of something else than angles about zero. It has no model that sees history without being a network, and "
    "does not say how time was split or how long the history was: no claim of better or worse is made."
)


def sensor_sets_table(summary: pd.DataFrame, printed: pd.DataFrame, name: str, rule: str) -> Table:
    """One row a data set, sensor set and model.

    summary: `summary` of reconstructions, with columns `data` and `sensors`
    printed: sensors, model, mean, sd: of the dissertation
    """
    numbers = pd.DataFrame(
        [
            {"data": data, "sensors": sensors, "model": model, "n": len(own), **_over(own)}
            for (data, sensors, model), own in summary.groupby(["data", "sensors", "model"], sort=False)
        ]
    ).merge(printed, "left", ["sensors", "model"])
    rows: Any = numbers.itertuples()
    cells = tuple(
        (str(row.data), str(row.sensors), str(row.model), str(row.n), *_measures(row), f"{row.seconds:.2f}")
        for row in rows
    )
    columns = (
        "data", "sensors", "model", "n", "RMSE [deg]", "relative L2 [1]", "R² [1]", "relative L2 with sensors ± sd [1]",
        "printed “MSE” ± sd", "fit [s]",
    )  # fmt: skip
    caption = (
        f"Mean over participants [95 % interval of the mean, from three participants], angles that no sensor measures; "
        f"R²: median of the angles. Split: {rule}. {NOT_MSE} {LESS_THAN_NOTHING}"
    )
    return Table(name, caption, columns, cells, numbers)


def _over(own: pd.DataFrame) -> dict[str, float]:
    found: dict[str, float] = {}
    for measure in MEASURES:
        mean, sd, half = mean_over_people(own[measure].to_numpy(float))
        found |= {measure: mean, f"{measure}_sd": sd, f"{measure}_low": mean - half, f"{measure}_high": mean + half}
    return found


def _measures(row: Any) -> tuple[str, ...]:
    return (
        _spread(row.rmse_deg, row.rmse_deg_low, row.rmse_deg_high, 2),
        number(row.relative_l2, 3),
        number(row.r2, 3),
        _with_sd(row.relative_l2_whole, row.relative_l2_whole_sd),
        _with_sd(row.mean, row.sd),
    )


def _spread(mean: float, low: float, high: float, digits: int) -> str:
    return number(mean, digits) + (f" [{number(low, digits)}, {number(high, digits)}]" if np.isfinite(low) else "")


def _with_sd(mean: float, sd: float) -> str:
    if not np.isfinite(mean):
        return "–"
    return number(mean, 3) + (f" ± {number(sd, 3)}" if np.isfinite(sd) else "")
