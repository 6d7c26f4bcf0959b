"""Models compared in pairs over the participants: every test with all that it rests on."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from gaitdisc.errors import SchemaError

PAIRS = (("nominal", "augmented"), ("nominal", "exo"), ("augmented", "exo"), ("exo", "perfect"))
FAMILIES = ("pair", "all", "variable")
TEST_COLUMNS = (
    "first", "second", "variable", "n", "zeros", "ties", "w", "p", "tests", "step_level", "p_adjusted", "different",
    "median_first", "median_second", "median_difference", "shift", "low", "high", "rank_biserial", "left_out",
)  # fmt: skip
FAMILY_COLUMNS = ("family", "first", "second", "variable", "tests", "critical", "step_level", "p_adjusted", "different")


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

    def __post_init__(self) -> None:
        """Check columns once."""
        for name, table, columns in (
            ("tests", self.tests, TEST_COLUMNS),
            ("families", self.families, FAMILY_COLUMNS),
        ):
            missing = [column for column in columns if column not in table]
            if missing:
                raise SchemaError(
                    f"paired tests need the columns {', '.join(columns)} in {name}",
                    f"{name} lacks {', '.join(missing)}",
                    "Compare the models again: `gaitdisc run` on the study.",
                )

    def of_pair(self, first: str, second: str) -> pd.DataFrame:
        """Tests of one pair of models, one row a variable."""
        return self.tests[(self.tests["first"] == first) & (self.tests["second"] == second)]
