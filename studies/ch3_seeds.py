"""Section 3.4 over twelve noise seeds: every cell, its forecast from the true state and from the estimated one.

    python studies/ch3_seeds.py FOLDER [--seeds 12] [--sets van_der_pol_text ...]
    python studies/ch3_seeds.py FOLDER --write-docs

Each cell is a file of its own in FOLDER, written whole: a run that was stopped goes on where it stopped. With
`--write-docs` nothing is computed: what FOLDER holds becomes `studies/ch3_cells.csv`, and from that table alone are
written what `recommend` answers from and the marked tables of README.md and docs (`ch3_pages.py`).
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import ch3_lorenz
import ch3_measurement_bias
import ch3_van_der_pol
import numpy as np
import pandas as pd
from ch3_pages import CELLS, write_docs

from gaitdisc.discrepancy.cell import cell_of
from gaitdisc.discrepancy.error_signal import Approach
from gaitdisc.discrepancy.methods import Method, MethodSettings
from gaitdisc.discrepancy.record import Conditions, recorded
from gaitdisc.discrepancy.system import System
from gaitdisc.report.table import save_table
from gaitdisc.results.discrepancy_cell import DiscrepancyCell

SEEDS = 12
NOISES = (0.0, 0.001, 0.01, 0.1)
FOUR: tuple[Method, ...] = ("sindy", "dmd", "gp", "nn")
LONG, SHORT = 50.0, 10.0


@dataclass(frozen=True, eq=False)
class CellSet:
    """Cells that stand in one table.

    Parameters
    ----------
    system : System
        What is recorded.
    conditions : Conditions
        Sampling; noise and seed are replaced.
    approach : str
        `dynamics` or `state`.
    methods : tuple of str
        Of every seed.
    noises : tuple of float
        As shares of each channel's standard deviation.
    seeds : int
        Most that are computed.
    settings : MethodSettings, optional
        Of the methods.
    """

    system: System
    conditions: Conditions
    approach: Approach = "dynamics"
    methods: tuple[Method, ...] = FOUR
    noises: tuple[float, ...] = NOISES
    seeds: int = SEEDS
    settings: MethodSettings | None = None


def cell_sets() -> dict[str, CellSet]:
    """Every set by its name, in the order in which they are computed."""
    pol, mass = ch3_van_der_pol.systems(), ch3_measurement_bias.systems()
    text, code, lorenz = pol["text"], pol["code"], ch3_lorenz.system()
    long, short, swing = Conditions(duration_s=LONG), Conditions(duration_s=SHORT), Conditions(duration_s=20.0)
    fine = Conditions(dt_s=ch3_lorenz.FINE_DT_S, duration_s=ch3_lorenz.FINE_S)
    bias = {"approach": "state", "settings": ch3_measurement_bias.SETTINGS}
    found = {
        "van_der_pol_text": CellSet(text, long),
        "lorenz": CellSet(lorenz, long),
        "van_der_pol_code": CellSet(code, long),
        "van_der_pol_text_short": CellSet(text, short, noises=NOISES[1:]),
        "lorenz_short": CellSet(lorenz, short, noises=NOISES[1:]),
        "lorenz_fine": CellSet(lorenz, fine, methods=("sindy", "gp", "nn"), noises=NOISES[:1]),
        "mass_code": CellSet(mass["code"], swing, **bias),
        "mass_text": CellSet(mass["text"], swing, **bias),
        "van_der_pol_text_state": CellSet(text, long, "state"),
        "van_der_pol_code_state": CellSet(code, long, "state"),
        "lorenz_state": CellSet(lorenz, long, "state"),
    }
    return found | {
        f"{name}_bopdmd": replace(found[name], methods=("bopdmd",), seeds=3)
        for name in ("van_der_pol_text", "van_der_pol_code", "lorenz", "mass_code", "mass_text")
    }


def compute(folder: Path, names: list[str], seeds: int) -> None:
    """Compute what is not there yet: all sets of a seed before the next seed.

    Parameters
    ----------
    folder : Path
        A file a cell.
    names : list of str
        Sets.
    seeds : int
        Most of each.
    """
    sets, warm = cell_sets(), set()
    for seed in range(seeds):
        for name in names:
            for cell_set, noise, method in _asked(sets[name], seed):
                path = folder / f"{name}-{noise:g}-{seed:02d}-{method}.csv"
                if path.exists():
                    continue
                if (method, cell_set.approach) not in warm:  # no cell's seconds hold importing and compiling
                    first = recorded(cell_set.system, replace(cell_set.conditions, duration_s=600 * 0.01, dt_s=0.01))
                    cell_of(first, method, cell_set.approach)
                    warm.add((method, cell_set.approach))
                record = recorded(cell_set.system, replace(cell_set.conditions, noise=noise, seed=seed))
                table = rows_of(cell_of(record, method, cell_set.approach, cell_set.settings))
                table.insert(0, "set", name.removesuffix("_bopdmd"))
                save_table(table, path)
                print(path.name, flush=True)


def _asked(cell_set: CellSet, seed: int) -> Iterator[tuple[CellSet, float, Method]]:
    for noise in cell_set.noises:
        for method in cell_set.methods:
            if seed < (cell_set.seeds if noise else 1):  # without noise all seeds are one
                yield cell_set, noise, method


def rows_of(cell: DiscrepancyCell) -> pd.DataFrame:
    """Numbers of a cell, a row a part: medians over the channels, but the worst of them until the first jump.

    Parameters
    ----------
    cell : DiscrepancyCell
        Fitted or refused.
    """
    head = {
        "system": cell.system, "variant": cell.variant, "approach": cell.approach, "method": cell.method,
        "noise": cell.noise, "dt_s": cell.dt_s, "samples": cell.samples, "seed": cell.seed,
        "seconds": cell.fit_s + cell.run_s, "terms": cell.terms, "refused": cell.refused,
    }  # fmt: skip
    rows = [
        head
        | {"part": name, "accuracy": float(np.median(part.accuracy())), "diverged_s": part.diverged_s}
        | {"valid_s": part.valid_s("augmented"), "valid_known_s": part.valid_s("known")}
        | {"to_jump": float(np.min(part.accuracy(until_s=part.first_jump_s())))}
        for name, part in cell.parts.items()
    ]
    return pd.DataFrame(rows or [head | {"part": ""}])


def gathered(folder: Path) -> pd.DataFrame:
    """Every cell of a folder, in order.

    Parameters
    ----------
    folder : Path
        Of `compute`.
    """
    files = sorted(path for path in folder.glob("*.csv") if path.name.rsplit("-", 3)[0].removesuffix("_bopdmd") in cell_sets())
    return pd.concat([pd.read_csv(path, keep_default_na=True) for path in files], ignore_index=True)


if __name__ == "__main__":
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("folder", type=Path, metavar="FOLDER", help="a file for each cell that was computed")
    asked.add_argument("--seeds", type=int, default=SEEDS, help="noise seeds 0 to this less 1 (default: %(default)s)")
    asked.add_argument("--sets", nargs="+", default=list(cell_sets()), choices=list(cell_sets()), metavar="SET",
                       help="of " + ", ".join(cell_sets()))  # fmt: skip
    asked.add_argument("--write-docs", action="store_true", help="compute nothing; write the tables from FOLDER")
    given = asked.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    if given.write_docs:
        save_table(gathered(given.folder), CELLS)
        write_docs()
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compute(given.folder, given.sets, given.seeds)
