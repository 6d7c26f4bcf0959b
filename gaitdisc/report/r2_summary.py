"""R2 as the report shows it: one row a variable, one column for each model, kind and walk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from gaitdisc.report.wording import MODEL_WORDS
from gaitdisc.results import ParticipantResponse, ResponseRun


@dataclass(frozen=True)
class R2Column:
    """One column of the table."""

    key: str
    model: str  # as in the response's table; the null belongs to no model
    kind: str  # as in the response's table; the null belongs to no model
    walk: str  # as in the response's table; the null belongs to no model

    @property
    def title(self) -> str:
        """Words above the column."""
        if self.kind == "null":
            return "null"
        return MODEL_WORDS[self.model] + (", no device" if self.walk == "nominal" else "")


_JUDGED = (("nominal", "nominal"), ("nominal", "exo"), ("augmented", "exo"), ("exo", "exo"))
R2_TABLE = (
    *(R2Column(f"{model}_on_{walk}", model, "network", walk) for model, walk in _JUDGED),
    *(R2Column(f"ridge_{model}_on_{walk}", model, "ridge", walk) for model, walk in _JUDGED),
    *(R2Column(f"linear_{model}_on_exo", model, "linear", "exo") for model in ("nominal", "augmented", "exo")),
    R2Column("null_on_exo", "", "null", "exo"),
)


def r2_by_variable(response: ParticipantResponse) -> pd.DataFrame:
    """R2 of one participant, (variable, column of `R2_TABLE`); NaN where it was not computed.

    response: holds one row for each variable, model, kind and walk
    """
    known = response.r2
    found = {
        (variable, "" if kind == "null" else model, kind, walk): r2
        for variable, model, kind, walk, r2 in zip(
            *(known[name] for name in ("variable", "model", "kind", "walk", "r2")), strict=True
        )
    }
    columns = {
        column.key: [found.get((v, column.model, column.kind, column.walk), np.nan) for v in response.outputs]
        for column in R2_TABLE
    }
    return pd.DataFrame(columns, index=pd.Index(response.outputs, name="variable"), dtype=float)


def medians(table: pd.DataFrame) -> pd.Series:
    """Median of each column over the variables that were computed.

    table: of `r2_by_variable`
    """
    return table.median(axis=0, skipna=True)


def participant_medians(run: ResponseRun) -> pd.DataFrame:
    """Median over variables of every participant, (participant, column of `R2_TABLE`)."""
    names = pd.Index([response.participant for response in run.responses], name="participant")
    rows = [medians(r2_by_variable(response)) for response in run.responses]
    return pd.DataFrame(rows, columns=pd.Index([c.key for c in R2_TABLE])).set_axis(names, axis=0)


def quartiles_over_participants(run: ResponseRun) -> pd.DataFrame:
    """Median, quartiles and number of participants of every variable and column, one row each.

    returns: variable, column, median, q1, q3, n (participants that have the number)
    """
    rows = []
    tables = [r2_by_variable(response) for response in run.responses]
    for variable in variables(run):
        for column in R2_TABLE:
            values = np.array([t.loc[variable, column.key] for t in tables if variable in t.index], float)
            values = values[np.isfinite(values)]
            q1, median, q3 = np.quantile(values, [0.25, 0.5, 0.75]) if len(values) else (np.nan,) * 3
            rows.append((variable, column.key, median, q1, q3, len(values)))
    return pd.DataFrame(rows, columns=pd.Index(["variable", "column", "median", "q1", "q3", "n"]))


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


def held_out_text(run: ResponseRun) -> str:
    """Length of the held-out part in words [s]: one number, the few that there are, or their range."""
    seconds = sorted({f"{response.held_out_s:.4g}" for response in run.responses}, key=float)
    return " or ".join(seconds) if len(seconds) < 4 else f"{seconds[0]} to {seconds[-1]}"
