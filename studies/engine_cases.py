"""Cases of the studies of engines: their records with noise, what `discover` names, what that costs, and the sums."""

from __future__ import annotations

import resource
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

import gaitdisc as gd
from gaitdisc.discovery.discover_engine import discover_model_file
from gaitdisc.engines.engine import Engine, read_model
from gaitdisc.engines.mapping import draft
from gaitdisc.engines.motion import Motion

RATE_HZ, SECONDS, TRIALS, CUTOFF_HZ = 100.0, 4.0, 4, 6.0


class Model(NamedTuple):
    """A model that something is hidden in: at which joint, in which body, how strongly it is driven."""

    file: str
    joint: str
    body: str
    sizes: tuple[float, ...]
    offset: float = 0.0  # of the controls: excitations of muscles are not negative
    strength: float = 1.0  # of what is hidden at the joint


class Case(NamedTuple):
    """A model with something hidden in it: text of the truth, and what the answer is to name with which number."""

    model: Model
    kind: str
    truth: str
    number: float
    named: tuple[str, str, str]  # effect, place, estimate


def ran(engine: Engine, start: NDArray[np.float64], u: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles in degrees of a run of the engine from rest (sample, coordinate)."""
    run = engine.run(Motion(start, np.zeros_like(start), u[:1]), u[None], RATE_HZ)[0]
    return np.rad2deg(run[:, : start.shape[1]])


def measured(
    engine: Engine, u: NDArray[np.float64], angles: NDArray[np.float64], noise_deg: float, rng: np.random.Generator
) -> pd.DataFrame:
    """Controls and noisy, low-passed angles of a trial."""
    low_pass = butter(2, CUTOFF_HZ, fs=RATE_HZ, output="sos")
    passed = sosfiltfilt(low_pass, np.random.default_rng(0).normal(size=20_000)).std()
    seen = sosfiltfilt(low_pass, angles + noise_deg / passed * rng.normal(size=angles.shape), axis=0)
    names = [one.name for one in (*engine.controls, *engine.coordinates)]
    return pd.DataFrame({"time": np.arange(len(u)) / RATE_HZ} | dict(zip(names, np.hstack([u, seen]).T, strict=True)))


def written(tables: list[pd.DataFrame], folder: Path) -> Path:
    """Write the table of all trials."""
    whole = pd.concat([one.assign(trial=number) for number, one in enumerate(tables, 1)])
    whole.to_csv(folder / "trial.csv", index=False, float_format="%.7g")
    return folder / "trial.csv"


def sines(rng: np.random.Generator, t: NDArray[np.float64], size: float) -> NDArray[np.float64]:
    """Sum of four sines."""
    frequencies, phases = rng.uniform(0.4, 1.6, 4), rng.uniform(0, 2 * np.pi, 4)
    return size * (rng.uniform(0.3, 1.0, 4) * np.sin(2 * np.pi * np.outer(t, frequencies) + phases)).sum(axis=1)


def searched(case: Case, model: Path, table: Path) -> dict[str, object]:
    """One line of the table, with what it cost: `discover` on a copy of the model beside the record."""
    copy, before, text = table.parent / model.name, cpu_s(), model.read_text(encoding="utf-8")
    copy.write_text(text, encoding="utf-8")
    gd.write_simulation(draft(read_model(copy), degrees=True), copy.with_suffix(".toml"))
    answer = discover_model_file(copy, table)
    found, seconds = answer.found, cpu_s() - before  # the engine's own process has ended
    named = ", ".join(f"{one.name} at {one.place}" for one in found.effects) or found.verdict
    row: dict[str, object] = {"hidden": case.kind, "named": named}
    if case.kind == "none":
        row["right"] = not found.effects
    else:
        name, place, number = case.named
        ours = [one for one in found.effects if (one.name, one.place) == (name, place)]
        row["right"] = len(ours) == 1 and len(found.effects) == 1
        estimate = ours[0].estimates.get(number) if ours else None
        if estimate is not None:
            interval = f"{estimate.value:.4g} ({estimate.low:.4g} to {estimate.high:.4g})"
            row |= {"true": case.number, "found": interval, "inside": estimate.low <= case.number <= estimate.high}
    row["tied"] = sum(one.tied for one in found.rivals)
    row["floor"] = " ".join(f"{size[2]:.3g}" for size in found.held_out.channels.values())
    row["native"] = sum("is written into" in note for note in answer.written.notes)
    return row | {"cpu s": round(seconds, 1)}


def cpu_s() -> float:
    """Processor time of this process and of those that have ended."""
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def study(names: Sequence[str], kinds: Sequence[str], made: Callable[..., tuple[Case, Path, Path]]) -> pd.DataFrame:
    """Every case, as rows; `made` takes the names of model and kind and a folder, and gives case, model and record."""
    rows = []
    for name in names:
        for kind in kinds:
            with tempfile.TemporaryDirectory() as folder:
                case, model, table = made(name, kind, Path(folder))
                rows.append({"model": name, **searched(case, model, table)})
            print("; ".join(f"{key} {value}" for key, value in rows[-1].items()), flush=True)
    return pd.DataFrame(rows)


def print_sums(table: pd.DataFrame) -> None:
    """Print the sums of the cases, model by model."""
    for name, rows in table.groupby("model"):
        hidden = rows[rows["hidden"] != "none"]
        inside = hidden["inside"].dropna() if "inside" in hidden else []
        invented = rows[(rows["hidden"] == "none") & ~rows["right"].astype(bool)]
        print(
            f"{name}: name and place right in {int(hidden['right'].sum())} of {len(hidden)}, interval holds the number "
            f"in {int(sum(inside))} of {len(inside)}, invented {len(invented)}, "
            f"processor time {rows['cpu s'].median():.0f} s a case (median)"
        )
