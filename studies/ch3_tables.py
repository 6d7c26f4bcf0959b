"""Tables of section 3.4 as README and docs hold them, from the cells that `ch3_seeds.py` measured; nothing is computed.

    python studies/ch3_tables.py TABLE

TABLE is `readme`, `recommended`, `evidence`, `rankings`, or a set of `ch3_seeds.py` with the number that is shown:
`lorenz:valid`, `lorenz:jump`, `van_der_pol_text:forecast`; `all` for each of them. Where a number has two starts,
`estimated` is a state estimated from the noisy measurement; the true state is an oracle.
"""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

from command_line import argument, command_line

GIVEN = command_line(
    __name__, __doc__, argument("table", "readme, recommended, evidence, rankings, SET:NUMBER, or all")
)  # before the slow imports

import numpy as np
import pandas as pd

import gaitdisc as gd
from gaitdisc.chapters.discrepancy.discrepancy_cell import FORECAST, ORACLE, RECONSTRUCTION
from gaitdisc.chapters.discrepancy.recommend import FOUND, STARTS, WANTS, recommend
from gaitdisc.chapters.pages.discrepancy_figure import METHOD_WORDS
from gaitdisc.chapters.pages.discrepancy_tables import spread_words
from gaitdisc.report.table import as_markdown, words_table
from gaitdisc.statistics.signed_rank import exact_p

CELLS = Path(__file__).with_name("ch3_cells.csv")
LYAPUNOV_PER_S = 0.906  # of the Lorenz system: Sprott 2003
IN_README = ("sindy", "dmd", "gp", "nn")
START_WORDS = {**STARTS, RECONSTRUCTION: "reconstruction, true start"}
NUMBERS = {
    "forecast": ("accuracy", 1.0, (FORECAST, ORACLE)),
    "parts": ("accuracy", 1.0, (RECONSTRUCTION, FORECAST, ORACLE)),
    "valid": ("valid_s", LYAPUNOV_PER_S, (FORECAST, ORACLE)),
    "jump": ("to_jump", 1.0, (FORECAST, ORACLE)),
}
RANKED = {"van_der_pol_text": "forecast", "van_der_pol_code": "forecast", "lorenz": "valid"}
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

    Where the noises have unlike numbers of seeds, n names each in the order of the columns.
    """
    column, factor, parts = NUMBERS[number]
    of_set = table[table["set"] == name]
    noises, rows = sorted(of_set["noise"].unique()), []
    for method in [each for each in METHOD_WORDS if each in set(of_set["method"])]:
        for part in parts:
            found = of_set[(of_set["method"] == method) & (of_set["part"] == part)]
            counts = found[found["noise"] > 0].groupby("noise")["seed"].nunique()
            n = ", ".join(map(str, counts if len(set(counts)) > 1 else counts[:1])) or "1"
            said = [said_of(found[found["noise"] == noise], column, factor) for noise in noises]
            rows.append((METHOD_WORDS[method], START_WORDS[part], n, *said))
    headings = ("method", "start", "n", *(f"{noise:.1%} noise" for noise in noises))
    return as_markdown(words_table(name, "", headings, rows))


def said_of(found: pd.DataFrame, column: str, factor: float = 1.0) -> str:
    """Median and range of a number over the seeds, or in how many of them the run diverged."""
    if not len(found):
        return ""
    lost = int(found[column].isna().sum())  # it left every bound before the end of what is judged
    among = f" in {lost} of {len(found)}" * (len(found) > 1)
    return f"diverged{among}" if lost else spread_words(factor * found[column].to_numpy(float))


def readme_table(table: pd.DataFrame) -> str:
    """Van der Pol in short: medians from the estimated start, in brackets from the true state."""
    of_set, rows = table[table["set"] == "van_der_pol_text"], []
    noises = sorted(of_set["noise"].unique())
    for method in IN_README:
        said = []
        for noise in noises:
            some = of_set[(of_set["method"] == method) & (of_set["noise"] == noise)]
            one, other = (float(np.median(some.loc[some["part"] == part, "accuracy"])) for part in (FORECAST, ORACLE))
            said.append(f"{one:.1f} ({other:.1f})")
        rows.append((METHOD_WORDS[method], *said))
    words = ["no noise" if noise == 0 else f"{100 * noise:g} %" for noise in noises]
    return as_markdown(words_table("readme", "", ("Van der Pol with a hidden cubic spring", *words), rows))


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
    return as_markdown(words_table("recommended", "", ("record", "noise", "step", "samples", *WANTS), rows))


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
    return as_markdown(words_table("evidence", "", headings, rows))


def rankings(table: pd.DataFrame) -> str:
    """Methods paired by noise seed, forecast accuracy (on Lorenz valid time): the pairs that differ beyond chance."""
    pairs = []
    for name, number in RANKED.items():
        column, factor, parts = NUMBERS[number]
        for part, noise in [(part, noise) for part in parts for noise in (0.001, 0.01, 0.1)]:
            some = table[(table["set"] == name) & (table["noise"] == noise) & (table["part"] == part)]
            by_seed = some.pivot_table(index="seed", columns="method", values=column)
            for one, other in combinations(("sindy", "gp", "nn"), 2):
                ahead = factor * (by_seed.loc[:, one] - by_seed.loc[:, other]).dropna().to_numpy()
                what = f"{name}, {noise:.1%} noise, {START_WORDS[part]}: {METHOD_WORDS[one]} against"
                size = f"{np.median(ahead):+.2g} {'Lyapunov times' if number == 'valid' else 'points'}"
                pairs.append((exact_p(ahead), f"{what} {METHOD_WORDS[other]} {size} in the median, n = {len(ahead)}"))
    corrected = gd.holm_sidak([p for p, _ in pairs])
    sure = [
        f"{said}, p = {p:.3g} ({p_corrected:.2g} corrected)"
        for (p, said), p_corrected, differs in zip(pairs, corrected.adjusted, corrected.rejected, strict=True)
        if differs
    ]
    counted = f"{len(pairs)} pairs; beyond chance (signed rank, Holm-Sidak) differ {len(sure)}"
    return "\n".join(f"- {line}" for line in (counted, *sure))


def sets_tables(table: pd.DataFrame) -> str:
    """Every number of every set of a table of cells, under its name."""
    said = []
    for name in dict.fromkeys(table["set"]):
        chaotic = str(name).startswith("lorenz")
        for number in ("forecast", "valid", "jump") if chaotic else ("forecast",):
            unit = {"forecast": "less RMSE than the known model [%]", "valid": "valid [Lyapunov times]"}
            said.append(f"## {name}: {unit.get(number, 'the same until the first jump [%]')}\n")
            said.append(set_table(table, str(name), number))
    return "\n".join(said)


def every_table(table: pd.DataFrame) -> str:
    """All that this study prints of the kept cells."""
    named = {"In short": readme_table(table), "Rankings": rankings(table)}
    named |= {"What `recommend` answers": recommended_table(), "What it answers from": evidence_table()}
    return "\n".join([f"## {words}\n\n{said}" for words, said in named.items()] + [sets_tables(table)])


def printed(name: str) -> str:
    """A table by its name."""
    if name == "all":
        return every_table(measured())
    if name == "readme":
        return readme_table(measured())
    if name == "recommended":
        return recommended_table()
    if name == "evidence":
        return evidence_table()
    if name == "rankings":
        return rankings(measured())
    return set_table(measured(), *name.split(":"))


if __name__ == "__main__":
    print(printed(GIVEN.table))
