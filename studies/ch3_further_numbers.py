"""Numbers of chapter 3 beyond its figures, each computed from a noise seed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from ch3_systems import biased_masses, lorenz, oscillators
from chapter3.augmented_run import with_learned_rates
from chapter3.biased_sensor import filter_numbers
from chapter3.cell import FORECAST, PartAccuracy, cell_of, learned_model
from chapter3.gaussian_process import fit_gaussian_process
from chapter3.kept_cells import LYAPUNOV_PER_S
from chapter3.methods import MethodSettings
from chapter3.pages import METHOD_WORDS
from chapter3.record import NOISE_KINDS, Conditions, System, error_samples, recorded
from chapter3.starts import filtered_start, forecast_start

NOISES = (0.01, 0.1)
SACRIFICED_S = 5.0
SIDES = 1.96  # standard deviations of a normal law's 95 %


class Number(NamedTuple):
    """One number of a table: its row, its column's system and noise, and how it is computed from a seed."""

    table: str
    row: str
    system: str
    noise: float
    computed: Callable[[int], float]


def systems() -> dict[str, System]:
    """The text's oscillator, and Lorenz."""
    return {"Van der Pol": oscillators()["text"], "Lorenz": lorenz()}


def score(part: PartAccuracy, system: str) -> float:
    """What a forecast is compared with."""
    chaotic = system == "Lorenz"
    return LYAPUNOV_PER_S * part.valid_s("augmented") if chaotic else float(np.median(part.accuracy()))


def numbers(tables: list[str]) -> Iterator[Number]:
    """Every number of the tables."""
    for name, system in systems().items():
        for noise in NOISES:
            if "methods" in tables:
                for method in ("sindy", "esindy", "wsindy", "dmd", "exactdmd", "gp", "gpm"):
                    made = partial(of_method, system, name, noise, method)
                    yield Number("methods", METHOD_WORDS[method], name, noise, made)
            if "variance" in tables:
                yield Number("variance", "Gaussian process", name, noise, partial(of_variance, system, noise))
        if "noise" in tables:
            for kind in NOISE_KINDS:
                for method in ("sindy", "gp"):
                    row = f"{METHOD_WORDS[method]}, {kind.replace('_', ' ')}"
                    yield Number("noise", row, name, 0.01, partial(of_method, system, name, 0.01, method, kind=kind))
    for noise in NOISES:
        for start in ("windows", "unscented", "ensemble", "true state (oracle)") if "filters" in tables else ():
            yield Number("filters", start, "Lorenz", noise, partial(of_filter, systems()["Lorenz"], noise, start))
    yield from (Number("gain", *each) for each in filter_numbers(biased_masses(), "gain" in tables))
    for count, sacrificed in ((1, 0.0), (4, 0.0), (8, 0.0), (1, SACRIFICED_S)) if "trajectories" in tables else ():
        for method in ("sindy", "gp"):
            row = f"{METHOD_WORDS[method]}, {count} start{'s' * (count > 1)}"
            row += ", first 5 s of the forecast learned from" * bool(sacrificed)
            made = {"trajectories": count, "sacrificed_s": sacrificed}
            yield Number("trajectories", row, "Van der Pol", 0.01, partial(of_trajectories, method, made))


def of_method(system: System, name: str, noise: float, method, seed: int, **made) -> float:
    """Forecast from the estimated start with learned rates."""
    record = recorded(system, Conditions(noise, seed, **made))
    found = cell_of(record, method, "dynamics")
    return score(found.parts[FORECAST], name) if found.parts else float("nan")


def of_trajectories(method, made: dict, seed: int) -> float:
    """Forecast with a learned residual, tested after what may be sacrificed."""
    record = recorded(systems()["Van der Pol"], Conditions(0.01, seed, **made))
    part = cell_of(record, method, "state").parts[FORECAST]
    later = part.time >= SACRIFICED_S
    kept = {each: getattr(part, each)[later] for each in ("time", "truth", "known", "augmented")}
    return float(np.median(PartAccuracy(**kept, diverged_s=part.diverged_s).accuracy()))


def of_filter(system: System, noise: float, start: str, seed: int) -> float:
    """Valid time of SINDy's forecast from a start."""
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


def of_variance(system: System, noise: float, seed: int) -> float:
    """Share of the true missing rate, along the true forecast, within the Gaussian process' own interval."""
    record = recorded(system, Conditions(noise, seed))
    found = fit_gaussian_process(error_samples(record, "dynamics"), variance=True)
    states = record.truth[record.split :: 10]
    missing = system.true(states) - system.known(states)
    which = np.abs(missing).max(axis=0) > 0  # the equation that lacks something
    inside = np.abs(found(states) - missing) <= SIDES * found.sd(states)
    return 100 * float(inside[:, which].mean())
