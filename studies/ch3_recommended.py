"""What `recommend` answers, and the cells that it answers from."""

from __future__ import annotations

import numpy as np
import pandas as pd
from chapter3.discrepancy_cell import FORECAST, ORACLE
from chapter3.pages import METHOD_WORDS, spread_words
from chapter3.recommend import FOUND, STARTS, WANTS, recommend
from markdown_table import markdown_table

RECORDS = (
    *((False, noise, 0.01, 3001) for noise in (0.0, 0.001, 0.01, 0.1)),
    *((False, noise, 0.01, 601) for noise in (0.001, 0.01, 0.1)),
    *((True, noise, 0.01, 3001) for noise in (0.0, 0.001, 0.01, 0.1)),
    *((True, noise, 0.01, 601) for noise in (0.001, 0.01, 0.1)),
    (True, 0.0, 0.001, 12001),
)  # chaotic, noise, step [s], samples


def recommended_table() -> str:
    """What `recommend` answers: forecast and valid time from the estimated start, then from the true state."""
    rows = []
    for chaotic, noise, step, samples in RECORDS:
        said = []
        for want in WANTS:
            found = recommend(noise, samples, want, chaotic, step)
            some = found.evidence[found.evidence["method"] == found.method]
            worst = some[some["start"] == STARTS[FORECAST]].tail(1)
            if not len(worst):
                said.append("none")
                continue
            same = some[(some["system"] == worst["system"].iloc[0]) & (some["start"] == STARTS[ORACLE])].iloc[0]
            one = worst.iloc[0]
            said.append(
                f"{METHOD_WORDS[found.method]} ({one['accuracy']:.1f} %, {one['valid_s']:.1f} s; "
                f"oracle {same['accuracy']:.1f} %, {same['valid_s']:.1f} s; n = {one['seeds']:.0f})"
            )
        record = "chaotic (Lorenz)" if chaotic else "a limit cycle (Van der Pol)"
        rows.append((record, f"{noise:.1%}", f"{step:g} s", f"{samples:,}", *said))
    return markdown_table(" | ".join(("record", "noise", "step", "samples", *WANTS)), rows)


def evidence_table() -> str:
    """What `recommend` answers from."""
    rows = []
    for one in pd.read_csv(FOUND).itertuples(index=False):
        spread = [one.accuracy] if one.seeds == 1 else [one.least, one.accuracy, one.greatest]
        accuracy = spread_words(np.array(spread, float))
        rows.append((
            one.system, METHOD_WORDS[str(one.method)], f"{one.noise:.1%}", f"{one.dt_s:g}", f"{one.samples:,}",
            one.start, accuracy, f"{one.valid_s:.1f}", f"{one.seconds:.1f}", f"{one.diverged:.0%}", f"{one.seeds}",
        ))  # fmt: skip
    headings = (
        "system", "method", "noise", "step [s]", "samples", "start", "forecast [%]", "valid [s]", "processor time [s]",
        "diverged", "seeds",
    )  # fmt: skip
    return markdown_table(" | ".join(headings), rows)
