"""Section 3.4 over twelve noise seeds: every cell, its forecast from the true state and from the estimated one.

    python studies/ch3_seeds.py FOLDER [--seeds 12] [--sets van_der_pol_text lorenz] [--noises 0.01 0.1] [--quick]
    python studies/ch3_seeds.py FOLDER --keep

Each cell is a file in FOLDER: a run that was stopped goes on. `--keep` makes `studies/ch3_cells.csv` of them,
which `ch3_tables.py` prints from, and what `recommend` answers from.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", "a file for each cell that was computed", type=Path),
    argument("--seeds", "noise seeds 0 to one less than this", 12),
    argument("--sets", "names of sets, all where absent", nargs="+"),
    argument("--noises", "shares of each channel's standard deviation, all where absent", nargs="+", type=float),
    argument("--keep", "compute nothing; write studies/ch3_cells.csv and what `recommend` answers from", False),
    QUICK,
)  # before the slow imports

import sys
import warnings
from itertools import product

import numpy as np
import pandas as pd
from ch3_cell_sets import CellSet, cell_sets, chosen_sets
from chapter3.cell import METHODS, RECONSTRUCTION, DiscrepancyCell
from chapter3.kept_cells import CELLS, FURTHER, measured, sets_tables
from chapter3.recommend import FOUND, evidence_of

from gaitdisc.report.table import save_table


def compute(folder: Path, sets: dict[str, CellSet], seeds: int) -> None:
    """Compute what is not there yet: all sets of a seed before the next seed; without noise one seed."""
    warm = set()  # no cell's seconds hold importing and compiling
    for seed, (name, cells) in product(range(seeds), sets.items()):
        for noise in (noise for noise in cells.noises if seed < (cells.seeds if noise else 1)):
            record = cells.record(noise=noise, seed=seed)
            for method in cells.methods:
                path = folder / f"{name}-{noise:g}-{seed:02d}-{method}.csv"
                if path.exists():
                    continue
                if (method, cells.approach, cells.field) not in warm:
                    cells.cell(cells.record(duration_s=600 * 0.01, dt_s=0.01), method)
                    warm.add((method, cells.approach, cells.field))
                table = rows_of(cells.cell(record, method))
                table.insert(0, "set", name)
                table["variant"] += ", begun elsewhere" * (FURTHER in name) + ", a field" * cells.field
                save_table(table, path)
                print(path.name, file=sys.stderr, flush=True)


def rows_of(cell: DiscrepancyCell) -> pd.DataFrame:
    """Numbers of a cell, a row a part: medians over the channels, but the worst of them until the first jump."""
    names = ("system", "variant", "approach", "method", "noise", "dt_s", "samples", "seed")
    head = {name: getattr(cell, name) for name in names}
    head |= {"seconds": cell.fit_s + cell.run_s, "terms": cell.terms, "refused": cell.refused}
    rows = [
        head
        | {"part": name, "accuracy": float(np.median(part.accuracy())), "diverged_s": part.diverged_s}
        | {"valid_s": part.valid_s("augmented"), "valid_known_s": part.valid_s("known")}
        | {"to_jump": float(np.min(part.accuracy(until_s=part.first_jump_s())))}
        for name, part in cell.parts.items()
    ]
    return pd.DataFrame(rows or [head | {"part": ""}])


def gathered(folder: Path) -> pd.DataFrame:
    """Every cell of a folder."""
    return in_order(pd.concat([pd.read_csv(path) for path in sorted(folder.glob("*-*-*-*.csv"))], ignore_index=True))


def in_order(table: pd.DataFrame) -> pd.DataFrame:
    """Cells in the order of the sets, methods, noises and seeds."""
    order = {name: k for k, name in enumerate([*cell_sets(), *METHODS])}
    rank = table.assign(set=table["set"].map(order), method=table["method"].map(order))
    return table.loc[rank.sort_values(["set", "method", "noise", "seed"], kind="stable").index]


def keep(folder: Path) -> None:
    """Write the table of all cells, those of the folder in place of what was kept of them, and `recommend`'s."""
    table = gathered(folder)
    table = table[(table["part"] != RECONSTRUCTION) | ~table["set"].str.contains(FURTHER)]
    cell = ["set", "noise", "seed", "method"]
    old = measured()
    renewed = old.set_index(cell).index.isin(table.set_index(cell).index)
    save_table(in_order(pd.concat([old[~renewed], table], ignore_index=True)), CELLS)
    save_table(evidence_of(measured().query("approach == 'dynamics' and variant == 'right'")), FOUND)


if __name__ == "__main__":
    if GIVEN.keep:
        keep(GIVEN.folder)
    else:
        GIVEN.folder.mkdir(parents=True, exist_ok=True)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            quick = (["van_der_pol_text"], [0.01]) if GIVEN.quick else (GIVEN.sets, GIVEN.noises)
            compute(GIVEN.folder, chosen_sets(*quick), 1 if GIVEN.quick else GIVEN.seeds)
        print(sets_tables(gathered(GIVEN.folder)))
