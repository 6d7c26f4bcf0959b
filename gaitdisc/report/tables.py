"""Tables of the report: the cells as they are read, and the numbers behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd

from gaitdisc.report.r2_summary import (
    R2_TABLE,
    held_out_text,
    medians,
    participant_medians,
    quartiles_over_participants,
    r2_by_variable,
    sample_counts,
    variables,
)
from gaitdisc.report.strides_figure import reason_kind, stride_numbers
from gaitdisc.report.wording import LIGHTS, MODEL_WORDS, SIDE_WORDS, counted, label, number, unit_text
from gaitdisc.results import ParticipantResponse, ResponseRun


@dataclass(frozen=True, eq=False)
class Table:
    """A table as it is printed.

    Parameters
    ----------
    name : str
        Name of the CSV, without ending.
    caption : str
        What it shows, with n, unit and split where there are numbers.
    columns : tuple of str
        Headings.
    rows : tuple of tuple of str
        Cells.
    numbers : DataFrame
        What the CSV holds.
    groups : tuple of (str, int)
        Headings above the headings, with the number of columns that each spans.
    summary : bool
        The last row sums up the others.
    """

    name: str
    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: pd.DataFrame
    groups: tuple[tuple[str, int], ...] = ()
    summary: bool = False


_R2_GROUPS = (("", 1), ("network", 4), ("ridge", 4), ("noise", 1))


def r2_table(response: ParticipantResponse, name: str) -> Table:
    """R2 of one participant: rows variables, columns models, with the median below.

    Parameters
    ----------
    response : ParticipantResponse
        Whose numbers.
    name : str
        Participant's part of the file name.
    """
    table = r2_by_variable(response)
    units = dict(zip(response.outputs, response.units, strict=True))
    rows = [
        (f"{label(str(v))} [{unit_text(units[str(v)])}]", *(number(x) for x in values.to_numpy()))
        for v, values in table.iterrows()
    ]
    rows.append(("median", *(number(x) for x in medians(table).to_numpy())))
    samples, without = sample_counts(response), sample_counts(response, "nominal")
    caption = (
        f"{response.participant}: R² [1] of the second derivative of each variable (its unit in brackets) on held-out "
        f"device walking, but for the columns that say “no device”; n = {samples} samples of the device walk and "
        f"{without} of the walk without; split: last {response.held_out_s:.4g} s of each walk held out, seen by no "
        f"model. Null: what band-limited noise alone would reach."
    )
    numbers = table.reset_index()
    numbers.insert(1, "unit", list(response.units))
    columns = ("variable", *(column.title for column in R2_TABLE))
    return Table(f"r2-{name}", caption, columns, tuple(rows), numbers, _R2_GROUPS, summary=True)


def study_r2_table(run: ResponseRun) -> Table:
    """R2 over participants: median and quartiles of every variable, with the median participant below.

    Parameters
    ----------
    run : ResponseRun
        With several responses.
    """
    long = quartiles_over_participants(run)
    rows = []
    for variable in variables(run):
        of_variable = long[long["variable"] == variable].set_index("column")
        by_column = of_variable[["median", "q1", "q3"]].T
        cells = [_quartiles(*by_column[column.key]) for column in R2_TABLE]
        rows.append((label(variable), str(int(of_variable["n"].max())), *cells))
    people = participant_medians(run)
    over = people.quantile([0.5, 0.25, 0.75])
    cells = [_quartiles(*over[column.key]) for column in R2_TABLE]
    rows.append(("median over variables", str(len(people)), *cells))
    caption = (
        f"R² [1] of the second derivative of each variable on held-out walking, median [quartiles] over participants, "
        f"n = {counted(len(people), 'participant')} (column n: those who have the variable); split: last "
        f"{held_out_text(run)} s of each walk held out."
    )
    groups = (("", 2), *_R2_GROUPS[1:])
    columns = ("variable", "n", *(column.title for column in R2_TABLE))
    return Table("r2-study", caption, columns, tuple(rows), long, groups, summary=True)


def participants_table(run: ResponseRun) -> Table:
    """Median over variables of every participant, with the median participant below.

    Parameters
    ----------
    run : ResponseRun
        With several responses.
    """
    people = participant_medians(run)
    counts = [sample_counts(response) for response in run.responses]
    rows = [
        (str(person), n, *(number(x) for x in values.to_numpy()))
        for n, (person, values) in zip(counts, people.iterrows(), strict=True)
    ]
    rows.append(("median", "", *(number(x) for x in medians(people).to_numpy())))
    numbers = people.reset_index()
    numbers.insert(1, "samples", counts)
    caption = (
        f"R² [1] on held-out walking, median over variables of each participant, n = "
        f"{counted(len(people), 'participant')} (column n: held-out samples of the device walk); split: last "
        f"{held_out_text(run)} s of each walk held out, seen by no model."
    )
    columns = ("participant", "n", *(column.title for column in R2_TABLE))
    return Table("participants", caption, columns, tuple(rows), numbers, (("", 2), *_R2_GROUPS[1:]), summary=True)


def not_computed(run: ResponseRun, response: ParticipantResponse) -> list[str]:
    """Reasons for the numbers that stand as `not computed`, as far as they are known.

    Parameters
    ----------
    run : ResponseRun
        Whose findings are searched.
    response : ParticipantResponse
        Whose numbers.
    """
    table = r2_by_variable(response).drop(columns="null_on_exo")
    reasons = []
    findings = [f for walk in run.walks if walk.subject == response.participant for f in walk.findings]
    for variable in table.index[table.isna().any(axis=1)]:
        rows = response.r2[response.r2["variable"] == variable]
        seen = [finding.line() for finding in findings if finding.channel == variable]
        if seen:
            reasons.append(f"{label(variable)}: {'; '.join(seen)}")
        elif len(rows) and (rows["n"] == 0).all():
            reasons.append(f"{label(variable)}: no usable sample in the held-out part (n = 0)")
        else:
            reasons.append(f"{label(variable)}: the run holds no number and no reason for it")
    return reasons


def walks_table(run: ResponseRun) -> Table:
    """Every walk with its light, its strides and what found them.

    Parameters
    ----------
    run : ResponseRun
        The whole result.
    """
    rows, records = [], []
    for walk in run.walks:
        colour, word = LIGHTS[walk.worst]
        kept, dropped = walk.counted(True), walk.counted(False)
        sides = sorted({*kept, *dropped}, reverse=True)
        strides = "; ".join(f"{SIDE_WORDS.get(s, s) or 'all'} {kept.get(s, 0)} / {dropped.get(s, 0)}" for s in sides)
        rows.append((
            f"light:{colour}:{word}", walk.subject, walk.condition, f"{walk.duration_s:.1f}", f"{walk.rate_hz:g}",
            walk.detector, strides or "none", str(len(walk.findings)),
        ))  # fmt: skip
        records.append({
            "participant": walk.subject, "condition": walk.condition, "light": colour, "worst": walk.worst,
            "duration_s": walk.duration_s, "rate_hz": walk.rate_hz, "detector": walk.detector,
            **{f"kept_{s or 'all'}": kept.get(s, 0) for s in sides},
            **{f"dropped_{s or 'all'}": dropped.get(s, 0) for s in sides},
            "findings": len(walk.findings),
        })  # fmt: skip
    columns = (
        "quality",
        "participant",
        "walk",
        "length [s]",
        "rate [Hz]",
        "contacts by",
        "strides kept / dropped",
        "findings",
    )
    caption = (
        f"Walks that could be processed, n = {len(run.walks)}. Green: nothing, or notes only; amber: warnings, some "
        f"samples or channels are spoiled; red: the trial is refused."
    )
    return Table("walks", caption, columns, tuple(rows), pd.DataFrame(records))


def refusals_table(run: ResponseRun) -> Table:
    """Everybody and everything left out, with the reason.

    Parameters
    ----------
    run : ResponseRun
        The whole result.
    """
    rows = tuple((r.participant, r.condition or "all", r.reason) for r in run.refusals)
    columns = ("participant", "walk", "reason")
    numbers = pd.DataFrame(rows, columns=pd.Index(columns))
    return Table("refusals", f"Left out, n = {len(rows)}, and why.", columns, rows, numbers)


def findings_table(run: ResponseRun) -> Table:
    """Every finding of every walk, the severest first.

    Parameters
    ----------
    run : ResponseRun
        The whole result.
    """
    numbers = run.findings_table()
    shown = ["severity", "participant", "condition", "kind", "file", "channel", "what", "spans_s", "spoils"]
    headings = ("severity", "participant", "walk", "kind", "file", "channel", "what was seen", "from-to [s]", "spoils")
    rows = tuple(tuple(str(cell) for cell in row) for row in numbers[shown].itertuples(index=False))
    caption = f"Findings of the reader and of the quality checks, n = {len(rows)}; none is left away."
    return Table("findings", caption, headings, rows, numbers)


def dropped_table(run: ResponseRun, participant: str, name: str) -> Table | None:
    """Dropped strides of a participant counted by kind of reason, or None where none was dropped.

    Parameters
    ----------
    run : ResponseRun
        The whole result.
    participant : str
        Whose strides.
    name : str
        Participant's part of the file name.
    """
    strides = stride_numbers(run, participant)
    dropped = strides[~strides["kept"].astype(bool)]
    if not len(dropped):
        return None
    rows = []
    for (code, condition, side), chosen in dropped.groupby(["code", "condition", "side"], sort=False):
        rows.append((
            str(code), str(condition), SIDE_WORDS.get(str(side), str(side)), str(len(chosen)),
            reason_kind(str(chosen["reason"].iloc[0])), str(chosen["reason"].iloc[0]),
        ))  # fmt: skip
    rows.sort()
    caption = f"{participant}: dropped strides by reason, n = {len(dropped)} of {len(strides)}."
    columns = ("letter", "walk", "side", "strides", "kind of reason", "the first of them")
    return Table(f"dropped-{name}", caption, columns, tuple(rows), dropped)


def fits_table(run: ResponseRun) -> Table:
    """What was fitted, on how much, with which decay, in how long.

    Parameters
    ----------
    run : ResponseRun
        The whole result.
    """
    tables = [r.fits.assign(participant=r.participant) for r in run.responses]
    columns = ["participant", "model", "kind", "decay", "epochs", "n_training", "n_inner", "seconds"]
    numbers = pd.concat(tables, ignore_index=True)[columns] if tables else pd.DataFrame(columns=pd.Index(columns))
    rows = [
        (str(row.participant), MODEL_WORDS.get(str(row.model), str(row.model)), str(row.kind), _plain(row.decay),
         _plain(row.epochs), _plain(row.n_training), _plain(row.n_inner), _plain(row.seconds))
        for row in numbers.itertuples(index=False)
    ]  # fmt: skip
    headings = (
        "participant", "model", "kind", "decay chosen", "epochs", "training samples", "inner samples", "time [s]",
    )  # fmt: skip
    caption = (
        f"Fits, n = {len(rows)}; decay: strength of the regularisation, chosen on inner samples, a contiguous last "
        f"part of the training samples; no held-out sample was used."
    )
    return Table("fits", caption, headings, tuple(rows), numbers)


def pairs_table(name: str, caption: str, headings: tuple[str, str], pairs: Sequence[tuple[str, str]]) -> Table:
    """Table of names and values, such as settings, versions and hashes.

    Parameters
    ----------
    name : str
        Name of the CSV.
    caption : str
        What it shows.
    headings : (str, str)
        Of the two columns.
    pairs : sequence of (str, str)
        The rows.
    """
    rows = tuple((str(key), str(value)) for key, value in pairs)
    return Table(name, caption, headings, rows, pd.DataFrame(rows, columns=pd.Index(headings)))


def _quartiles(middle: float, q1: float, q3: float) -> str:
    if pd.isna(middle):
        return number(middle)
    return f"{number(middle)}\n[{number(q1)}, {number(q3)}]"


def _plain(value: object) -> str:
    if not isinstance(value, int | float) and not hasattr(value, "item"):
        return str(value)
    figure = float(value)  # type: ignore[arg-type]
    return "–" if pd.isna(figure) else f"{figure:g}" if abs(figure) < 1e5 else f"{figure:.0f}"
