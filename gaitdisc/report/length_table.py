"""Training lengths compared over participants, (i) and (ii) of section 4.2.4, as a table and in sentences."""

from __future__ import annotations

import pandas as pd

from gaitdisc.report.table import Table
from gaitdisc.report.wording import counted, label, number
from gaitdisc.results import ResponseRun
from gaitdisc.results.over_participants import WHOLE

_GROUPS = (("", 2), ("(i) Augmented to Exo, same length", 3), ("(ii) Exo to Exo of the whole training part", 3))
_COLUMNS = ("training [s]", "n", "different", "which", "largest shift", "different", "which", "largest shift")


def length_table(run: ResponseRun) -> Table | None:
    """One row a training length; None where nothing was tested."""
    if run.over is None or not len(run.over.lengths):
        return None
    tests = run.over.lengths
    rows = []
    for length, found in tests.groupby("length_s", sort=True):
        parts = [_cells(found[found["second"] == second]) for second in ("exo", WHOLE)]
        rows.append((f"{length:g}", str(int(found["n"].max())), *parts[0], *parts[1]))
    caption = (
        f"R² [1] on the same held-out device walking by training length, paired over n = "
        f"{counted(len(run.quantities), 'participant')}: exact two-sided signed rank, Holm-Sidak over the variables of "
        f"one length and comparison, alpha = 0.05. Largest shift: Hodges-Lehmann, of the variable that moves most, "
        f"second minus first. The CSV holds every test with its interval."
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
    same, whole = over.enough_length("exo"), over.enough_length(WHOLE)
    exceptions = _lengths_of(over.lengths, "exo")
    return [
        f"(i) Augmented against Exo at the same length: a difference is shown at "
        f"{', '.join(f'{x:g}' for x in exceptions)} s."
        if exceptions
        else "(i) Augmented against Exo at the same length: no difference is shown at any length.",
        f"From {same:g} s on none is shown." if same is not None and exceptions else "",
        f"(ii) Exo against the Exo of the whole training part: from {whole:g} s on no variable is shown to differ."
        if whole is not None
        else f"(ii) Exo against the Exo of the whole training part: at {longest:g} s, the longest but the whole, some "
        f"variable still differs.",
        f"n = {counted(int(over.lengths['n'].max()), 'participant')}: that no difference is shown is no equality.",
    ]


def _lengths_of(tests: pd.DataFrame, second: str) -> list[float]:
    return sorted(set(tests.loc[(tests["second"] == second) & tests["different"].astype(bool), "length_s"]))


def _cells(rows: pd.DataFrame) -> tuple[str, str, str]:
    tested = rows[rows["p"].notna()]
    if not len(tested):
        return ("not tested", "–", "–")
    named = [label(str(variable)) for variable in tested.loc[tested["different"].astype(bool), "variable"]]
    furthest = tested.iloc[int(tested["shift"].abs().to_numpy().argmax())]
    which = "all" if len(named) == len(tested) else ", ".join(named) or "none"
    moved = f"{number(furthest['shift'], 3)} ({label(str(furthest['variable']))})"
    return (f"{len(named)} of {len(tested)}", which, moved)
