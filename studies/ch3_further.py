"""Chapter 3 beyond its figures, over twelve noise seeds: methods, noise, starts and trajectories that the text names.

    python studies/ch3_further.py [FOLDER] [--seeds 6] [--tables methods noise ...] [--keep]
    python studies/ch3_further.py --print TABLE

`methods`: exact DMD, SINDy in weak form and as an ensemble, a Gaussian process with a Matern kernel; `noise` that is
not normal; `filters`: the start of a forecast by unscented and ensemble Kalman filters; `gain`: filters with a
sensor's bias among their states; `trajectories`: several, and a forecast whose beginning is learned from; `variance`
of the Gaussian process. Each number is a file of its own in FOLDER: a run that was stopped goes on.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from command_line import argument, tables_line

TABLES = ("methods", "noise", "filters", "gain", "trajectories", "variance")
SEEDS = argument("--seeds", "noise seeds 0 to one less than this", 6)
GIVEN = tables_line(__name__, __doc__, "ch3_further", TABLES, SEEDS)  # before the slow imports

import warnings

import pandas as pd
from chapter3.further_numbers import OFF, SIDES, numbers
from chapter3.kept_cells import said_of
from markdown_table import markdown_table

from gaitdisc.report.table import save_table

CELLS = Path(__file__).with_name("ch3_further.csv")
COLUMNS = ["table", "row", "system", "noise", "seed", "value"]
BOTH = "forecast [% less RMSE], of Lorenz valid time [Lyapunov times]"
HEADINGS = {
    "methods": BOTH,
    "noise": BOTH,
    "filters": "valid time [Lyapunov times], SINDy",
    "gain": "forecast by Kalman filters of a biased sensor [% less RMSE than the known model from the true state, "
    "an oracle], and the gain they find",
    "trajectories": "forecast from 5 s on [% less RMSE], state approach (learned from true starts, oracle)",
    "variance": "missing rate within 1.96 SD of the Gaussian process [%]",
}


def compute(folder: Path, tables: list[str], seeds: int) -> None:
    """Compute what is not there yet, one seed after the other."""
    folder.mkdir(parents=True, exist_ok=True)
    wanted = [(seed, number) for seed in range(seeds) for number in numbers(tables)]
    begun, done = time.monotonic(), 0
    for place, (seed, number) in enumerate(wanted):
        path = folder / f"{number.table}-{number.row}-{number.system}-{number.noise:g}-{seed:02d}.csv"
        if path.exists():
            continue
        *head, computed = number
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            save_table(pd.DataFrame([(*head, seed, computed(seed))], columns=pd.Index(COLUMNS)), path)
        done += 1
        left_min = (time.monotonic() - begun) / done * (len(wanted) - place - 1) / 60
        said = f"{place + 1} of {len(wanted)}, {left_min:.0f} min left at most: {path.name}"
        print(said, file=sys.stderr, flush=True)


def printed(table: pd.DataFrame, name: str) -> str:
    """One table as documents hold it: median [least, greatest] over the seeds."""
    some, rows = table[table["table"] == name], []
    columns = sorted(set(zip(some["system"], some["noise"], strict=True)), key=lambda one: (one[0] == "Lorenz", *one))
    for row in dict.fromkeys(some["row"]):
        found = some[some["row"] == row].groupby(["system", "noise"])
        said = [said_of(found.get_group(one), "value") if one in found.groups else "" for one in columns]
        if row.endswith(OFF):
            inside = [(found.get_group(one)["value"].abs() <= SIDES).sum() for one in columns]
            said = [f"{words}; {count} inside {SIDES}" for words, count in zip(said, inside, strict=True)]
        rows.append((row, str(found.size().max()), *said))
    headings = (HEADINGS[name], "n", *(f"{system}, {100 * noise:g} % noise" for system, noise in columns))
    return markdown_table(" | ".join(headings), rows)


if __name__ == "__main__":
    if GIVEN.print:
        print(printed(pd.read_csv(CELLS), GIVEN.print))
    else:
        compute(GIVEN.folder, GIVEN.tables, GIVEN.seeds)
        table = pd.concat([pd.read_csv(path) for path in sorted(GIVEN.folder.glob("*.csv"))], ignore_index=True)
        found = table.sort_values(COLUMNS[:-1], kind="stable", ignore_index=True)
        print("\n\n".join(printed(found, name) for name in TABLES if name in set(found["table"])))
        if GIVEN.keep:
            save_table(found, CELLS)
