"""Networks against ridge regressions and the filters' null: where a network earns nothing, by name."""

from __future__ import annotations

import math

import pandas as pd

from gaitdisc.report.table import Table
from gaitdisc.report.wording import MODEL_WORDS, counted, label, listed, number
from gaitdisc.results import ResponseRun

BASELINE_WORDS = {
    "ridge": "ridge with phase harmonics",
    "linear": "ridge on the network’s inputs",
    "null": "the null of the filters",
}
_COLUMNS = ("variable", "model", "n", *(f"against {words}" for words in BASELINE_WORDS.values()))


def baseline_table(run: ResponseRun) -> Table | None:
    """R2 of the network minus that of each baseline, one row a variable and model; None where nothing was tested."""
    if run.over is None or not len(run.over.baselines):
        return None
    tests = run.over.baselines
    rows = []
    for (variable, model), found in tests.groupby(["variable", "model"], sort=False):
        cells = [_cell(found[found["first"] == kind].iloc[0]) for kind in BASELINE_WORDS]
        rows.append((label(str(variable)), MODEL_WORDS[str(model)], str(int(found["n"].max())), *cells))
    order = list(dict.fromkeys(tests["variable"]))
    rows.sort(key=lambda row: [label(str(variable)) for variable in order].index(row[0]))
    caption = (
        f"R² [1] of the network minus R² of what needs no network, on the held-out device walk, n = "
        f"{counted(len(run.responses), 'participant')}: Hodges-Lehmann shift [95 % interval, not corrected]; higher or "
        f"lower: exact two-sided signed rank, Holm-Sidak over the variables of one model and baseline, alpha = 0.05. "
        f"The ridge regression of the other tables is the one with phase harmonics."
    )
    groups = (("", 3), ("network minus baseline", 3))
    return Table("baselines", caption, _COLUMNS, tuple(rows), tests, groups)


def baseline_sentences(run: ResponseRun) -> list[str]:
    """Name the variables in which no network is shown to be better than a baseline."""
    if run.over is None or not len(run.over.baselines):
        return []
    tests = run.over.baselines
    said = []
    for model in dict.fromkeys(tests["model"]):
        parts = []
        for kind, words in BASELINE_WORDS.items():
            rows = tests[(tests["model"] == model) & (tests["first"] == kind) & tests["p"].notna()]
            beaten = rows["different"].astype(bool) & (rows["rank_biserial"] > 0)
            names = [label(str(variable)) for variable in rows.loc[~beaten, "variable"]]
            if names:
                which = f"any of {counted(len(rows), 'variable')}" if len(names) == len(rows) else "; ".join(names)
                parts.append(f"{words} (in {which})")
        network = f"The {MODEL_WORDS[str(model)]} network"
        said.append(
            f"{network} is not shown to beat {listed(parts)}." if parts else f"{network} beats every baseline in all."
        )
    return said


def _cell(row: pd.Series) -> str:
    if not math.isfinite(row["p"]):
        return "not tested"
    verdict = ("higher" if row["rank_biserial"] > 0 else "lower") if row["different"] else "not shown"
    return f"{number(row['shift'], 3)} {verdict}\n[{number(row['low'], 3)}, {number(row['high'], 3)}]"
