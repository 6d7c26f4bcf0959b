"""What a participant's models explain when one thing is changed: an input left away, a filter, a training length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from gaitdisc.errors import SchemaError
from gaitdisc.results.over_participants import TEST_COLUMNS
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.saved import Saved

QUESTIONS = ("modalities", "sensitivity")
VARIANT_COLUMNS = ("variant", "variable", "model", "kind", "r2", "n")
VARIANT_TEST_COLUMNS = ("variant", "model", *TEST_COLUMNS)


@dataclass(frozen=True, eq=False)
class Variants:
    """R2 on held-out device walking of one participant, under every variant."""

    participant: str
    question: str  # of `QUESTIONS`: `modalities`, inputs left away; `sensitivity`, filters and training lengths
    # columns `VARIANT_COLUMNS`: variant (in words), variable, model, kind, r2, n (held-out samples)
    table: pd.DataFrame
    left_away: Mapping[str, str]  # variant -> why there is no row of it

    def __post_init__(self) -> None:
        """Check question and columns once."""
        missing = [column for column in VARIANT_COLUMNS if column not in self.table.columns]
        if missing or self.question not in QUESTIONS:
            found = f"lacks {', '.join(missing)}" if missing else f"is of the question {self.question!r}"
            raise SchemaError(
                f"variants need the columns {', '.join(VARIANT_COLUMNS)} and a question: {', '.join(QUESTIONS)}",
                f"the table of {self.participant} {found}",
                "Compute it again: `gaitdisc modalities` or `gaitdisc sensitivity`.",
            )


@dataclass(frozen=True, eq=False)
class VariantRun(Saved, by="gaitdisc.results.stores:save_whole_variant_run"):
    """The variants of a study, over its participants."""

    title: str
    exo: str  # the study's word for the device walk
    question: str
    people: tuple[Variants, ...]  # every participant whose models could be fitted
    tests: pd.DataFrame  # columns `VARIANT_TEST_COLUMNS`; empty for fewer than six participants
    refusals: tuple[Refusal, ...]
    held_out_s: tuple[float, float]  # shortest and longest held-out part [s]
    renewed: tuple[str, ...] = ()

    def r2_table(self) -> pd.DataFrame:
        """R2 of every participant, variant, variable, model and kind, one row each."""
        tables = [each.table.assign(participant=each.participant) for each in self.people]
        columns = ["participant", *VARIANT_COLUMNS]
        return pd.concat(tables, ignore_index=True)[columns] if tables else pd.DataFrame(columns=pd.Index(columns))

    def to_frame(self) -> pd.DataFrame:
        """R2 of every participant, variant, variable, model and kind, one row each."""
        return self.r2_table()
