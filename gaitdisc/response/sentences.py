"""The answer in sentences, as honest when the device model does not help, and R2 for a terminal of 80 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.response.participant_response import ParticipantResponse, ResponseRun
from gaitdisc.response.r2_tables import R2_TABLE, participant_medians, r2_by_variable, sample_counts, tail_words
from gaitdisc.words import MODEL_WORDS, NONE, counted, label, listing, number, plain

if TYPE_CHECKING:
    import rich.table

MARGIN = 0.005  # a difference in R2 that two printed digits cannot show is called none
MOST_NAMED = 6  # variables in one sentence
_ON_EXO = {model: f"{model}_on_exo" for model in ("nominal", "augmented", "exo")}
_SHOWN = [
    column for column in R2_TABLE if (column.kind, column.walk) != ("ridge", "nominal") and column.kind != "linear"
]
_SHORT = {"nominal": "Nominal", "augmented": "Augm.", "exo": "Exo", "": "null"}


def study_sentences(run: ResponseRun) -> list[str]:
    """What the study as a whole says: who was analysed, and what the models explain over participants."""
    refused = sorted({refusal.participant for refusal in run.refusals})
    left_out = f"; left out entirely or in part: {listing(refused)} (see “Left out”)" if refused else ""
    if not run.responses:
        if refused:
            return [f"No participant could be analysed{left_out}. There are no results."]
        return ["No participant could be analysed: the study contains none. There are no results."]
    analysed = len(run.responses)
    who = f"{counted(analysed, 'participant')} {'was' if analysed == 1 else 'were'} analysed{left_out}."
    if analysed == 1:
        return [f"{who} One participant is not enough for a test: the results describe this participant only."]
    table = participant_medians(run)
    shares = [f"{MODEL_WORDS[model]} {_median_iqr(table[column])}" for model, column in _ON_EXO.items()]
    sentences = [
        who,
        f"On held-out device walking ({run.exo}), the models explain these shares of the variance: {', '.join(shares)} "
        "(medians [quartiles] over participants of each participant's median over variables).",
        _verdict(table, "median over participants; better in", MARGIN, "participant", ""),
    ]
    ridge = (table["ridge_augmented_on_exo"] - table["augmented_on_exo"]).dropna()
    if len(ridge):
        wins = int((ridge >= MARGIN).sum())
        sentences.append(
            "Ridge regression with phase harmonics instead of the networks gives the Augmented model R² = "
            f"{_median_iqr(table['ridge_augmented_on_exo'])} and exceeds the network in {wins} of "
            f"{counted(len(ridge), 'participant')}."
        )
    if table["null_on_exo"].notna().any():
        sentences.append(f"Band-limited noise alone would reach R² = {_median_iqr(table['null_on_exo'])}.")
    return sentences


def participant_sentences(response: ParticipantResponse) -> list[str]:
    """What one participant shows: what the models explain, whether the device model helps, ridge, and the null."""
    table = r2_by_variable(response)
    middle = table.median()
    computed = int(table[_ON_EXO["nominal"]].notna().sum())
    count = len(table)
    over = f"{count} variables" if computed == count else f"{computed} of {count} variables, the others not computed"
    if count == 1:
        over = "the only variable"
    nominal, augmented, exo = (middle[column] for column in _ON_EXO.values())
    explains = f"explains {number(nominal)}"
    if not np.isfinite(nominal):
        explains = "explains a share that was not computed"
    elif nominal < 0:
        explains = f"is worse than the mean and explains nothing (R² {number(nominal)})"
    sentences = [
        f"In {response.participant}, the Nominal model {explains} of the device walk's variance "
        f"(R², median over {over}, held-out last {response.held_out_s:.4g} s, n = {sample_counts(response)} samples), "
        f"the Augmented model {number(augmented)}, and the Exo model {number(exo)}."
    ]
    if np.isfinite(middle["nominal_on_nominal"]):
        sentences.append(
            "On held-out walking without the device, on which it was trained, the Nominal model reaches R² = "
            f"{number(middle['nominal_on_nominal'])}."
        )
    sentences.append(_verdict(table, "median of the differences; better in", 1e-12, "variable", _say_closed(middle)))
    return [*sentences, *filter(None, (_ridge(middle), _null(table, middle)))]


def _verdict(table: pd.DataFrame, about: str, least: float, row: str, closed: str) -> str:
    """Whether the Discrepancy model helps; a row of the table is better from a gain of `least` on."""
    gain = (table["augmented_on_exo"] - table["nominal_on_exo"]).dropna()
    if not len(gain):
        return "It was not computed whether the Discrepancy model helps."
    median = float(gain.median())
    better = f"({about} {int((gain >= least).sum())} of {counted(len(gain), row)})"
    if median >= MARGIN:
        return f"The Discrepancy model helps: R² rises by {number(median)} {better}{closed}."
    if median <= -MARGIN:
        return f"The Discrepancy model makes the prediction worse: R² falls by {number(-median)} {better}."
    same = "the Augmented model is no better than the Nominal model"
    return f"The Discrepancy model does not help: {same}, and R² changes by {number(median, 3)} {better}."


def _say_closed(middle: pd.Series) -> str:
    nominal, augmented, exo = (float(middle[column]) for column in _ON_EXO.values())
    if not np.isfinite(exo) or exo - nominal < 0.01 or augmented <= nominal:
        return ""
    share = (augmented - nominal) / (exo - nominal)
    if share >= 1:
        return ", to the level of the Exo model or above"
    return f", {100 * share:.0f}\u00a0% of the way from the Nominal to the Exo model"


def _ridge(middle: pd.Series) -> str:
    ridge = {model: float(middle[f"ridge_{column}"]) for model, column in _ON_EXO.items()}
    ridge = {model: value for model, value in ridge.items() if np.isfinite(value)}
    if not ridge:
        return ""
    scores = listing([f"{number(value)} ({MODEL_WORDS[model]})" for model, value in ridge.items()])
    start = f"Ridge regression with phase harmonics on the same samples, without any network, reaches R² = {scores}"
    wins = [model for model, value in ridge.items() if value - middle[_ON_EXO[model]] >= MARGIN]
    if wins:
        beaten = listing([f"{MODEL_WORDS[m]} ({number(ridge[m])} against {number(middle[_ON_EXO[m]])})" for m in wins])
        return f"{start}: ridge exceeds the network for {beaten}, so the network has no advantage there."
    if "augmented" not in ridge or not np.isfinite(middle["augmented_on_exo"]):
        return f"{start}."
    gain = float(middle["augmented_on_exo"]) - ridge["augmented"]
    if gain < MARGIN:
        return f"{start}: the networks are no better."
    return f"{start}: the networks add {number(gain)} to R² of the Augmented model."


def _null(table: pd.DataFrame, middle: pd.Series) -> str:
    null = float(middle["null_on_exo"])
    if not np.isfinite(null):
        return ""
    start = f"Band-limited noise alone would reach R² = {number(null)}"
    below = [MODEL_WORDS[m] for m, column in _ON_EXO.items() if middle[column] <= null + MARGIN]
    if below:
        return f"{start}; the {listing(below)} {'model does' if len(below) == 1 else 'models do'} not exceed it."
    lost = [str(v) for v in table.index[table["augmented_on_exo"] <= table["null_on_exo"] + MARGIN]]
    if not lost:
        return f"{start}."
    named = f" ({'; '.join(label(variable) for variable in lost)})" if len(lost) <= MOST_NAMED else ""
    return f"{start}, and in {len(lost)} of {counted(len(table), 'variable')} the Augmented model is no better{named}."


def _median_iqr(values: pd.Series) -> str:
    known = int(values.notna().sum())
    if not known:
        return "not computed"
    q1, middle, q3 = np.quantile(values.dropna(), [0.25, 0.5, 0.75])
    some = f" (n = {known})" if known < len(values) else ""
    return f"{number(middle)} [{number(q1)}, {number(q3)}]{some}"


def r2_text(run: ResponseRun) -> rich.table.Table:
    """R2 of one participant by variable, of several by person (medians over variables), or who was refused, and why."""
    if not run.responses:
        table = _empty(f"No participant could be analysed; left out: n = {len(run.refusals)}.")
        for heading in ("participant", "walk", "reason"):
            table.add_column(heading)
        for refusal in run.refusals:
            table.add_row(plain(refusal.participant), plain(refusal.condition or "all"), plain(refusal.reason))
        return table
    about = f"last {tail_words(run)} s of each walk held out; null: band-limited noise alone"
    if len(run.responses) == 1:
        [response] = run.responses
        title = (
            f"{response.participant}: R² on the held-out device walk, n = {sample_counts(response)} samples; {about}"
        )
        return _print(r2_by_variable(response), title)
    people = counted(len(run.responses), "participant")
    return _print(
        participant_medians(run), f"R² on the held-out device walk, median over variables, n = {people}; {about}"
    )


def _print(values: pd.DataFrame, caption: str) -> rich.table.Table:
    table = _empty(caption)
    table.add_column(plain(str(values.index.name)), vertical="bottom", no_wrap=True)
    for column in _SHOWN:
        kind = "" if column.kind == "null" else column.kind
        place = "no dev." if column.walk == "nominal" else ""
        table.add_column(plain(f"{kind}\n{_SHORT[column.model]}\n{place}"), justify="right", no_wrap=True)
    for name, row in values.iterrows():
        table.add_row(plain(str(name)), *(number(row[column.key], none=NONE) for column in _SHOWN))
    table.add_section()
    middle = values.median()
    table.add_row("median", *(number(middle[column.key], none=NONE) for column in _SHOWN), style="bold")
    return table


def _empty(caption: str) -> rich.table.Table:
    from rich import box
    from rich.table import Table

    return Table(
        box=box.SIMPLE,
        caption=plain(caption),
        caption_justify="left",
        show_edge=False,
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )
