"""R2 of every variable: Nominal, Augmented and Exo, network and ridge, and what noise alone would reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import MODELS, NULL, Room, draw_box, in_style, legend, legend_lines, panels, sheets
from gaitdisc.report.table import Table
from gaitdisc.response.participant_response import ParticipantResponse, ResponseRun
from gaitdisc.words import MODEL_WORDS, counted, label, number, unit_text

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

GROUPS = {"angles": "joint angles", "EMG": "EMG envelopes"}  # of variables
_TESTED = (("nominal", "nominal"), ("nominal", "exo"), ("augmented", "exo"), ("exo", "exo"))
LOWEST = -0.25  # R2 below this is drawn at the edge of the axis, with its value
FEWEST_FOR_BOXES = 5
MOST_VALUES = 3  # that are written one by one
ROW_IN, LABELLED_ROW_IN = 0.36, 0.5  # a row's height; three lines of labels need more
_OFFSETS = {"nominal": -0.24, "augmented": 0.0, "exo": 0.24}
_R2_GROUPS = (("network", 4), ("ridge, phase harmonics", 4), ("ridge, inputs alone", 3), ("noise", 1))


@dataclass(frozen=True)
class R2Column:
    """One column of the table."""

    key: str
    model: str  # as the response's table names it, as kind and walk; the null belongs to none
    kind: str
    walk: str

    @property
    def title(self) -> str:
        """Words above the column."""
        if self.kind == "null":
            return "null"
        return MODEL_WORDS[self.model] + (", no device" if self.walk == "nominal" else "")


R2_TABLE = (
    *(R2Column(f"{model}_on_{walk}", model, "network", walk) for model, walk in _TESTED),
    *(R2Column(f"ridge_{model}_on_{walk}", model, "ridge", walk) for model, walk in _TESTED),
    *(R2Column(f"linear_{model}_on_exo", model, "linear", "exo") for model in ("nominal", "augmented", "exo")),
    R2Column("null_on_exo", "", "null", "exo"),
)


def r2_by_variable(response: ParticipantResponse) -> pd.DataFrame:
    """R2 of one participant, (variable, column of `R2_TABLE`); NaN where it was not computed."""
    known = response.r2
    places = {(column.model or "nominal", column.kind, column.walk): column.key for column in R2_TABLE}
    keys = [places.get(key, "") for key in zip(known["model"], known["kind"], known["walk"], strict=True)]
    wide = known.assign(key=np.array(keys, str)).pivot_table("r2", "variable", "key", aggfunc="last")
    rows = pd.Index(response.outputs, name="variable")
    return wide.reindex(index=rows, columns=pd.Index([column.key for column in R2_TABLE])).astype(float)


def participant_medians(run: ResponseRun) -> pd.DataFrame:
    """Median over variables of every participant, (participant, column of `R2_TABLE`)."""
    names = pd.Index([response.participant for response in run.responses], name="participant")
    rows = [r2_by_variable(response).median() for response in run.responses]
    return pd.DataFrame(rows, columns=pd.Index([c.key for c in R2_TABLE])).set_axis(names, axis=0)


def quartiles_over_participants(run: ResponseRun) -> pd.DataFrame:
    """Variable, column, median, q1, q3 and n of participants who have the number, one row each."""
    rows = []
    tables = [r2_by_variable(response) for response in run.responses]
    for variable in variables(run):
        for column in R2_TABLE:
            values = np.array([t.loc[variable, column.key] for t in tables if variable in t.index], float)
            values = values[np.isfinite(values)]
            q1, median, q3 = np.quantile(values, [0.25, 0.5, 0.75]) if len(values) else (np.nan,) * 3
            rows.append((variable, column.key, median, q1, q3, len(values)))
    return pd.DataFrame(rows, columns=pd.Index(["variable", "column", "median", "q1", "q3", "n"]))


def grouped_variables(table: pd.DataFrame) -> pd.DataFrame:
    """Table with the group of each of its variables: a key of `GROUPS`."""
    return table.assign(variables=np.where(table["variable"].str.startswith("emg_"), "EMG", "angles"))


def variables(run: ResponseRun) -> tuple[str, ...]:
    """Outputs of all participants, each once, in the order of the first who has it."""
    return tuple(dict.fromkeys(name for response in run.responses for name in response.outputs))


def sample_counts(response: ParticipantResponse, walk: str = "exo") -> str:
    """Held-out samples behind the numbers of one walk: one number, or the range where variables differ."""
    counts = response.r2.loc[(response.r2["walk"] == walk) & (response.r2["kind"] == "network"), "n"]
    if not len(counts):
        return "0"
    low, high = int(counts.min()), int(counts.max())
    return f"{low}" if low == high else f"{low}-{high}"


def tail_words(run: ResponseRun) -> str:
    """Length of the held-out part in words [s]: one number, the few that there are, or their range."""
    seconds = sorted({f"{response.held_out_s:.4g}" for response in run.responses}, key=float)
    return " or ".join(seconds) if len(seconds) < 4 else f"{seconds[0]} to {seconds[-1]}"


@in_style
def r2_figures(run: ResponseRun) -> list[Figure]:
    """R2 on the held-out device walk, one row a variable; points for one participant, boxes for several."""
    numbers = r2_numbers(run)
    pages = sheets(variables(run), 12, "r2")
    return [_figure(run, numbers[numbers["variable"].isin(part)], name) for name, part in pages.items()]


def r2_numbers(run: ResponseRun) -> pd.DataFrame:
    """Participant, variable, model (empty for the null), kind and r2 on the held-out device walk."""
    columns = [column for column in R2_TABLE if column.walk == "exo" and column.kind != "linear"]
    rows = [
        (response.participant, variable, column.model, column.kind, value)
        for response in run.responses
        for table in [r2_by_variable(response)]
        for column in columns
        for variable, value in table[column.key].items()
    ]
    return pd.DataFrame(rows, columns=pd.Index(["participant", "variable", "model", "kind", "r2"]))


def _figure(run: ResponseRun, numbers: pd.DataFrame, name: str) -> Figure:
    names = list(dict.fromkeys(numbers["variable"]))
    low = lowest_drawn(numbers)
    row_in = LABELLED_ROW_IN if numbers["r2"].min() < low else ROW_IN
    drawn, [[axes]] = panels(1, 1, row_in * len(names) + 0.1, Room(left=1.75, right=0.25, top=0.45))
    draw_r2(axes, numbers)
    ranges = [
        f"{MODEL_WORDS[str(model)]} from {number(values.min())} to {number(values.max())}"
        for model, values in numbers[numbers["kind"] == "network"].groupby("model", sort=False)["r2"]
    ]
    alt = f"R² of {counted(len(names), 'variable')} on the held-out device walk of {run.title}: {'; '.join(ranges)}."
    null = bool(numbers.loc[numbers["kind"] == "null", "r2"].notna().any())
    legend(drawn, r2_key(len(run.responses), null))
    return Figure(name, _caption(run, low, null), alt, numbers, drawn)


def draw_r2(axes: Axes, numbers: pd.DataFrame) -> None:
    """Draw R2 of every variable, a row each, from `r2_numbers`."""
    names, low = list(dict.fromkeys(numbers["variable"])), lowest_drawn(numbers)
    for row, variable in enumerate(names):
        _draw_variable(axes, numbers[numbers["variable"] == variable], row, low)
    axes.set_yticks(range(len(names)), [label(variable) for variable in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(low, 1.0)
    axes.set_xlabel("R² on the held-out device walk [1]; 1: all of the variance, 0: no better than the mean")
    for edge in np.arange(len(names) - 1) + 0.5:
        axes.axhline(edge, color="#e4e4e4", linewidth=0.6, zorder=0)
    if low < 0:
        axes.axvline(0.0, color="#bbbbbb", linewidth=0.8, zorder=0)


def _draw_variable(axes: Axes, rows: pd.DataFrame, row: int, low: float) -> None:
    null = rows.loc[rows["kind"] == "null", "r2"].median()
    if np.isfinite(null):
        axes.vlines(max(null, low), row - 0.42, row + 0.42, color=NULL.colour, linestyle=NULL.line, linewidth=1.1)
    for model, offset in _OFFSETS.items():
        look, y = MODELS[model], row + offset
        of_model = rows[rows["model"] == model]
        network = of_model.loc[of_model["kind"] == "network", "r2"].dropna().to_numpy()
        ridge = of_model.loc[of_model["kind"] == "ridge", "r2"].dropna().to_numpy()
        if len(ridge):
            middle = float(np.median(ridge))
            axes.plot([max(middle, low)], [y], look.mark, mfc="none", mec=look.colour, mew=1.1, ms=6.5, clip_on=False)
        if len(network) >= FEWEST_FOR_BOXES:
            draw_box(axes, network, y, look.colour, "horizontal")
        small = 2.2 if len(network) >= FEWEST_FOR_BOXES else 4.6
        shown = np.maximum(network, low)
        axes.plot(shown, np.full(len(shown), y), look.mark, color=look.colour, ms=small, mew=0, clip_on=False, zorder=3)
        hidden = np.sort(network[network < low])
        if len(hidden):  # one label for all of them
            several = f"{len(hidden)} values, {number(hidden[0])} to {number(hidden[-1])}"
            below = several if len(hidden) > MOST_VALUES else ", ".join(map(number, hidden))
            axes.annotate(f"◂ {below}", (low, y), (5, 0), textcoords="offset points", va="center", fontsize=6)


def models_key(models: Sequence[str] = tuple(MODELS), **style: Any) -> list[Artist]:
    """Handles of a legend that explains models; without a style of its own each has its line."""
    looks = {MODEL_WORDS[model]: look for model, look in MODELS.items() if model in models}
    return legend_lines(
        {w: {"color": k.colour, "marker": k.mark, "linestyle": k.line} | style for w, k in looks.items()}
    )


def r2_key(people: int, null: bool) -> list[Artist]:
    """Handles of the legend."""
    ridge = {"marker": "o", "mfc": "none", "mec": "#333333", "linestyle": "", "ms": 6.5}
    others = {"ridge" if people == 1 else "ridge, median": ridge, **({"band-limited noise": NULL} if null else {})}
    return [*models_key(linestyle="", ms=5, mew=0), *legend_lines(others)]


def lowest_drawn(numbers: pd.DataFrame) -> float:
    """Lower end of the axis of R2: `LOWEST`, or the tenth below the lowest value."""
    lowest = float(numbers["r2"].min())
    if not np.isfinite(lowest):
        return 0.0
    return max(LOWEST, float(np.floor(10 * (lowest - 0.02)) / 10))


def _caption(run: ResponseRun, low: float, null: bool) -> str:
    people = len(run.responses)
    marks = (
        "Filled marks: networks; hollow marks of the same shape: ridge regression with phase harmonics"
        if people == 1
        else f"Small filled marks: networks, one per participant, with a box of quartiles from {FEWEST_FOR_BOXES} "
        "participants on (thick line: median, whiskers: range); hollow marks: median of ridge regression with "
        "phase harmonics"
    )
    counts = run.r2_table()
    counts = counts.loc[(counts["walk"] == "exo") & (counts["kind"] == "network"), "n"]
    fewest, most = int(counts.min()), int(counts.max())
    samples = f"{fewest} samples" if fewest == most else f"{fewest} to {most} samples each"
    noise = "dashed: R² of band-limited noise alone" if null else "R² of band-limited noise was not computed"
    edge = f" R² below {number(low)} is shown at the left edge with its value." if low == LOWEST else ""
    start = f" The axis starts at {number(low, 1)}." if low > 0 else ""
    return (
        f"R² [1] of the second derivative of each variable on the held-out device walk ({run.exo}), "
        f"n = {counted(people, 'participant')}, {samples}; split: last {tail_words(run)} s of the walk held "
        f"out. {marks}; {noise}.{start}{edge}"
    )


def r2_table(response: ParticipantResponse, name: str) -> Table:
    """R2 of one participant: rows variables, columns models, with the median below."""
    table = r2_by_variable(response)
    units = dict(zip(response.outputs, response.units, strict=True))
    rows = [(f"{label(str(v))} [{unit_text(units[str(v)])}]", *_cells(values)) for v, values in table.iterrows()]
    rows.append(("median", *_cells(table.median())))
    samples, without = sample_counts(response), sample_counts(response, "nominal")
    caption = (
        f"{response.participant}: R² [1] of the second derivative of each variable (unit in brackets) on held-out "
        f"device walking, and on the walk without the device in columns marked “no device”; n = {samples} samples "
        f"with and {without} without the device; split: last {response.held_out_s:.4g} s of each walk held out, used "
        "by no model. Ridge: with harmonics of percent stride in addition to the network's inputs, and on these inputs "
        "alone. Null: R² of band-limited noise alone."
    )
    numbers = table.reset_index()
    numbers.insert(1, "unit", list(response.units))
    return _table_of_r2(f"r2-{name}", caption, ("variable",), rows, numbers)


def study_r2_table(run: ResponseRun) -> Table:
    """R2 over participants: median and quartiles of every variable, with the median participant below."""
    long = quartiles_over_participants(run)
    rows = []
    for variable in variables(run):
        of_variable = long[long["variable"] == variable]
        quartiles = of_variable[["median", "q1", "q3"]].to_numpy()
        rows.append((label(variable), str(int(of_variable["n"].max())), *(_quartiles(*row) for row in quartiles)))
    people = participant_medians(run)
    over = people.quantile([0.5, 0.25, 0.75]).T.to_numpy()
    rows.append(("median over variables", str(len(people)), *(_quartiles(*row) for row in over)))
    caption = (
        f"R² [1] of the second derivative of each variable on held-out walking, median [quartiles] over participants, "
        f"n = {counted(len(people), 'participant')} (column n: those who have the variable); split: last "
        f"{tail_words(run)} s of each walk held out."
    )
    return _table_of_r2("r2-study", caption, ("variable", "n"), rows, long)


def participants_table(run: ResponseRun) -> Table:
    """Median over variables of every participant, with the median participant below."""
    people = participant_medians(run)
    counts = [sample_counts(response) for response in run.responses]
    rows = [(str(person), n, *_cells(r2)) for n, (person, r2) in zip(counts, people.iterrows(), strict=True)]
    rows.append(("median", "", *_cells(people.median())))
    numbers = people.reset_index()
    numbers.insert(1, "samples", counts)
    caption = (
        "R² [1] on held-out walking, median over variables of each participant, n = "
        f"{counted(len(people), 'participant')} (column n: held-out samples of the device walk); split: last "
        f"{tail_words(run)} s of each walk held out, used by no model."
    )
    return _table_of_r2("participants", caption, ("participant", "n"), rows, numbers)


def _table_of_r2(
    name: str, caption: str, first: tuple[str, ...], rows: list[tuple[str, ...]], numbers: pd.DataFrame
) -> Table:
    """Table whose columns, after the first, are those of `R2_TABLE`, and whose last row sums up the others."""
    columns = (*first, *(column.title for column in R2_TABLE))
    return Table(name, caption, columns, tuple(rows), numbers, (("", len(first)), *_R2_GROUPS), summary=True)


def _cells(values: pd.Series) -> tuple[str, ...]:
    return tuple(number(value, 3) for value in values)


def not_computed(run: ResponseRun, response: ParticipantResponse) -> list[str]:
    """Reasons for the numbers that stand as `not computed`, as far as they are known."""
    table = r2_by_variable(response).drop(columns="null_on_exo")
    reasons = []
    findings = [f for walk in run.walks if walk.subject == response.participant for f in walk.findings]
    for variable in table.index[table.isna().any(axis=1)]:
        rows = response.r2[response.r2["variable"] == variable]
        notes = [finding.line() for finding in findings if finding.channel == variable]
        if notes:
            reasons.append(f"{label(variable)}: {'; '.join(notes)}")
        elif len(rows) and (rows["n"] == 0).all():
            reasons.append(f"{label(variable)}: no usable sample in the held-out part (n = 0)")
        else:
            reasons.append(f"{label(variable)}: the run contains neither a number nor a reason")
    return reasons


def _quartiles(middle: float, q1: float, q3: float) -> str:
    if pd.isna(middle):
        return number(middle, 3)
    return f"{number(middle, 3)}\n[{number(q1, 3)}, {number(q3, 3)}]"
