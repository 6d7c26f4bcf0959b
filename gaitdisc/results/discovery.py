"""What `gaitdisc discover` found: the verdict, the effect with its numbers, its rivals, and how far the gap shrank."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Finding

VERDICTS = (
    "no_gap",
    "missing_physics",
    "wrong_parameter",
    "input_error",
    "sensor_error",
    "wrong_initial_condition",
    "process_noise",
    "unnamed",
)


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval.

    Parameters
    ----------
    value, low, high : float
        In `unit`.
    unit : str
        Empty where it has none.
    """

    value: float
    low: float
    high: float
    unit: str = ""


@dataclass(frozen=True)
class FoundEffect:
    """One explanation of the gap.

    Parameters
    ----------
    kind : str
        What `place` is: `port`, `equation`, `parameter`, `input`, `observation`, `state`.
    place : str
        Its name in the simulation file.
    name : str
        Name of the effect, of the catalogue.
    term : str
        For a missing term, its expression, in the unit of the place; else what was changed.
    estimates : mapping of str to Estimate
        Its numbers.
    held_out : float
        Share of the gap on held-out data that goes when it is let in.
    bic : float
        Fall of the Bayesian criterion when it is let in.
    tied : bool
        For a rival: the data cannot tell it from what was named.
    """

    kind: str
    place: str
    name: str
    term: str
    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    held_out: float = float("nan")
    bic: float = float("nan")
    tied: bool = False


@dataclass(frozen=True)
class Whereabouts:
    """Where the gap arises.

    Parameters
    ----------
    kind, place : str
        A port or an equation.
    share_of_gap : float
        Part of the gap's variance that pushes there account for.
    phase : tuple of float
        From and to, in shares of the stride; empty without a stride.
    region : str
        In which states, in words.
    """

    kind: str
    place: str
    share_of_gap: float
    phase: tuple[float, ...] = ()
    region: str = ""


@dataclass(frozen=True)
class GapSize:
    """Size of the gap, root mean square over channels of error over the channel's standard deviation.

    Parameters
    ----------
    before, after : float
        Without and with what was found.
    noise_floor : float
        What noise alone would leave.
    p : float
        Chance of so great a fall without any effect (sign flips of the runs' gains).
    channels : mapping of str to tuple of float
        For each channel: before, after, noise floor [the channel's unit].
    """

    before: float
    after: float
    noise_floor: float
    p: float = float("nan")
    channels: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Runs:
    """Measured, simulated and augmented runs of one set of trials.

    Parameters
    ----------
    trial : ndarray of int (run,)
        Number of the trial.
    time : ndarray (run, sample)
        [s].
    phase : ndarray (run, sample) or empty
        Share of the stride.
    measured, simulated, augmented : ndarray (run, sample, channel)
        [the channel's unit].
    """

    trial: NDArray[np.intp]
    time: NDArray[np.float64]
    phase: NDArray[np.float64]
    measured: NDArray[np.float64]
    simulated: NDArray[np.float64]
    augmented: NDArray[np.float64]


@dataclass(frozen=True)
class Discovery:
    """The answer to one inquiry.

    Parameters
    ----------
    verdict : str
        One of eight.
    sentence : str
        The answer, for a person.
    where : tuple of Whereabouts
        Where the gap arises, the greatest share first.
    effects : tuple of FoundEffect
        What was found.
    rivals : tuple of FoundEffect
        What else was weighed, best first.
    train, held_out : GapSize
        How far the gap shrank on data that were fitted, and on data that were not.
    channels, units : tuple of str
        Observed channels and their units.
    runs : Runs
        Of the held-out trials.
    findings : tuple of Finding
        What the reader must know of the data.
    settings : mapping
        What was asked.
    """

    verdict: str
    sentence: str
    where: tuple[Whereabouts, ...]
    effects: tuple[FoundEffect, ...]
    rivals: tuple[FoundEffect, ...]
    train: GapSize
    held_out: GapSize
    channels: tuple[str, ...]
    units: tuple[str, ...]
    runs: Runs
    findings: tuple[Finding, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse a verdict that the contract does not know."""
        if self.verdict not in VERDICTS:
            raise ValueError(f"verdict is one of {VERDICTS}, not {self.verdict!r}")

    def to_json(self) -> dict[str, Any]:
        """Return what `discovery.json` holds."""
        return {
            "verdict": self.verdict,
            "sentence": self.sentence,
            "where": [_place(one) | {"share_of_gap": one.share_of_gap, "phase": list(one.phase), "region": one.region} for one in self.where],
            "effects": [_effect(one) for one in self.effects],
            "rivals": [_effect(one) | {"tied": one.tied} for one in self.rivals],
            "gap": {"train": _gap(self.train), "held_out": _gap(self.held_out)},
            "findings": [one.line() for one in self.findings],
            "settings": dict(self.settings),
        }


def _place(one: Whereabouts | FoundEffect) -> dict[str, str]:
    return {one.kind: one.place}


def _effect(one: FoundEffect) -> dict[str, Any]:
    estimates = {
        name: {"value": each.value, "low": each.low, "high": each.high, "unit": each.unit}
        for name, each in one.estimates.items()
    }
    evidence = {"held_out": _number(one.held_out), "bic": _number(one.bic)}
    return _place(one) | {"name": one.name, "term": one.term, "estimates": estimates, "evidence": evidence}


def _gap(one: GapSize) -> dict[str, Any]:
    channels = {name: dict(zip(("before", "after", "noise_floor"), sizes, strict=True)) for name, sizes in one.channels.items()}
    return {
        "before": _number(one.before),
        "after": _number(one.after),
        "noise_floor": _number(one.noise_floor),
        "p": _number(one.p),
        "channels": channels,
    }


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
