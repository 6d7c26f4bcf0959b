"""The cells of section 3.4 that `ch3_seeds.py` kept: tables of their numbers, and what `recommend` answers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from markdown_table import markdown_table

from .cell import FORECAST, ORACLE, RECONSTRUCTION
from .pages import METHOD_WORDS, spread_words
from .recommend import FOUND, STARTS, WANTS, recommend

CELLS = Path(__file__).parents[1] / "ch3_cells.csv"
LYAPUNOV_PER_S = 0.906  # largest exponent of the Lorenz system: Sprott 2003, Chaos and Time-Series Analysis
START_WORDS = {**STARTS, RECONSTRUCTION: "reconstruction, true start"}
FURTHER = "_start"  # in the name of a set that begins elsewhere
LAWS = {"van_der_pol": r"y: \S+\*x\*\*3", "lorenz": r"x: \S+\*x\*\*3", "mass": r"x: \S+\*x",
        "burgers": r"error: \S+\*u\*\*3"}  # fmt: skip # of SINDy
NUMBERS = {
    "forecast": ("accuracy", 1.0, (FORECAST, ORACLE)),
    "parts": ("accuracy", 1.0, (RECONSTRUCTION, FORECAST, ORACLE)),
    "valid": ("valid_s", LYAPUNOV_PER_S, (FORECAST, ORACLE)),
    "jump": ("to_jump", 1.0, (FORECAST, ORACLE)),
}
RECORDS = (
    *((False, noise, 0.01, 3001) for noise in (0.0, 0.001, 0.01, 0.1)),
    *((False, noise, 0.01, 601) for noise in (0.001, 0.01, 0.1)),
    *((True, noise, 0.01, 3001) for noise in (0.0, 0.001, 0.01, 0.1)),
    *((True, noise, 0.01, 601) for noise in (0.001, 0.01, 0.1)),
    (True, 0.0, 0.001, 12001),
)  # chaotic, noise, step [s], samples


def measured() -> pd.DataFrame:
    """Every cell that is kept, a row a part."""
    return pd.read_csv(CELLS)


def set_table(table: pd.DataFrame, name: str, number: str) -> str:
    """One number of a set: a row a method and start, a column a noise; median and range over the n seeds with noise.

    Where the noises have unlike numbers of seeds, n names each in the order of the columns. Last, in how many fits
    SINDy names the law and nothing else; the other methods name nothing.
    """
    column, factor, parts = NUMBERS[number]
    of_set = table[table["set"].str.startswith(name) if name.endswith(FURTHER) else table["set"] == name]
    noises, rows = sorted(of_set["noise"].unique()), []
    for method in [each for each in METHOD_WORDS if each in set(of_set["method"])]:
        for part in parts:
            found = of_set[(of_set["method"] == method) & (of_set["part"] == part)]
            counts = found[found["noise"] > 0].groupby("noise").size()
            n = ", ".join(map(str, counts if len(set(counts)) > 1 else counts[:1])) or "1"
            said = [said_of(found[found["noise"] == noise], column, factor) for noise in noises]
            rows.append((METHOD_WORDS[method], START_WORDS[part], n, *said))
    law = "" if name.endswith("_state") else next((one for begins, one in LAWS.items() if name.startswith(begins)), "")
    if law:
        fits = of_set[(of_set["method"] == "sindy") & (of_set["part"] == ORACLE)]
        named = fits["terms"].str.fullmatch(law).groupby(fits["noise"])
        rows.append(("SINDy names the law alone", "", "", *(f"{one.sum()} of {len(one)}" for _, one in named)))
    headings = ("method", "start", "n", *(f"{noise:.1%} noise" for noise in noises))
    return markdown_table(" | ".join(headings), rows)


def said_of(found: pd.DataFrame, column: str, factor: float = 1.0) -> str:
    """Median and range of a number over the seeds, or in how many of them the run diverged."""
    if not len(found):
        return ""
    lost = int(found[column].isna().sum())  # it left every bound before the end of the tested part
    among = f" in {lost} of {len(found)}" * (len(found) > 1)
    return f"diverged{among}" if lost else spread_words(factor * found[column].to_numpy(float))


def sets_tables(table: pd.DataFrame) -> str:
    """Every number of every set of a table of cells, under its name."""
    said, units = [], {"forecast": "less RMSE than the known model [%]", "valid": "valid [Lyapunov times]"}
    units["jump"] = "the same until the first jump [%]"
    for name in dict.fromkeys(map(str, table["set"])):
        for number in units if name.startswith("lorenz") else ("forecast",):
            said += [f"## {name}: {units[number]}\n", set_table(table, name, number)]
    return "\n".join(said)


def recommended_table(_: pd.DataFrame) -> str:
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
            one = worst.iloc[0]
            same = some[(some["system"] == one["system"]) & (some["start"] == STARTS[ORACLE])].iloc[0]
            said.append(
                f"{METHOD_WORDS[found.method]} ({one['accuracy']:.1f} %, {one['valid_s']:.1f} s; "
                f"oracle {same['accuracy']:.1f} %, {same['valid_s']:.1f} s; n = {one['seeds']:.0f})"
            )
        record = "chaotic (Lorenz)" if chaotic else "a limit cycle (Van der Pol)"
        rows.append((record, f"{noise:.1%}", f"{step:g} s", f"{samples:,}", *said))
    return markdown_table(" | ".join(("record", "noise", "step", "samples", *WANTS)), rows)


def evidence_table(_: pd.DataFrame) -> str:
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
