"""Numbers of chapter 3 beyond its figures, each computed from a noise seed; Kalman filters with a sensor's bias."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np
from ch3_systems import biased_masses, lorenz, oscillators
from numpy.typing import NDArray
from scipy.optimize import least_squares

from .augmented_run import with_learned_rates
from .cell import FORECAST, NOISES, PartAccuracy, cell_of, learned_model
from .gaussian_process import fit_gaussian_process
from .kept_cells import LYAPUNOV_PER_S
from .methods import MethodSettings
from .pages import METHOD_WORDS
from .record import NOISE_KINDS, Conditions, Record, System, error_samples, recorded
from .starts import PROCESS_NOISE, Step, Uncertainty, filtered_start, forecast_start, unscented_kalman

ORACLE = "true start and noise (oracle)"
FILTERS = ("unscented, gain", f"unscented, gain, {ORACLE}", f"linear, offset, {ORACLE}")
OFF = "gain found, off in its SD"
FITTED = 500  # samples, to which an unknown start is fitted before the filter begins
NOISY = NOISES[2:]  # 1 % and 10 %
SACRIFICED_S = 5.0
SIDES = 1.96  # standard deviations of a normal law's 95 %


def filter_numbers(systems: Mapping[str, System], wanted: bool) -> Iterator[tuple]:
    """Every filter's numbers, each with its row, its gain and noise, and how it is computed from a seed."""
    for system, noise, name in product(systems.values() if wanted else (), NOISES[1:], FILTERS):
        for row, gain in (("less error", False), (OFF, True))[: 1 + name.startswith("unscented")]:
            column = f"gain {system.observation[0, 0]:g}"
            yield f"{name}: {row}", column, noise, partial(of_biased_filter, system, noise, name, gain)


def of_biased_filter(system: System, noise: float, name: str, gain: bool, seed: int) -> float:
    """How much less error a filter's forecast has [%], or how far off its gain is in its own standard deviation."""
    record = recorded(system, Conditions(noise, seed, duration_s=20.0))
    end, sd = filtered(record, name)
    return float((1 + end[2] - system.observation[0, 0]) / sd) if gain else forecast_gain(record, name, end)


def model_of(record: Record, name: str) -> tuple[Step, Step]:
    """A step of position, speed and bias, and what is measured of them: with a gain, or linear with an offset."""

    def turn(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack([record.system.known.run(points[:, :2], record.conditions.dt_s, 1)[:, 1], points[:, 2]])

    if name.startswith("unscented"):
        return turn, lambda points: (1 + points[:, 2]) * points[:, 0]
    slopes = np.column_stack([(turn(np.eye(3)[[k]] * 1e-4) - turn(np.zeros((1, 3))))[0] / 1e-4 for k in range(3)])
    return lambda points: points @ slopes.T, lambda points: points[:, 0] + points[:, 2]


def filtered(record: Record, name: str) -> tuple[NDArray[np.float64], float]:
    """Position, speed and bias at the end of the training part, and the standard deviation of the bias.

    Where neither start nor noise is known, both are fitted with the bias to the first five seconds, and the filter
    begins there with the covariance of the fit; noise is what smoothing takes away, the likeliest of five the process
    noise.
    """
    turn, seen = model_of(record, name)
    y, smooth = record.measured[: record.split, 0], np.asarray(record.filtered)[:, 0]
    if name.endswith(ORACLE):
        sd = max(float(np.std(record.measured[:, 0] - record.truth @ record.system.observation[0])), 1e-6)
        step = np.full(3, 1e-6) if name.startswith("unscented") else np.array([1e-5, 1e-4, 2e-4])  # it follows a gain
        begun, noise = np.array([*record.system.start, 0.0]), Uncertainty(np.array([1e-6, 1e-6, 0.2]), step, sd)
        found = unscented_kalman(turn, seen, y, begun, noise)
        return found.states[-1], float(found.sd[-1, 2])

    def ran(first: NDArray[np.float64]) -> NDArray[np.float64]:
        states = record.system.known.run(first[None, :2], record.conditions.dt_s, FITTED)[0]
        return np.column_stack([states, np.full(len(states), first[2])])

    sd, size = max(float((y - smooth).std()), 1e-6), float(np.abs(smooth).max())
    first = np.array([smooth[0], np.gradient(smooth, record.conditions.dt_s)[:20].mean(), 0.0])
    fit = least_squares(lambda x: (seen(ran(x)) - y[: FITTED + 1]) / sd, first, x_scale=[size, size, 0.1])
    slopes = np.column_stack([(ran(fit.x + 1e-6 * axis)[-1] - ran(fit.x)[-1]) / 1e-6 for axis in np.eye(3)])
    covariance = slopes @ np.linalg.inv(fit.jac.T @ fit.jac) @ slopes.T
    step = y.std() * np.sqrt(record.conditions.dt_s) * np.array([1.0, 1.0, 0.0])
    tried = [
        unscented_kalman(turn, seen, y[FITTED:], ran(fit.x)[-1], Uncertainty(covariance, share * step, sd))
        for share in PROCESS_NOISE
    ]
    found = max(tried, key=lambda each: each.likelihood)
    return found.states[-1], float(found.sd[-1, 2])


def forecast_gain(record: Record, name: str, end: NDArray[np.float64]) -> float:
    """How much less error the forecast of what is measured has than the known model's from the true state [%]."""
    turn, seen = model_of(record, name)
    truth, points = record.target(forecast=True)[:, 0], [end]
    while len(points) < len(truth):
        points.append(turn(points[-1][None])[0])
    known = record.system.known.run(record.start(forecast=True)[None], record.conditions.dt_s, len(truth) - 1)[0, :, 0]
    left, before = (float(np.sqrt(np.mean((each - truth) ** 2))) for each in (seen(np.array(points)), known))
    return 100 * (1 - left / before)


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
        for noise in NOISY:
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
    for noise in NOISY:
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
