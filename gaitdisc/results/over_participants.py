"""What the participants of a study say together, beside the pairs of models: lengths, residuals, baselines, kinds."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from gaitdisc.errors import SchemaError
from gaitdisc.results.pair_test import TEST_COLUMNS

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

    def __post_init__(self) -> None:
        """Check columns once."""
        for name, columns in TABLES.items():
            missing = [column for column in columns if column not in getattr(self, name)]
            if missing:
                raise SchemaError(
                    f"comparisons over participants need the columns {', '.join(columns)} in {name}",
                    f"{name} lacks {', '.join(missing)}",
                    "Compare the participants again: `gaitdisc run` on the study.",
                )

    def enough_length(self, second: str = WHOLE) -> float | None:
        """Shortest training length [s] from which on no variable is shown to differ; None where there is none.

        That nothing is shown is no proof of equality, least of all with few participants: the shifts say how far apart
        the two may be.
        """
        chosen = self.lengths[self.lengths["second"] == second]
        found = None
        for length in sorted({float(length) for length in chosen["length_s"]}, reverse=True):
            rows = chosen[chosen["length_s"] == length]
            if rows["different"].any() or not rows["p"].notna().any():
                break
            found = length
        return found

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return every table by its name."""
        return {name: getattr(self, name) for name in TABLES}


def no_rows(name: str) -> pd.DataFrame:
    """Table of that name without any row."""
    return pd.DataFrame(columns=pd.Index(TABLES[name]))
