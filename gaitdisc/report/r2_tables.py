"""Tables of R2: one participant by variable, several participants by person and by variable, and what is missing."""

from __future__ import annotations

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
from gaitdisc.report.table import Table
from gaitdisc.report.wording import counted, label, number, unit_text
from gaitdisc.results import ParticipantResponse, ResponseRun

_R2_GROUPS = (("", 1), ("network", 4), ("ridge, phase harmonics", 4), ("ridge, inputs alone", 3), ("noise", 1))


def r2_table(response: ParticipantResponse, name: str) -> Table:
    """R2 of one participant: rows variables, columns models, with the median below."""
    table = r2_by_variable(response)
    units = dict(zip(response.outputs, response.units, strict=True))
    rows = [
        (f"{label(str(v))} [{unit_text(units[str(v)])}]", *(number(x, 3) for x in values.to_numpy()))
        for v, values in table.iterrows()
    ]
    rows.append(("median", *(number(x, 3) for x in medians(table).to_numpy())))
    samples, without = sample_counts(response), sample_counts(response, "nominal")
    caption = (
        f"{response.participant}: R² [1] of the second derivative of each variable (its unit in brackets) on held-out "
        f"device walking, but for the columns that say “no device”; n = {samples} samples of the device walk and "
        f"{without} of the walk without; split: last {response.held_out_s:.4g} s of each walk held out, seen by no "
        f"model. Ridge: with harmonics of percent stride beside the network’s inputs, and on these inputs alone. Null: "
        f"what band-limited noise alone would reach."
    )
    numbers = table.reset_index()
    numbers.insert(1, "unit", list(response.units))
    columns = ("variable", *(column.title for column in R2_TABLE))
    return Table(f"r2-{name}", caption, columns, tuple(rows), numbers, _R2_GROUPS, summary=True)


def study_r2_table(run: ResponseRun) -> Table:
    """R2 over participants: median and quartiles of every variable, with the median participant below."""
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
    """Median over variables of every participant, with the median participant below."""
    people = participant_medians(run)
    counts = [sample_counts(response) for response in run.responses]
    rows = [
        (str(person), n, *(number(x, 3) for x in values.to_numpy()))
        for n, (person, values) in zip(counts, people.iterrows(), strict=True)
    ]
    rows.append(("median", "", *(number(x, 3) for x in medians(people).to_numpy())))
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
    """Reasons for the numbers that stand as `not computed`, as far as they are known."""
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


def _quartiles(middle: float, q1: float, q3: float) -> str:
    if pd.isna(middle):
        return number(middle, 3)
    return f"{number(middle, 3)}\n[{number(q1, 3)}, {number(q3, 3)}]"
