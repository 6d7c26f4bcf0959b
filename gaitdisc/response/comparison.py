"""Which model explains more of device walking, over the participants (section 4.2.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from gaitdisc.results.over_participants import FAMILIES, FAMILY_COLUMNS, PAIRS, TEST_COLUMNS, PairTests
from gaitdisc.results.participant_response import ParticipantResponse
from gaitdisc.statistics.holm_sidak import holm_sidak, holm_sidak_by
from gaitdisc.statistics.signed_rank import signed_rank, smallest_p

FEWEST = 6  # the fewest of whom a two-sided exact test can be below 0.05
ALPHA = 0.05
LEVEL = 0.95


def compare_models(responses: Sequence[ParticipantResponse]) -> PairTests:
    """Compare Nominal, Augmented and Exo by their R2 on held-out device walking, in pairs, and Exo with R2 = 1.

    responses: the participants; fewer than six are not tested, and the result says why
    Source: Ebers 2023, section 4.2.3: Wilcoxon signed-rank tests, Holm-Sidak step-down corrections, alpha = 0.05. The
        family is not said; all variables of a pair is the reading that gives the printed 0.013 and 0.042. Beside the
        source: other families, effect sizes, intervals. That Exo is below R2 = 1 no measurement can contradict, for R2
        is never above 1: its p is the smallest that n allows, and only the shift is of interest.
    """
    models = {model: r2_by_participant(responses, model) for model in ("nominal", "augmented", "exo")}
    models["perfect"] = models["exo"].where(models["exo"].isna(), 1.0)
    if len(responses) < FEWEST:
        empty = pd.DataFrame(columns=pd.Index(TEST_COLUMNS)), pd.DataFrame(columns=pd.Index(FAMILY_COLUMNS))
        return PairTests(len(responses), ALPHA, LEVEL, too_few(len(responses)), *empty)
    tests = pd.concat(
        [compare_columns(models[a], models[b]).assign(first=a, second=b) for a, b in PAIRS], ignore_index=True
    )
    return PairTests(len(responses), ALPHA, LEVEL, "", tests[list(TEST_COLUMNS)], by_family(tests))


def compare_columns(first: pd.DataFrame, second: pd.DataFrame, alpha: float = ALPHA) -> pd.DataFrame:
    """Test second against first in every column, participants paired, corrected over the columns.

    first, second DataFrame (participant, variable): with the same participants and variables; NaN where a number was
        not computed
    returns: one row a variable, the columns of `PairTests.tests` but first and second. A variable that fewer than six
        participants have is in the table, but not tested and not of the family
    """
    table = pd.DataFrame([_row(variable, first[variable], second[variable]) for variable in first.columns])
    tested = table["p"].notna().to_numpy()
    table["tests"] = int(tested.sum())
    table["step_level"], table["p_adjusted"], table["different"] = np.nan, np.nan, False
    if tested.any():
        found = holm_sidak(table.loc[tested, "p"].to_numpy(), alpha)
        table.loc[tested, "step_level"] = found.level
        table.loc[tested, "p_adjusted"] = found.adjusted
        table.loc[tested, "different"] = found.rejected
    return table


def by_family(tests: pd.DataFrame, alpha: float = ALPHA) -> pd.DataFrame:
    """Tests (first, second, variable, p) of three pairs corrected under every family meant: `FAMILY_COLUMNS`."""
    chosen = tests[tests["p"].notna() & (tests["second"] != "perfect")]
    families = {
        "pair": (chosen["first"] + " " + chosen["second"]).tolist(),
        "all": ["all"] * len(chosen),
        "variable": chosen["variable"].tolist(),
    }
    parts = []
    for name in FAMILIES:
        for family, found in holm_sidak_by(chosen["p"].to_numpy(), families[name], alpha).items():
            rows = chosen.loc[np.array(families[name]) == family, ["first", "second", "variable"]]
            parts.append(
                rows.assign(
                    family=name,
                    tests=len(rows),
                    critical=found.critical,
                    step_level=found.level,
                    p_adjusted=found.adjusted,
                    different=found.rejected,
                )
            )
    if not parts:
        return pd.DataFrame(columns=pd.Index(FAMILY_COLUMNS))
    return pd.concat(parts, ignore_index=True)[list(FAMILY_COLUMNS)]


def r2_by_participant(responses: Sequence[ParticipantResponse], model: str, kind: str = "network") -> pd.DataFrame:
    """R2 on held-out device walking, (participant, variable); NaN where it was not computed."""
    variables = dict.fromkeys(name for response in responses for name in response.outputs)
    rows = {r.participant: {v: r.r2_of(v, model, kind) for v in r.outputs} for r in responses}
    return pd.DataFrame.from_dict(rows, orient="index", columns=list(variables), dtype=float)


def too_few(participants: int) -> str:
    """Why so few participants are not tested.

    >>> too_few(5)
    '5 participants are too few for a test: the smallest p is 0.0625, not below 0.05 even if all of them agree'
    """
    if participants < 2:
        return "One participant carries no test" if participants else "No participant, no test"
    return (
        f"{participants} participants are too few for a test: the smallest p is {smallest_p(participants):g}, "
        f"not below {ALPHA:g} even if all of them agree"
    )


def _row(variable: str, first: pd.Series, second: pd.Series) -> Mapping[str, object]:
    absent = [i for i, (a, b) in enumerate(zip(first, second, strict=True)) if not np.isfinite(a) or not np.isfinite(b)]
    names = [str(first.index[i]) for i in absent]
    left_out = f"not computed: {', '.join(names)}" if names else ""
    row: dict[str, object] = {"variable": variable, "left_out": left_out}
    if len(first) - len(absent) < FEWEST:
        nothing = dict.fromkeys(
            (
                "w", "p", "median_first", "median_second", "median_difference", "shift", "low", "high", "rank_biserial",
            ),
            np.nan,
        )  # fmt: skip
        return row | {"n": len(first) - len(absent), "zeros": 0, "ties": False} | nothing
    found = signed_rank(first.to_numpy(), second.to_numpy(), dict(zip(absent, names, strict=True)), LEVEL)
    there = np.setdiff1d(np.arange(len(first)), absent)
    return row | {
        "n": found.n,
        "zeros": found.zeros,
        "ties": found.ties,
        "w": found.w,
        "p": found.p,
        "median_first": float(first.iloc[there].median()),
        "median_second": float(second.iloc[there].median()),
        "median_difference": found.median,
        "shift": found.shift,
        "low": found.low,
        "high": found.high,
        "rank_biserial": found.rank_biserial,
    }
