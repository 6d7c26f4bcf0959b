"""By how much Augmented and Exo make the stride-averaged residual smaller, over participants (after Fig. 4.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import MODELS
from gaitdisc.report.panels import Room, in_style, legend, panels
from gaitdisc.report.r2 import held_out_text
from gaitdisc.report.table import Table
from gaitdisc.report.wording import MODEL_WORDS, counted, label, number
from gaitdisc.results import ResponseRun

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MEASURES = {"peak_to_peak": "peak to peak", "rms": "root mean square"}
OFFSETS = {"augmented": -0.18, "exo": 0.18}
LOWEST = -100.0  # percent; what a model makes more than twice as large stands at the edge


@in_style
def reduction_figure(run: ResponseRun) -> Figure | None:
    """Reduction of the stride-averaged residual against Nominal, one row a variable; None without numbers."""
    if run.over is None or not run.over.reductions["rms_reduction"].notna().any():
        return None
    reductions, tests = run.over.reductions, run.over.reduction_tests
    names = list(dict.fromkeys(reductions["variable"]))
    drawn, [row] = panels(1, 2, 0.34 * len(names) + 0.2, Room(left=1.75, across=0.3, top=0.6))
    for axes, (measure, words) in zip(row, MEASURES.items(), strict=True):
        for place, variable in enumerate(names):
            _draw(axes, reductions[reductions["variable"] == variable], _of(tests, measure, variable), place, measure)
        low = max(LOWEST, 100 * float(np.nanmin(reductions[f"{measure}_reduction"])) - 5)
        axes.set_xlim(min(low, 0.0), 100)
        axes.axvline(0.0, color="#bbbbbb", linewidth=0.8, zorder=0)
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.set_yticks(range(len(names)), [label(variable) for variable in names])
        axes.tick_params(labelleft=axes is row[0])
        axes.set_xlabel("smaller than Nominal’s by [%]")
        axes.set_title(words)
    legend(drawn, _key(len(tests) > 0))
    return Figure("reduction", _caption(run), _alt(run), reductions, drawn)


def reduction_table(run: ResponseRun) -> Table | None:
    """Reduction of every variable: over participants with its interval, or of the only ones; None without numbers."""
    if run.over is None or not run.over.reductions["rms_reduction"].notna().any():
        return None
    reductions, tests = run.over.reductions, run.over.reduction_tests
    rows = []
    for variable in dict.fromkeys(reductions["variable"]):
        own = reductions[(reductions["variable"] == variable) & (reductions["model"] != "nominal")]
        cells = [_cell(own, tests, variable, measure, model) for measure in MEASURES for model in OFFSETS]
        n = int(own.loc[own["model"] == "augmented", "rms_reduction"].notna().sum())
        rows.append((label(str(variable)), str(n), *cells))
    interval = (
        "Hodges-Lehmann [95 % interval, not corrected]; *: differs from 0, exact two-sided signed rank, Holm-Sidak "
        "over the variables, alpha = 0.05"
        if len(tests)
        else "median over participants, no test with so few"
    )
    caption = (
        f"By how much the stride-averaged residual on the held-out device walk is smaller than the Nominal model’s "
        f"[%], n = {counted(reductions['participant'].nunique(), 'participant')}: {interval}. Negative: larger."
    )
    groups = (("", 2), *((words, 2) for words in MEASURES.values()))
    columns = ("variable", "n", *(MODEL_WORDS[model] for _ in MEASURES for model in OFFSETS))
    numbers = tests if len(tests) else reductions
    return Table("reduction", caption, columns, tuple(rows), numbers, groups)


def reduction_sentences(run: ResponseRun) -> list[str]:
    """Range of the reductions by Augmented over the variables, for each measure."""
    if run.over is None:
        return []
    own = run.over.reductions[run.over.reductions["model"] == "augmented"]
    said = []
    for measure, words in MEASURES.items():
        medians = own.groupby("variable", sort=False)[f"{measure}_reduction"].median().dropna()
        if len(medians):
            least, most = (label(str(name)) for name in (medians.idxmin(), medians.idxmax()))
            said.append(
                f"Measured as {words}, the Augmented model makes the stride-averaged residual smaller by "
                f"{100 * medians.min():.0f} % ({least}) to {100 * medians.max():.0f} % ({most}), medians over "
                f"{counted(own['participant'].nunique(), 'participant')}."
            )
    return said


def _draw(axes: Axes, rows: pd.DataFrame, tests: pd.DataFrame, place: int, measure: str) -> None:
    for model, offset in OFFSETS.items():
        look, y = MODELS[model], place + offset
        values = 100 * rows.loc[rows["model"] == model, f"{measure}_reduction"].dropna().to_numpy()
        axes.plot(np.maximum(values, LOWEST), np.full(len(values), y), look.mark, color=look.colour, ms=2.6, mew=0,
                  alpha=0.6)  # fmt: skip
        found = tests[tests["second"] == model]
        if len(found) and np.isfinite(found["shift"].iloc[0]):
            middle, low, high = (max(100 * float(found[key].iloc[0]), LOWEST) for key in ("shift", "low", "high"))
            axes.hlines(y, low, high, color=look.colour, linewidth=1.4)
            axes.plot([middle], [y], "|", color="#111111", ms=8, mew=1.6)


def _of(tests: pd.DataFrame, measure: str, variable: str) -> pd.DataFrame:
    return tests[(tests["measure"] == measure) & (tests["variable"] == variable)]


def _cell(own: pd.DataFrame, tests: pd.DataFrame, variable: str, measure: str, model: str) -> str:
    found = _of(tests, measure, variable)
    found = found[found["second"] == model]
    if len(found) and np.isfinite(found["shift"].iloc[0]):
        test = found.iloc[0]
        star = "*" if test["different"] else ""
        middle, low, high = (number(100 * float(test[key]), 0) for key in ("shift", "low", "high"))
        return f"{middle}{star}\n[{low}, {high}]"
    return number(100 * float(own.loc[own["model"] == model, f"{measure}_reduction"].median()), 0)


def _key(tested: bool) -> list:
    from matplotlib.lines import Line2D

    marks = [
        Line2D([], [], marker=MODELS[m].mark, color=MODELS[m].colour, linestyle="", ms=4, mew=0, label=MODEL_WORDS[m])
        for m in OFFSETS
    ]
    middle = Line2D([], [], marker="|", color="#111111", ms=8, mew=1.6, linewidth=1.4, label="estimate, 95 % interval")
    return [*marks, middle] if tested else marks


def _caption(run: ResponseRun) -> str:
    over = run.over
    people = 0 if over is None else over.reductions["participant"].nunique()
    return (
        f"Residual (measured minus predicted second derivative) averaged over the held-out strides of the device walk "
        f"({run.exo}): 1 − its size / its size under the Nominal model, measured from peak to peak and as root mean "
        f"square over the stride; n = {counted(people, 'participant')}; split: last {held_out_text(run)} s held out. "
        f"Marks: participants; values below {number(LOWEST, 0)} % stand at the edge. After Fig. 4.3 of the "
        f"dissertation, which gives one number: 52.8 %, hip, one participant, the measure not said."
    )


def _alt(run: ResponseRun) -> str:
    return " ".join(reduction_sentences(run))
