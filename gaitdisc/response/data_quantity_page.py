"""How much data is enough: R2 against the length of the training part (after Fig. 4.4), and lengths compared."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import MODELS, Room, in_style, legend, panels
from gaitdisc.report.table import Table
from gaitdisc.response.participant_response import DataQuantity, ResponseRun
from gaitdisc.response.participants_result import WHOLE
from gaitdisc.response.r2_tables import GROUPS, LOWEST, grouped_variables, models_key, tail_words
from gaitdisc.words import counted, label, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEIGHT = 2.3  # of a panel [inch]
APART = 1.4  # least ratio of two lengths that are both written at the axis
ENOUGH = 0.01  # as near to the whole training part as this
_GROUPS = (("", 2), ("(i) Augmented to Exo, same length", 3), ("(ii) Exo to Exo of the entire training part", 3))
_COLUMNS = ("training [s]", "n", "different", "which", "largest shift", "different", "which", "largest shift")


@in_style
def quantity_figure(run: ResponseRun) -> Figure | None:
    """Median R2 over variables of Nominal, Augmented and Exo by training length; None where nothing was ablated."""
    if not run.quantities:
        return None
    numbers = quantity_numbers(run)
    groups = [group for group in GROUPS if group in set(numbers["variables"])]
    drawn, [row] = panels(1, len(groups), HEIGHT, Room(left=0.6, bottom=0.5))
    low = max(LOWEST, float(np.floor(10 * numbers["r2"].min()) / 10))
    for axes, group in zip(row, groups, strict=True):
        _draw(axes, numbers[numbers["variables"] == group], low)
        axes.set_title(GROUPS[group])
    row[0].set_ylabel("R² on the held-out device walk [1]")
    legend(drawn, models_key(ms=3.5))
    alt = f"R² of three models against the training length, for {counted(len(run.quantities), 'participant')}."
    ends = sorted({quantity.part for quantity in run.quantities})
    edge = f" Values below {number(low)} are cut off." if low == LOWEST else ""
    caption = (
        f"R² [1] of the second derivative on the held-out device walk ({run.exo}) by training length; median over "
        f"variables, n = {counted(len(run.quantities), 'participant')}. Only the {' or '.join(ends)} seconds of the "
        f"training part are used; the last {tail_words(run)} s of each walk are held out at all lengths. Thick lines: "
        f"median over participants. Thin lines: each participant. Networks only.{edge} After Fig. 4.4 of the "
        "dissertation."
    )
    return Figure("quantity", caption, alt, numbers, drawn)


def quantity_numbers(run: ResponseRun) -> pd.DataFrame:
    """Variables (`angles` or `EMG`), participant, length_s, network, its median R2 over these, count of variables."""
    tables = []
    for quantity in run.quantities:
        chosen = quantity.table[(quantity.table["kind"] == "network") & (quantity.table["walk"] == "exo")]
        grouped = grouped_variables(chosen).groupby(["variables", "length_s", "model"], sort=True)["r2"]
        table = grouped.agg(r2="median", count="count").reset_index()
        tables.append(table.assign(participant=quantity.participant))
    columns = ["variables", "participant", "length_s", "model", "r2", "count"]
    return pd.concat(tables, ignore_index=True)[columns]


def quantity_sentences(run: ResponseRun) -> list[str]:
    """How much data the Exo model needs to come near to what the whole training part gives, and what was left away."""
    if not run.quantities:
        return []
    near = pd.DataFrame([_near(quantity) for quantity in run.quantities], columns=pd.Index(["from", "whole", "r2"]))
    who = run.quantities[0].participant if len(near) == 1 else f"Over {counted(len(near), 'participant')}"
    reach = f"from {_seconds(near['from'])} on" if (near["from"] < near["whole"]).any() else "only with all data"
    middle = "" if len(near) == 1 else ", medians and ranges over participants"
    sentences = [
        f"{f'In {who}' if len(near) == 1 else who}, the Exo model comes within {ENOUGH:g} of the R² with all "
        f"{_seconds(near['whole'])} of training ({number(near['r2'].median())}, median over variables) "
        f"{reach}{middle}."
    ]
    lengths = sorted({length for quantity in run.quantities for length in quantity.left_away})
    if lengths:
        shown = ", ".join(f"{length:g} s" for length in lengths)
        sentences.append(f"These lengths are left out, because a walk is too short or has too few samples: {shown}.")
    return sentences


def _near(quantity: DataQuantity) -> tuple[float, float, float]:
    """Training length from which on Exo is near to its best, the whole length, and R2 at the whole."""
    exo = quantity.medians()["exo"].sort_index()
    far = exo.index[(exo < exo.iloc[-1] - ENOUGH).to_numpy()]
    start = exo.index[exo.index > far.max()].min() if len(far) else exo.index[0]
    return float(start), float(exo.index[-1]), exo.iloc[-1]


def _seconds(lengths: pd.Series) -> str:
    low, high = lengths.min(), lengths.max()
    return f"{lengths.median():.0f} s" + (f" ({low:.0f} to {high:.0f} s)" if high - low >= 0.5 else "")


def _draw(axes: Axes, rows: pd.DataFrame, low: float) -> None:
    for model, look in MODELS.items():
        of_model = rows[rows["model"] == model]
        for _, person in of_model.groupby("participant"):
            axes.plot(person["length_s"], person["r2"], color=look.colour, linewidth=0.5, alpha=0.5)
        middle = of_model.groupby("length_s")["r2"].median()
        axes.plot(middle.index, middle, color=look.colour, linestyle=look.line, marker=look.mark, ms=3.5, linewidth=1.4)
    axes.set_xscale("log")
    lengths = sorted(set(rows["length_s"]))
    shown = lengths[-1:]
    for length in reversed(lengths):
        if shown[0] / length > APART:
            shown.insert(0, length)
    axes.set_xticks(shown, [f"{x:.0f}" for x in shown])
    axes.minorticks_off()
    axes.set_ylim(low, 1.0)
    axes.set_xlabel("training length [s]")


def length_table(run: ResponseRun) -> Table | None:
    """One row a training length; None where nothing was tested."""
    if run.over is None or not len(run.over.lengths):
        return None
    tests = run.over.lengths
    rows = []
    for length, of_length in tests.groupby("length_s", sort=True):
        cells = [_cells(of_length[of_length["second"] == second]) for second in ("exo", WHOLE)]
        rows.append((f"{length:g}", str(int(of_length["n"].max())), *cells[0], *cells[1]))
    caption = (
        "Tests of R² [1] on the same held-out device walk by training length, paired over n = "
        f"{counted(len(run.quantities), 'participant')}. Exact two-sided signed-rank test, Holm-Sidak correction over "
        "the variables of a length and comparison, alpha = 0.05. Largest shift: Hodges-Lehmann estimate for the "
        "variable with the largest change, second minus first. The CSV contains every test with its interval."
    )
    return Table("lengths", caption, _COLUMNS, tuple(rows), tests, _GROUPS)


def length_sentences(run: ResponseRun) -> list[str]:
    """From which training length on no difference is shown, and what that does not mean."""
    over = run.over
    if over is None or not run.quantities:
        return []
    if over.lengths_said:
        return [f"Training lengths are not tested: {over.lengths_said}."]
    if not len(over.lengths):
        return []
    longest = over.lengths["length_s"].max()
    same_s, whole_s = over.enough_length("exo"), over.enough_length(WHOLE)
    apart = (over.lengths["second"] == "exo") & over.lengths["different"].astype(bool)
    exceptions = sorted(set(over.lengths.loc[apart, "length_s"]))
    return [
        "(i) Augmented against Exo at the same length: the models differ significantly at "
        f"{', '.join(f'{x:g}' for x in exceptions)} s."
        if exceptions
        else "(i) Augmented against Exo at the same length: no significant difference at any length.",
        f"From {same_s:g} s on the models do not differ significantly." if same_s is not None and exceptions else "",
        f"(ii) Exo against Exo with the entire training part: from {whole_s:g} s on no variable differs significantly."
        if whole_s is not None
        else f"(ii) Exo against Exo with the entire training part: even at {longest:g} s, the longest part tested, at "
        "least one variable differs.",
        f"n = {counted(int(over.lengths['n'].max()), 'participant')}: a non-significant difference does not show "
        "equality.",
    ]


def _cells(rows: pd.DataFrame) -> tuple[str, str, str]:
    tested = rows[rows["p"].notna()]
    if not len(tested):
        return ("not tested", "–", "–")
    named = [label(str(variable)) for variable in tested.loc[tested["different"].astype(bool), "variable"]]
    furthest = tested.iloc[int(tested["shift"].abs().to_numpy().argmax())]
    which = "all" if len(named) == len(tested) else ", ".join(named) or "none"
    moved = f"{number(furthest['shift'], 3)} ({label(str(furthest['variable']))})"
    return (f"{len(named)} of {len(tested)}", which, moved)
