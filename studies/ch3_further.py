"""Chapter 3 beyond its figures, over twelve noise seeds: methods, noise, starts and trajectories that the text names.

    python studies/ch3_further.py [FOLDER] [--seeds 6] [--tables methods noise filters trajectories variance] [--keep]
    python studies/ch3_further.py --print TABLE

Exact DMD, SINDy in weak form and as an ensemble, a Gaussian process with a Matern kernel (`methods`); noise that is not
normal (`noise`); the start of a forecast by unscented and ensemble Kalman filters (`filters`); several trajectories,
and a forecast whose beginning is learned from (`trajectories`); what of the missing rate lies within two standard
deviations of the Gaussian process (`variance`). Each number is a file of its own in FOLDER, written whole: a run that
was stopped goes on. Its tables are printed at the end; with `--keep` FOLDER becomes `studies/ch3_further.csv`, which
`--print` prints from.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from command_line import argument, command_line

TABLES = ("methods", "noise", "filters", "trajectories", "variance")
GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", "a file for each number that was computed", Path("ch3_further")),
    argument("--seeds", "noise seeds 0 to one less than this", 6),
    argument("--tables", "which of them are computed", list(TABLES)),
    argument("--keep", "write studies/ch3_further.csv as well", False),
    argument("--print", "compute nothing; print this table", "", metavar="TABLE"),
)  # before the slow imports

import warnings
from collections.abc import Callable, Iterator
from typing import NamedTuple

import ch3_lorenz
import ch3_van_der_pol
import numpy as np
import pandas as pd
from ch3_cells import LYAPUNOV_PER_S, said_of

from gaitdisc.chapters.discrepancy.augmented_run import with_learned_rates
from gaitdisc.chapters.discrepancy.cell import cell_of, learned_model
from gaitdisc.chapters.discrepancy.discrepancy_cell import FORECAST, PartAccuracy
from gaitdisc.chapters.discrepancy.error_signal import error_samples
from gaitdisc.chapters.discrepancy.filtered_start import filtered_start
from gaitdisc.chapters.discrepancy.forecast_start import forecast_start
from gaitdisc.chapters.discrepancy.methods import MethodSettings
from gaitdisc.chapters.discrepancy.record import Conditions, recorded
from gaitdisc.chapters.discrepancy.record_noise import NOISE_KINDS
from gaitdisc.chapters.discrepancy.system import System
from gaitdisc.chapters.pages import as_markdown, save_table, words_table
from gaitdisc.chapters.pages.discrepancy_figure import METHOD_WORDS
from gaitdisc.chapters.regression.gaussian_process import fit_gaussian_process

CELLS = Path(__file__).with_name("ch3_further.csv")
NOISES = (0.01, 0.1)
SACRIFICED_S = 5.0
SIDES = 1.96  # standard deviations of a normal law's 95 %
HEADINGS = {
    "methods": "forecast [% less RMSE], of Lorenz valid time [Lyapunov times]",
    "noise": "forecast [% less RMSE], of Lorenz valid time [Lyapunov times]",
    "filters": "valid time [Lyapunov times], SINDy",
    "trajectories": "forecast from 5 s on [% less RMSE], state approach",
    "variance": "missing rate within 1.96 SD of the Gaussian process [%]",
}


class Number(NamedTuple):
    """One number of a table: its row, its column's system and noise, and how it is computed from a seed."""

    table: str
    row: str
    system: str
    noise: float
    computed: Callable[[int], float]


def systems() -> dict[str, System]:
    """The text's oscillator, and Lorenz."""
    return {"Van der Pol": ch3_van_der_pol.systems()["text"], "Lorenz": ch3_lorenz.system()}


def score(part: PartAccuracy, system: str) -> float:
    """What a forecast is judged by."""
    if system == "Lorenz":
        return LYAPUNOV_PER_S * part.valid_s("augmented")
    return float(np.median(part.accuracy()))


def numbers(tables: list[str]) -> Iterator[Number]:
    """Every number of the tables."""
    for name, system in systems().items():
        for noise in NOISES:
            if "methods" in tables:
                for method in ("sindy", "esindy", "wsindy", "dmd", "exactdmd", "gp", "gpm"):
                    yield Number("methods", METHOD_WORDS[method], name, noise, of_method(system, name, noise, method))
            if "variance" in tables:
                yield Number("variance", "Gaussian process", name, noise, of_variance(system, noise))
        if "noise" in tables:
            for kind in NOISE_KINDS:
                for method in ("sindy", "gp"):
                    row = f"{METHOD_WORDS[method]}, {kind.replace('_', ' ')}"
                    yield Number("noise", row, name, 0.01, of_method(system, name, 0.01, method, kind=kind))
    for noise in NOISES:
        for start in ("windows", "unscented", "ensemble", "true state (oracle)") if "filters" in tables else ():
            yield Number("filters", start, "Lorenz", noise, of_filter(systems()["Lorenz"], noise, start))
    for count, sacrificed in ((1, 0.0), (4, 0.0), (8, 0.0), (1, SACRIFICED_S)) if "trajectories" in tables else ():
        for method in ("sindy", "gp"):
            row = f"{METHOD_WORDS[method]}, {count} start{'s' * (count > 1)}"
            row += ", first 5 s of the forecast learned from" * bool(sacrificed)
            made = {"trajectories": count, "sacrificed_s": sacrificed}
            yield Number("trajectories", row, "Van der Pol", 0.01, of_trajectories(method, made))


def of_method(system: System, name: str, noise: float, method, **made) -> Callable[[int], float]:
    """Forecast from the estimated start with learned rates."""

    def computed(seed: int) -> float:
        record = recorded(system, Conditions(noise, seed, **made))
        found = cell_of(record, method, "dynamics")
        return score(found.parts[FORECAST], name) if found.parts else float("nan")

    return computed


def of_trajectories(method, made: dict) -> Callable[[int], float]:
    """Forecast with a learned residual, judged after what may be sacrificed."""

    def computed(seed: int) -> float:
        record = recorded(systems()["Van der Pol"], Conditions(0.01, seed, **made))
        part = cell_of(record, method, "state").parts[FORECAST]
        later = part.time >= SACRIFICED_S
        kept = {each: getattr(part, each)[later] for each in ("time", "truth", "known", "augmented")}
        return float(np.median(PartAccuracy(**kept, diverged_s=part.diverged_s).accuracy()))

    return computed


def of_filter(system: System, noise: float, start: str) -> Callable[[int], float]:
    """Valid time of SINDy's forecast from a start."""

    def computed(seed: int) -> float:
        record = recorded(system, Conditions(noise, seed))
        learned = learned_model(record, "sindy", "dynamics", MethodSettings())
        begins = {
            "windows": lambda: forecast_start(record, learned, "dynamics"),
            "unscented": lambda: filtered_start(record, learned, "unscented"),
            "ensemble": lambda: filtered_start(record, learned, "ensemble"),
            "true state (oracle)": lambda: record.start(forecast=True),
        }[start]()
        at = record.time[record.split - 1 :]
        run = with_learned_rates(system.known, learned, begins, at).values
        known = system.known.run(begins[None], record.conditions.dt_s, len(at) - 1)[0]
        return score(PartAccuracy(at - at[0], record.target(forecast=True), known, run, None), "Lorenz")

    return computed


def of_variance(system: System, noise: float) -> Callable[[int], float]:
    """Share of the true missing rate, along the true forecast, within the Gaussian process' own interval."""

    def computed(seed: int) -> float:
        record = recorded(system, Conditions(noise, seed))
        found = fit_gaussian_process(error_samples(record, "dynamics"), variance=True)
        states = record.truth[record.split :: 10]
        missing = system.true(states) - system.known(states)
        which = np.abs(missing).max(axis=0) > 0  # the equation that lacks something
        inside = np.abs(found(states) - missing) <= SIDES * found.sd(states)
        return 100 * float(inside[:, which].mean())

    return computed


def compute(folder: Path, tables: list[str], seeds: int) -> None:
    """Compute what is not there yet, one seed after the other."""
    folder.mkdir(parents=True, exist_ok=True)
    wanted = [(seed, number) for seed in range(seeds) for number in numbers(tables)]
    begun, done = time.monotonic(), 0
    for place, (seed, number) in enumerate(wanted):
        path = folder / f"{number.table}-{number.row}-{number.system}-{number.noise:g}-{seed:02d}.csv"
        if path.exists():
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            row = {"table": number.table, "row": number.row, "system": number.system, "noise": number.noise}
            save_table(pd.DataFrame([row | {"seed": seed, "value": number.computed(seed)}]), path)
        done += 1
        left = (time.monotonic() - begun) / done * (len(wanted) - place - 1)
        print(
            f"{place + 1} of {len(wanted)}, {left / 60:.0f} min left at most: {path.name}", file=sys.stderr, flush=True
        )


def gathered(folder: Path) -> pd.DataFrame:
    """Every number of a folder, in the order of the tables."""
    table = pd.concat([pd.read_csv(path) for path in sorted(folder.glob("*.csv"))], ignore_index=True)
    return table.sort_values(["table", "row", "system", "noise", "seed"], kind="stable", ignore_index=True)


def printed(table: pd.DataFrame, name: str) -> str:
    """One table as documents hold it: median [least, greatest] over the seeds."""
    some, rows = table[table["table"] == name], []
    columns = [
        (str(system), noise)
        for system in ("Van der Pol", "Lorenz")
        for noise in sorted(some.loc[some["system"] == system, "noise"].unique())
    ]
    for row in dict.fromkeys(some["row"]):
        said = []
        for system, noise in columns:
            here = (some["row"] == row) & (some["system"] == system) & (some["noise"] == noise)
            said.append(said_of(some[here], "value"))
        rows.append((row, str(some[some["row"] == row].groupby(["system", "noise"]).size().max()), *said))
    headings = (HEADINGS[name], "n", *(f"{system}, {100 * noise:g} % noise" for system, noise in columns))
    return as_markdown(words_table(name, "", headings, rows))


if __name__ == "__main__":
    if GIVEN.print:
        print(printed(pd.read_csv(CELLS), GIVEN.print))
    else:
        compute(GIVEN.folder, GIVEN.tables, GIVEN.seeds)
        found = gathered(GIVEN.folder)
        print("\n\n".join(printed(found, name) for name in TABLES if name in set(found["table"])))
        if GIVEN.keep:
            save_table(found, CELLS)
