"""The last held-out seconds: measured, Nominal and Augmented accelerations, with the gap shaded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.channel import side_of
from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import MEASURED, MODELS, SIDES
from gaitdisc.report.panels import Room, in_style, legend, panels_for, sheets
from gaitdisc.report.r2 import r2_by_variable
from gaitdisc.report.wording import MODEL_WORDS, counted, label, number, unit_text, upwards
from gaitdisc.results import ParticipantResponse

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WINDOW_S = 4.0
_DRAWN = ("nominal", "augmented")
_BANDED, _BOUNDS = "augmented", ("low", "high")


@in_style
def held_out_figures(response: ParticipantResponse, name: str) -> list[Figure]:
    """Measured against predicted in the last seconds of the held-out device walk, one panel an output."""
    numbers = held_out_numbers(response)
    if not len(numbers):
        return []
    parts = sheets(response.outputs, 12, f"held-out-{name}")
    return [_figure(response, numbers[numbers["variable"].isin(part)], sheet) for sheet, part in parts.items()]


def held_out_numbers(response: ParticipantResponse) -> pd.DataFrame:
    """Measured and predicted second derivatives of the last `WINDOW_S` seconds.

    returns: variable, unit, time_s, percent, measured, nominal, augmented; augmented_low, augmented_high where there
        is a band
    """
    held = response.held_out
    shown = held.time >= (held.time[-1] - WINDOW_S if len(held.time) else 0.0)
    tables = [
        pd.DataFrame(
            {
                "variable": variable,
                "unit": response.units[column],
                "time_s": held.time[shown],
                "percent": held.phi[shown],
                "measured": held.measured[shown, column],
                **{m: held.predicted[m][shown, column] for m in _DRAWN if m in held.predicted},
                **{
                    f"{_BANDED}_{word}": held.bands[_BANDED][bound][shown, column]
                    for bound, word in enumerate(_BOUNDS)
                    if _BANDED in held.bands
                },
            }
        )
        for column, variable in enumerate(response.outputs)
    ]
    return pd.concat(tables, ignore_index=True)


def _figure(response: ParticipantResponse, numbers: pd.DataFrame, name: str) -> Figure:
    groups = list(numbers.groupby("variable", sort=False))
    drawn, cells = panels_for(len(groups), 2, 1.05, Room(left=0.82, across=0.82, top=0.5))
    r2 = r2_by_variable(response)
    for axes, (variable, rows) in zip(cells, groups, strict=True):
        _draw(axes, rows)
        axes.set_title(_title(str(variable), r2), loc="left", color=SIDES[side_of(str(variable))].colour)
        up = upwards(str(variable))
        axes.set_ylabel(f"[{unit_text(str(rows['unit'].iloc[0]))}]" + (f"\n↑ {up}" if up else ""))
        axes.set_xlim(rows["time_s"].iloc[0], rows["time_s"].iloc[-1])
    for axes in cells[-2:]:
        axes.set_xlabel("time in the trial [s]")
    legend(drawn, cells[0].get_lines())
    return Figure(name, _caption(response, groups[0][1]), _alt(response, len(groups), r2), numbers, drawn)


def _draw(axes: Axes, rows: pd.DataFrame) -> None:
    rows = _broken(rows)
    time, measured = rows["time_s"], rows["measured"]
    low, high = (f"{_BANDED}_{word}" for word in _BOUNDS)
    if low in rows:
        axes.fill_between(time, rows[low], rows[high], color=MODELS[_BANDED].colour, alpha=0.25, linewidth=0)
    axes.plot(time, measured, color=MEASURED.colour, linewidth=1.4, label="measured")
    for model in _DRAWN:
        if model not in rows:
            continue
        look = MODELS[model]
        axes.fill_between(
            time, measured, rows[model], color=look.colour, alpha=0.3 if model == "nominal" else 0.5, linewidth=0
        )
        axes.plot(time, rows[model], color=look.colour, linestyle=look.line, linewidth=0.9, label=MODEL_WORDS[model])


def _broken(rows: pd.DataFrame) -> pd.DataFrame:
    # samples that were left away are not bridged by a line
    time = rows["time_s"].to_numpy()
    step = np.diff(time)
    after = np.flatnonzero(step > 1.5 * np.median(step)) if len(step) else np.array([], int)
    if not len(after):
        return rows
    holes = rows.iloc[after].copy()
    holes["time_s"] += float(np.median(step))
    holes[[str(name) for name in rows if name not in ("variable", "unit", "time_s", "percent")]] = np.nan
    return pd.concat([rows, holes]).sort_values("time_s", kind="stable")


def _title(variable: str, r2: pd.DataFrame) -> str:
    nominal, augmented = (float(r2[f"{model}_on_exo"].loc[variable]) for model in _DRAWN)
    if not (np.isfinite(nominal) and np.isfinite(augmented)):
        return label(variable)
    return f"{label(variable)}: R² {number(nominal)} → {number(augmented)}"


def _caption(response: ParticipantResponse, rows: pd.DataFrame) -> str:
    models, held = listed_models(rows), f"last {response.held_out_s:.4g} s held out, seen by no model"
    return (
        f"{response.participant}: the last {WINDOW_S:g} s of the held-out device walk, n = "
        f"{counted(len(rows), 'sample')} drawn of {len(response.held_out.time)}; split: {held}. "
        f"Black: measured second derivative; {models}; shaded: the gap that each leaves to "
        f"the measurement. {_band_words(response)}R² (Nominal → Augmented) is over all held-out samples. Each panel "
        f"has its unit; titles in red: left; in blue: right."
    )


def _band_words(response: ParticipantResponse) -> str:
    """What the bands hold of all held-out samples, in the mean over variables."""
    held = response.held_out
    if _BANDED not in held.bands:
        return ""
    inside = {m: 100 * np.mean((b[0] <= held.measured) & (held.measured <= b[1])) for m, b in held.bands.items()}
    said = ", ".join(f"{value:.0f} % for {MODEL_WORDS[model]}" for model, value in inside.items())
    return f"Pale green: 90 % band of Augmented, from refits on blocks; measured inside such a band: {said}. "


def listed_models(rows: pd.DataFrame) -> str:
    """Legend of the models in words.

    rows: with a column for each model that is drawn
    """
    looks = {"nominal": "orange, dashed: Nominal", "augmented": "green, solid: Augmented"}
    return "; ".join(words for model, words in looks.items() if model in rows)


def _alt(response: ParticipantResponse, count: int, r2: pd.DataFrame) -> str:
    return (
        f"Measured and predicted accelerations of {response.participant} in {counted(count, 'panel')}; median R² "
        f"{number(r2['nominal_on_exo'].median())} for Nominal and {number(r2['augmented_on_exo'].median())} "
        f"for Augmented."
    )
