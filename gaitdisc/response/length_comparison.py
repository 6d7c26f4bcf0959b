"""Which training length is enough, tested over the participants (section 4.2.4)."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from gaitdisc.response.comparison import ALPHA, FEWEST, compare_columns, too_few
from gaitdisc.results.over_participants import LENGTH_COLUMNS, WHOLE, no_rows
from gaitdisc.results.participant_response import DataQuantity


def compare_lengths(quantities: Sequence[DataQuantity], alpha: float = ALPHA) -> pd.DataFrame:
    """Compare, at every training length, Augmented with Exo, and Exo with the Exo of the whole training part.

    alpha: of each family: the variables at one length. One family of all lengths could show nothing at n = 11, for it
        would hold 72 tests or more and at most 52 can
    returns: columns `LENGTH_COLUMNS`, one row a length, comparison and variable; empty for fewer than six
        participants. second is `exo` or `exo, whole training part`. A participant without a length is left out of it
        by name
    Source: Ebers 2023, section 4.2.4, comparisons (i) and (ii). The family is not said there.
    """
    if len(quantities) < FEWEST:
        return no_rows("lengths")
    tables = {q.participant: _network(q) for q in quantities}
    longest = {person: float(table["length_s"].max()) for person, table in tables.items()}
    whole = pd.DataFrame({p: _r2(table, "exo", longest[p]) for p, table in tables.items()}).T
    lengths = sorted({float(n) for p, table in tables.items() for n in table["length_s"] if n < longest[p]})
    parts = []
    for length in lengths:
        models = {
            model: pd.DataFrame({p: _r2(table, model, length) for p, table in tables.items()}).T.reindex(
                index=whole.index, columns=whole.columns
            )
            for model in ("augmented", "exo")
        }
        for first, second, columns in (
            ("augmented", "exo", models["exo"]),
            ("exo", WHOLE, whole),
        ):
            found = compare_columns(models[first], columns, alpha)
            parts.append(found.assign(length_s=length, first=first, second=second))
    return pd.concat(parts, ignore_index=True)[list(LENGTH_COLUMNS)]


def why_no_lengths(quantities: Sequence[DataQuantity]) -> str:
    """Why the lengths are not tested; empty where they are."""
    return too_few(len(quantities)) if len(quantities) < FEWEST else ""


def _network(quantity: DataQuantity) -> pd.DataFrame:
    table = quantity.table
    return table[(table["kind"] == "network") & (table["walk"] == "exo")]


def _r2(table: pd.DataFrame, model: str, length: float) -> pd.Series:
    chosen = table[(table["model"] == model) & (table["length_s"] == length)]
    return chosen.groupby("variable", sort=False)["r2"].first().astype(float)
