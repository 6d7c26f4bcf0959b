"""What the participants say together: residuals, baselines, training lengths, sub-groups, each a part of the page."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.page import Block
from gaitdisc.report.panels import MODELS, Room, in_style, legend, legend_lines, panels
from gaitdisc.report.table import Table
from gaitdisc.response.data_quantity_page import length_sentences, length_table, quantity_figure, quantity_sentences
from gaitdisc.response.pair_tests import direction_found
from gaitdisc.response.participant_response import ResponseRun
from gaitdisc.response.participants_result import OverParticipants
from gaitdisc.response.r2_tables import models_key, tail_words
from gaitdisc.words import MODEL_WORDS, counted, label, listing, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MEASURES = {"peak_to_peak": "peak to peak", "rms": "root mean square"}
OFFSETS = {"augmented": -0.18, "exo": 0.18}
ENDS = ("shift", "low", "high")  # of a test: the estimate and its interval
LOWEST = -100.0  # percent; what a model makes more than twice as large stands at the edge
BASELINE_WORDS = {
    "ridge": "ridge with phase harmonics",
    "linear": "ridge on the network’s inputs",
    "null": "band-limited noise alone",
}


def over_blocks(run: ResponseRun) -> list[Block]:
    """Parts of the page that have something to say, in their order."""
    blocks = (
        ("reduced", "Residuals of the models over the stride", reduction_sentences(run), reduction_figure(run),
         reduction_table(run)),
        ("baselines", "Networks compared with simpler baselines", baseline_sentences(run), None, baseline_table(run)),
        ("quantity", "How much data is enough", [*quantity_sentences(run), *length_sentences(run)],
         quantity_figure(run), length_table(run)),
        ("responders", "Sub-groups of responders", responder_sentences(run), None, responder_table(run)),
    )  # fmt: skip
    return [
        Block(anchor, heading, tuple(sentences), (figure,) if figure else (), (table,) if table else ())
        for anchor, heading, sentences, figure, table in blocks
        if sentences
    ]


def responder_sentences(run: ResponseRun) -> list[str]:
    """Verdict on sub-groups, and what `none` is worth; empty for one participant."""
    if run.over is None or len(run.responses) < 2:
        return []
    sentences = [f"{run.over.responders_said}."]
    if len(run.over.responders) and not run.over.responders["group"].any():
        sentences.append("This does not prove homogeneity: with so few people, only large differences are detected.")
    return sentences


def responder_table(run: ResponseRun) -> Table | None:
    """Sub-group of each participant; None where there are none."""
    if run.over is None or not len(run.over.responders) or not run.over.responders["group"].any():
        return None
    groups = run.over.responders
    rows = tuple((str(group), ", ".join(map(str, people["participant"]))) for group, people in groups.groupby("group"))
    caption = (
        "Sub-groups of participants by the shape of the Nominal model's residual over the stride, device walk, all "
        f"outputs together, n = {len(groups)}."
    )
    return Table("responders", caption, ("group", "participants"), rows, groups)


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
            _draw(axes, run.over, variable, measure, place)
        low = max(LOWEST, 100 * float(np.nanmin(reductions[f"{measure}_reduction"])) - 5)
        axes.set_xlim(min(low, 0.0), 100)
        axes.axvline(0.0, color="#bbbbbb", linewidth=0.8, zorder=0)
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.set_yticks(range(len(names)), [label(variable) for variable in names])
        axes.tick_params(labelleft=axes is row[0])
        axes.set_xlabel("reduction relative to Nominal [%]")
        axes.set_title(words)
    key = models_key(tuple(OFFSETS), linestyle="", ms=4, mew=0)
    if len(tests):
        bar = {"marker": "|", "color": "#111111", "ms": 8, "mew": 1.6, "linewidth": 1.4}
        key += legend_lines({"estimate, 95 % CI": bar})
    legend(drawn, key)
    caption = (
        "Residual (measured minus predicted second derivative) averaged over the held-out strides of the device walk "
        f"({run.exo}): 1 − size of the residual / size for the Nominal model, measured from peak to peak and as root "
        f"mean square over the stride; n = {counted(reductions['participant'].nunique(), 'participant')}; split: last "
        f"{tail_words(run)} s held out. Marks: participants. Values below {number(LOWEST, 0)} % are at the edge. After "
        "Fig. 4.3 of the dissertation: 52.8 %, hip, one participant; the measure is not stated."
    )
    return Figure("reduction", caption, " ".join(reduction_sentences(run)), reductions, drawn)


def reduction_table(run: ResponseRun) -> Table | None:
    """Reduction of every variable: over participants with its interval, or of the only ones; None without numbers."""
    if run.over is None or not run.over.reductions["rms_reduction"].notna().any():
        return None
    reductions, tests = run.over.reductions, run.over.reduction_tests
    rows = []
    for variable in dict.fromkeys(reductions["variable"]):
        of_variable = reductions[reductions["variable"] == variable].groupby("model")
        cells = []
        for measure, model in product(MEASURES, OFFSETS):
            test = _test_reduction(tests, measure, variable, model)
            if test is None:
                cells.append(number(100 * float(of_variable[f"{measure}_reduction"].median()[model]), 0))
            else:
                middle, low, high = (number(float(test[key]), 0) for key in ENDS)
                cells.append(f"{middle}{'*' if test['different'] else ''}\n[{low}, {high}]")
        rows.append((label(str(variable)), str(of_variable["rms_reduction"].count()["augmented"]), *cells))
    interval = (
        "Hodges-Lehmann [95 % CI, not corrected]; *: differs from 0, exact two-sided signed-rank test, "
        "Holm-Sidak over the variables, alpha = 0.05"
        if len(tests)
        else "median over participants; too few for a test"
    )
    caption = (
        "Reduction of the stride-averaged residual on the held-out device walk relative to the Nominal model [%], n "
        f"= {counted(reductions['participant'].nunique(), 'participant')}: {interval}. Negative: the residual is "
        "larger."
    )
    groups = (("", 2), *((words, 2) for words in MEASURES.values()))
    columns = ("variable", "n", *(MODEL_WORDS[model] for _ in MEASURES for model in OFFSETS))
    numbers = tests if len(tests) else reductions
    return Table("reduction", caption, columns, tuple(rows), numbers, groups)


def reduction_sentences(run: ResponseRun) -> list[str]:
    """Range of the reductions by Augmented over the variables, for each measure."""
    if run.over is None:
        return []
    augmented = run.over.reductions[run.over.reductions["model"] == "augmented"]
    sentences = []
    for measure, words in MEASURES.items():
        medians = augmented.groupby("variable", sort=False)[f"{measure}_reduction"].median().dropna()
        if len(medians):
            least, most = (label(str(name)) for name in (medians.idxmin(), medians.idxmax()))
            sentences.append(
                f"Measured as {words}, the Augmented model reduces the stride-averaged residual by "
                f"{100 * medians.min():.0f} % ({least}) to {100 * medians.max():.0f} % ({most}), medians over "
                f"{counted(augmented['participant'].nunique(), 'participant')}."
            )
    return sentences


def _draw(axes: Axes, over: OverParticipants, variable: str, measure: str, place: int) -> None:
    rows = over.reductions[over.reductions["variable"] == variable]
    for model, offset in OFFSETS.items():
        look, y = MODELS[model], place + offset
        values = 100 * rows.loc[rows["model"] == model, f"{measure}_reduction"].dropna().to_numpy()
        axes.plot(np.maximum(values, LOWEST), np.full(len(values), y), look.mark, color=look.colour, ms=2.6, mew=0,
                  alpha=0.6)  # fmt: skip
        test = _test_reduction(over.reduction_tests, measure, variable, model)
        if test is not None:
            middle, low, high = (max(float(test[key]), LOWEST) for key in ENDS)
            axes.hlines(y, low, high, color=look.colour, linewidth=1.4)
            axes.plot([middle], [y], "|", color="#111111", ms=8, mew=1.6)


def _test_reduction(tests: pd.DataFrame, measure: str, variable: str, model: str) -> pd.Series | None:
    """Test of one reduction, with its shift and interval in percent; None where it was not tested."""
    chosen = (tests["measure"] == measure) & (tests["variable"] == variable) & (tests["second"] == model)
    tested = tests[chosen & tests["shift"].notna()]
    return None if tested.empty else tested.assign(**{end: 100 * tested[end] for end in ENDS}).iloc[0]


def baseline_table(run: ResponseRun) -> Table | None:
    """R2 of the network minus that of each baseline, one row a variable and model; None where nothing was tested."""
    if run.over is None or not len(run.over.baselines):
        return None
    tests = run.over.baselines
    rows = []
    for (variable, model), of_model in tests.groupby(["variable", "model"], sort=False):
        cells = []
        for row in (of_model[of_model["first"] == kind].iloc[0] for kind in BASELINE_WORDS):
            interval = f"[{number(row['low'], 3)}, {number(row['high'], 3)}]"
            shift = f"{number(row['shift'], 3)} {direction_found(row)}\n{interval}"
            cells.append(shift if math.isfinite(row["p"]) else "not tested")
        rows.append((label(str(variable)), MODEL_WORDS[str(model)], str(int(of_model["n"].max())), *cells))
    order = [label(str(variable)) for variable in dict.fromkeys(tests["variable"])]
    rows.sort(key=lambda row: order.index(row[0]))
    caption = (
        "R² [1] of the network minus R² of a baseline without a network, on the held-out device walk, n = "
        f"{counted(len(run.responses), 'participant')}: Hodges-Lehmann shift [95 % CI, not corrected]; higher or "
        "lower: exact two-sided signed-rank test, Holm-Sidak over the variables of one model and baseline, alpha = "
        "0.05. The ridge regression of the other tables is the one with phase harmonics."
    )
    groups = (("", 3), ("network minus baseline", 3))
    columns = ("variable", "model", "n", *(f"against {words}" for words in BASELINE_WORDS.values()))
    return Table("baselines", caption, columns, tuple(rows), tests, groups)


def baseline_sentences(run: ResponseRun) -> list[str]:
    """Name the variables in which no network is shown to be better than a baseline."""
    if run.over is None or not len(run.over.baselines):
        return []
    tests = run.over.baselines
    sentences = []
    for model in dict.fromkeys(tests["model"]):
        baselines = []
        for kind, words in BASELINE_WORDS.items():
            rows = tests[(tests["model"] == model) & (tests["first"] == kind) & tests["p"].notna()]
            beaten = rows["different"].astype(bool) & (rows["rank_biserial"] > 0)
            names = [label(str(variable)) for variable in rows.loc[~beaten, "variable"]]
            if names:
                which = f"any of {counted(len(rows), 'variable')}" if len(names) == len(rows) else "; ".join(names)
                baselines.append(f"{words} (in {which})")
        network = f"The {MODEL_WORDS[str(model)]} network"
        sentences.append(
            f"{network} does not significantly exceed {listing(baselines)}."
            if baselines
            else f"{network} exceeds every baseline in all variables."
        )
    return sentences
