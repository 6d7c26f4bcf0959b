"""What the participants of a study say together: models in pairs, lengths, residuals, baselines, kinds."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from gaitdisc.saved.kind import CSV, Kind

PAIRS = (("nominal", "augmented"), ("nominal", "exo"), ("augmented", "exo"), ("exo", "perfect"))
FAMILIES = ("pair", "all", "variable")
TEST_COLUMNS = (
    "first", "second", "variable", "n", "zeros", "ties", "w", "p", "tests", "step_level", "p_adjusted", "different",
    "median_first", "median_second", "median_difference", "shift", "low", "high", "rank_biserial", "left_out",
)  # fmt: skip
FAMILY_COLUMNS = ("family", "first", "second", "variable", "tests", "critical", "step_level", "p_adjusted", "different")
WHOLE = "exo, whole training part"
LENGTH_COLUMNS = ("length_s", *TEST_COLUMNS)
REDUCTION_COLUMNS = (
    "participant", "variable", "unit", "model", "strides", "peak_to_peak", "rms",
    "peak_to_peak_reduction", "rms_reduction",
)  # fmt: skip
REDUCTION_TEST_COLUMNS = ("measure", *TEST_COLUMNS)
BASELINE_COLUMNS = ("model", *TEST_COLUMNS)
RESPONDER_COLUMNS = ("participant", "group", "count", "silhouette", "p", "stability")
TABLES = {
    "lengths": LENGTH_COLUMNS,
    "reductions": REDUCTION_COLUMNS,
    "reduction_tests": REDUCTION_TEST_COLUMNS,
    "baselines": BASELINE_COLUMNS,
    "responders": RESPONDER_COLUMNS,
}


@dataclass(frozen=True, eq=False)
class PairTests:
    """Paired comparisons of the models' R2 on held-out device walking, over participants."""

    participants: int
    alpha: float
    level: float
    too_few: str  # why there is no test; empty where there is one
    # one row a pair of models and variable, columns `TEST_COLUMNS`, corrected over the variables of the pair: first and
    # second model (`perfect` is R2 = 1), n (pairs ranked), zeros, ties, w, p (exact, two-sided), tests (in the family),
    # step_level, p_adjusted, different, medians of both, median of second minus first, Hodges-Lehmann shift with low
    # and high, rank_biserial, left_out (why participants are missing)
    tests: pd.DataFrame
    # the same tests under every family of `FAMILIES`, columns `FAMILY_COLUMNS`: all variables of a pair, all tests of
    # the three pairs of models, the three pairs of a variable. critical: level at which the family stopped
    families: pd.DataFrame

    def of_pair(self, first: str, second: str) -> pd.DataFrame:
        """Tests of one pair of models, one row a variable."""
        return self.tests[(self.tests["first"] == first) & (self.tests["second"] == second)]


@dataclass(frozen=True, eq=False)
class OverParticipants:
    """Comparisons over participants; a table without rows was not computed."""

    # comparisons (i) and (ii) of section 4.2.4 at every training length, columns `LENGTH_COLUMNS`: second is `exo`
    # (against Augmented of that length) or `exo, whole training part` (against Exo of that length)
    lengths: pd.DataFrame
    # Stride-averaged residual of every participant, variable and model, columns `REDUCTION_COLUMNS`: peak_to_peak and
    # rms [unit], and by which share of the Nominal model's they are smaller [1]
    reductions: pd.DataFrame
    # these shares against zero over participants, columns `REDUCTION_TEST_COLUMNS`; measure is `peak_to_peak` or `rms`
    reduction_tests: pd.DataFrame
    # R2 of the network (second) against that of what needs no network (first: `ridge`, `linear`, `null`), columns
    # `BASELINE_COLUMNS`
    baselines: pd.DataFrame
    responders: pd.DataFrame  # Sub-group of each participant, 0 where there are none, columns `RESPONDER_COLUMNS`
    lengths_said: str  # why there is no test of the lengths; empty where there is one, or nothing was ablated
    responders_said: str  # the verdict on sub-groups in a sentence

    def enough_length(self, second: str = WHOLE) -> float | None:
        """Shortest length [s] from which no variable is shown to differ (no proof of equality); None without."""
        chosen = self.lengths[self.lengths["second"] == second]
        shortest = None
        for length in sorted({float(length) for length in chosen["length_s"]}, reverse=True):
            rows = chosen[chosen["length_s"] == length]
            if rows["different"].any() or not rows["p"].notna().any():
                break
            shortest = length
        return shortest


def table_of_people(people: Sequence[Any], field: str, columns: Sequence[str]) -> pd.DataFrame:
    """A table that each of some participants has, one below the other, with who it is of; without rows for nobody."""
    every = ["participant", *columns]
    tables = [getattr(person, field).assign(participant=person.participant) for person in people]
    return pd.concat(tables, ignore_index=True)[every] if tables else pd.DataFrame(columns=pd.Index(every))


def join_rows(name: str, tables: Sequence[pd.DataFrame] = ()) -> pd.DataFrame:
    """Table of that name, its parts one below the other."""
    columns = {**TABLES, "tests": TEST_COLUMNS, "families": FAMILY_COLUMNS}[name]
    return pd.concat(tables, ignore_index=True)[list(columns)] if tables else pd.DataFrame(columns=pd.Index(columns))


TESTS = Kind(
    PairTests,
    "tests.json",
    ("participants", "alpha", "level", "too_few"),
    {"tests": CSV("tests.csv", TEST_COLUMNS), "families": CSV("families.csv", FAMILY_COLUMNS)},
    keyed=False,
    blank=("left_out",),
)
OVER = Kind(
    OverParticipants,
    "over.json",
    ("lengths_said", "responders_said"),
    {name: CSV(f"{name}.csv", columns) for name, columns in TABLES.items()},
    keyed=False,
    blank=("left_out",),
)
