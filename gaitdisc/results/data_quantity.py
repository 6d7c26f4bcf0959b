"""How much data is enough: R2 of the models against the length of the training part (section 4.2.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from gaitdisc.errors import SchemaError
from gaitdisc.results.participant_response import R2_COLUMNS

QUANTITY_COLUMNS = ("length_s", "n_training", *R2_COLUMNS)


@dataclass(frozen=True, eq=False)
class DataQuantity:
    """R2 on the same held-out walking for every length of the training part."""

    participant: str
    part: str  # `first` or `last`: which seconds of the training part are taken
    # length_s [s], n_training (samples of the device walk), and the columns of `ParticipantResponse.r2`
    table: pd.DataFrame
    # length [s] -> why there is no row of it: longer than the training part, or too short to fit
    left_away: Mapping[float, str]

    def __post_init__(self) -> None:
        """Check columns once."""
        missing = [column for column in QUANTITY_COLUMNS if column not in self.table.columns]
        if missing:
            raise SchemaError(
                f"a table of R2 by length needs the columns {', '.join(QUANTITY_COLUMNS)}",
                f"that of {self.participant} lacks {', '.join(missing)}",
                "Compute it again with `gaitdisc ablate`.",
            )

    def medians(self, walk: str = "exo", kind: str = "network") -> pd.DataFrame:
        """Median R2 over variables: one row a length, one column a model."""
        chosen = self.table[(self.table["walk"] == walk) & (self.table["kind"] == kind)]
        return chosen.pivot_table(index="length_s", columns="model", values="r2", aggfunc="median")
