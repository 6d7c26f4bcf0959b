"""What `gaitdisc discover` found: the verdict, the effect with its numbers, its rivals, and how far the gap shrank."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.saved.kind import Saved
from gaitdisc.saved.provenance import Provenance
from gaitdisc.words import as_html

if TYPE_CHECKING:
    import pandas as pd

ALPHA = 0.05  # the greatest rate of false finds, unless a user sets another
VERDICTS = {
    "no_gap": "no gap: nothing is added to the simulation",
    "missing_physics": "missing physics: a term is missing in the dynamics",
    "wrong_parameter": "wrong parameter: the structure is correct, but the value of a parameter is not",
    "input_error": "input error: a driving signal is late or scaled",
    "sensor_error": "sensor error: the state is correct, but its measurement is not",
    "wrong_initial_condition": "wrong initial condition: only the initial state is wrong",
    "process_noise": "process noise: a random input acts on the system",
    "unnamed": "unnamed: a deterministic term is missing, and no known effect explains it",
    "unexplained": "unexplained: the residual exceeds the noise, and no known effect or fitted shape explains it",
}

# log odds that a name is right: where it removes nothing of the gap, and what removing all adds (benchmarks/chances.py)
CHANCE = (0.17, 2.01)
NAMED = ("missing_physics", "wrong_parameter", "input_error", "sensor_error")
SIZES = ("before", "after", "noise_floor")  # of a gap, as its file calls them
ODD_TRIAL = "odd trial"  # kind of the finding about a trial that was left out
# What an answer follows, as its provenance has it
SIMULATION = "discovery of missing physics"
ENGINE = "discovery of missing physics in a model of an engine"
TRACKED = "tracked pass"
DEVICE = "discovery of what a device does"


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval."""

    value: float
    low: float
    high: float
    unit: str = ""


@dataclass(frozen=True)
class FoundEffect:
    """One explanation of the gap."""

    kind: str  # what `place` is: `port`, `equation`, `parameter`, `input`, `observation`, `state`
    place: str
    name: str  # name of the effect, of the catalogue
    term: str  # for a missing term, its expression, in the unit of the place; else what was changed
    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    held_out: float = float("nan")  # share of the gap on held-out data that goes with all that was found
    # fall of the Bayesian criterion from the simulation as read: of what was found, all of it together; of a rival,
    # with it in the place of what it rivals
    bic: float = float("nan")
    tied: bool = False  # for a rival: these data cannot separate it from what was named
    # for a rival, and beside others that were given: it closes too little of the gap to be named, or not beyond chance
    small: bool = False
    # of a wrong parameter: the file's `low` and `high`, infinite where it has but one; empty where it has neither
    bounds: tuple[float, ...] = ()
    # states that the effect brings along, and the time derivative of each
    states: Mapping[str, str] = field(default_factory=dict)
    # of a term without a name that was read as an expression of few pieces: this expression, in a few digits
    reads_as: str = ""
    reads_as_effect: str = ""  # the catalogue's effect that this expression is; empty where it is none


@dataclass(frozen=True)
class Correction:
    """A number of the file that moved within its own bounds; no finding."""

    parameter: str
    given: float
    found: Estimate  # what it was fitted to; the interval lies inside the bounds


@dataclass(frozen=True)
class Whereabouts:
    """Where the gap arises."""

    kind: str
    place: str
    share_of_gap: float  # part of the gap's variance that pushes there explain
    phase: tuple[float, ...] = ()  # from and to, in shares of the stride; empty without a stride
    region: str = ""


@dataclass(frozen=True)
class GapSize:
    """Size of the gap, root mean square over channels of error over the channel's standard deviation."""

    before: float
    after: float
    noise_floor: float  # what the sensors' noise alone would leave
    # chance of so clear a fall of the squared error without any effect (discovery/paired_test.py). Where nothing is
    # named: of what the data that were fitted spoke for most
    p: float = float("nan")
    # for each channel: before, after, noise floor [the channel's unit]
    channels: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    pieces: int = 0  # independent samples that the runs are worth
    # which data these are: `trial 4`, `trial 1, last quarter`; empty where all that was fitted is meant
    of: str = ""
    alpha: float = ALPHA  # the greatest rate of false finds, which p has to be below for a name

    @property
    def ranked(self) -> list[str]:
        """Channels, that with the largest gap against its noise first."""
        return sorted(self.channels, key=lambda name: -self.channels[name][0] / (self.channels[name][2] or 1.0))

    @property
    def unexplained(self) -> float:
        """Share of the variance above the noise floor that is left; 0 where nothing is, 1 where no less is.

        >>> GapSize(before=3.0, after=1.0, noise_floor=1.0).unexplained
        0.0
        """
        floor = self.noise_floor**2
        return min(max(self.after**2 - floor, 0.0) / max(self.before**2 - floor, 1e-12), 1.0)


@dataclass(frozen=True)
class Explanation:
    """An explanation of the whole gap, one effect or several together, and what it leaves of held-out data."""

    effects: tuple[FoundEffect, ...]
    held_out: GapSize | None = None  # None where it was not computed: folders of earlier releases
    # of the first held-out run, for the channel with the largest gap: times [s], and measured minus its run
    time: tuple[float, ...] = ()
    left: tuple[float, ...] = ()

    @property
    def as_given(self) -> str:
        """What `--effects` takes to fit exactly this."""
        return ", ".join(f"{effect.name}@{effect.place}" for effect in self.effects)

    @property
    def tied(self) -> bool:
        """Whether these data cannot distinguish it from what was named."""
        return any(effect.tied for effect in self.effects)


@dataclass(frozen=True)
class ConditionAnswer:
    """What one of several conditions of a study shows against the Nominal one."""

    condition: str  # the study's word
    sentence: str  # the answer, or why there is none
    verdict: str = ""  # empty where the condition was refused
    effects: tuple[FoundEffect, ...] = ()
    beside: Mapping[str, float] = field(default_factory=dict)  # as in the condition's own discovery


@dataclass(frozen=True)
class Twins:
    """Answers of the same search to simulated records that resemble the measured ones.

    >>> Twins(20, "coulomb_friction@air", {"coulomb_friction@air": 19, "no_gap": 1}, {"no_gap": 20}).sentence[44:77]
    'gives the same answer in 19 of 20'
    """

    records: int  # of each kind
    named: str  # the answer that they are compared with: effects at their places, or the verdict
    # answer -> records: simulated with what was found, and without it
    with_effects: Mapping[str, int] = field(default_factory=dict)
    without: Mapping[str, int] = field(default_factory=dict)
    apart: str = ""  # of an answer that is tied with others: which change of the measurement would distinguish them

    @property
    def sentence(self) -> str:
        """How often the answer returns or one is invented, and what would distinguish it from those tied with it."""
        invented = sum(count for answer, count in self.without.items() if "@" in answer)
        clauses = [f"names an effect in {invented} of {self.records} records in which nothing is missing"]
        if self.with_effects:
            same = self.with_effects.get(self.named, 0)
            clauses.insert(0, f"gives the same answer in {same} of {self.records} records with the effect")
        return f"In simulated records like these, the search {', and '.join(clauses)}. {self.apart}".rstrip()


@dataclass(frozen=True)
class Runs:
    """Measured, simulated and augmented runs of one set of trials."""

    trial: NDArray[np.intp]  # (run,), number of the trial
    time: Values  # (run, sample), [s]
    phase: Values  # (run, sample) or empty, share of the stride
    measured: Values  # (run, sample, channel), [the channel's unit]
    simulated: Values  # (run, sample, channel), [the channel's unit]
    augmented: Values  # (run, sample, channel), [the channel's unit]
    names: tuple[str, ...] = ()  # of all trials of the measured data, by their number

    def to_frame(self, channels: tuple[str, ...]) -> pd.DataFrame:
        """Return the runs as a table: run, trial, time, phase, and each channel three times."""
        import pandas as pd

        runs, samples = self.time.shape
        trial = np.asarray(self.names)[self.trial] if self.names else self.trial + 1
        columns = {
            "run": np.repeat(np.arange(1, runs + 1), samples),
            "trial": np.repeat(trial, samples),
            "time": self.time.ravel(),
        }
        if self.phase.size:
            columns["phase"] = self.phase.ravel()
        for number, channel in enumerate(channels):
            for word in ("measured", "simulated", "augmented"):
                columns[f"{channel}_{word}"] = getattr(self, word)[:, :, number].ravel()
        return pd.DataFrame(columns)


NO_GAP = GapSize(0.0, 0.0, 0.0)
_NONE = np.empty((0, 0))
NO_RUNS = Runs(np.zeros(0, int), _NONE, _NONE, _NONE, _NONE, _NONE)


@dataclass(frozen=True)
class Discovery(Saved, file="discovery.json"):
    """The effects that a simulation lacks.

    Parameters
    ----------
    verdict : str
        Kind of the answer, one of the nine words of `VERDICTS`.
    sentence : str
        The answer in one sentence.
    where : tuple of Whereabouts
        Places at which the gap arises, the largest share first.
    effects : tuple of FoundEffect
        Identified effects.
    rivals : tuple of FoundEffect
        Other tested explanations, best first.
    train, held_out : GapSize
        Reduction of the gap on training data and on held-out data.
    channels, units : tuple of str
        Observed channels and their units.
    runs : Runs
        Runs of the held-out trials.
    findings : tuple of Finding
        Findings about the data.
    provenance : Provenance, optional
        Settings, files and versions.
    corrections : tuple of Correction
        Parameters that changed within their bounds.
    beside : mapping of str to float
        For a device walk: name of each model -> its held-out error [unit of the last channel].
    explanations : tuple of Explanation
        The first five explanations of the entire gap (single effects or sets): first the identified one, then those
        that close most of the gap on held-out data.
    conditions : tuple of ConditionAnswer
        Answers for all conditions, if a study has several in addition to Nominal.
    given : str
        For effects that the user specified: ``proven`` or ``refuted`` by held-out data. Empty after a search.
    twins : Twins, optional
        Answers of the same search to simulated records that resemble the measured ones.
    hide : callable, optional
        Function that returns the discovery as it is saved, without words that may name a person.
    """

    verdict: str
    sentence: str
    where: tuple[Whereabouts, ...] = ()
    effects: tuple[FoundEffect, ...] = ()
    rivals: tuple[FoundEffect, ...] = ()
    train: GapSize = NO_GAP
    held_out: GapSize = NO_GAP
    channels: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    runs: Runs = NO_RUNS
    findings: tuple[Finding, ...] = ()
    provenance: Provenance | None = None
    corrections: tuple[Correction, ...] = ()
    beside: Mapping[str, float] = field(default_factory=dict)
    explanations: tuple[Explanation, ...] = ()
    conditions: tuple[ConditionAnswer, ...] = ()
    given: str = ""
    twins: Twins | None = None
    hide: Callable[[Discovery], Discovery] | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Refuse a verdict that the contract does not know."""
        if self.verdict not in VERDICTS:
            raise ValueError(f"verdict must be one of {(*VERDICTS,)}, not {self.verdict!r}")

    @property
    def probability(self) -> float:
        """Probability that what is named, or is tied with it, is right (logistic regression); NaN without a name."""
        searched = self.provenance and self.provenance.section == SIMULATION and not self.given
        odds = CHANCE[0] + CHANCE[1] * (1 - self.held_out.unexplained)
        return 1 / (1 + math.exp(-odds)) if searched and self.verdict in NAMED else math.nan

    @property
    def chance(self) -> str:
        """The probability in a sentence; empty where there is none."""
        tied = ", or one that these data cannot distinguish from it," * any(rival.tied for rival in self.rivals)
        said = f"Estimated probability that this answer{tied} is correct: {100 * self.probability:.0f} %"
        return f"{said} (from tests with known effects)." if self.probability > 0 else ""

    @property
    def public(self) -> Discovery:
        """Return the discovery as it is saved, without names of persons."""
        return self.hide(self) if self.hide else self

    def to_frame(self) -> pd.DataFrame:
        """Held-out runs as a table: run, trial, time [s], and each channel as measured, simulated and augmented."""
        return self.runs.to_frame(self.channels)

    def __repr__(self) -> str:
        return f"Discovery({self.verdict}: {self.sentence})"

    def _repr_html_(self) -> str:
        size = self.held_out
        gap = f"{size.before:.3g} before, {size.after:.3g} after, noise {size.noise_floor:.3g}"
        rows = [("verdict", self.verdict.replace("_", " ")), ("held-out gap", gap)]
        for effect in self.effects:
            amounts = (
                f"{name} {estimate.value:.3g} ({estimate.low:.3g} to {estimate.high:.3g}) {estimate.unit}".strip()
                for name, estimate in effect.estimates.items()
            )
            rows.append((f"{effect.name} at {effect.place}", "; ".join(amounts)))
        return as_html(self.sentence, rows)

    def to_json(self) -> dict[str, Any]:
        """Return the content of `discovery.json`; a number that is not finite is null."""
        conditions = [asdict(row) | {"effects": [*map(_effect, row.effects)]} for row in self.conditions]
        content = {
            "verdict": self.verdict,
            "where": [_place_fields(place) for place in self.where],
            "effects": [_effect(effect) | ({"small": True} if effect.small else {}) for effect in self.effects],
            "corrections": [
                {"parameter": correction.parameter, "from": correction.given, "to": correction.found.value}
                | {"low": correction.found.low, "high": correction.found.high, "unit": correction.found.unit}
                for correction in self.corrections
            ],
            "rivals": [_effect(rival) | {"tied": rival.tied, "small": rival.small} for rival in self.rivals],
            "gap": {"train": _gap(self.train), "held_out": _gap(self.held_out)},
            "explanations": [
                {
                    "effects": [_effect(effect) | {"tied": effect.tied} for effect in explanation.effects],
                    "held_out": _gap(explanation.held_out) if explanation.held_out else None,
                    "left": {"time": explanation.time, "measured_minus_run": explanation.left},
                }
                for explanation in self.explanations
            ],
            **({"given": self.given} if self.given else {}),
            **({"twins": asdict(self.twins)} if self.twins else {}),
            "probability": self.probability,
            "sentence": self.sentence,
            "channels": dict(zip(self.channels, self.units, strict=True)),
            **({"beside": self.beside} if self.beside else {}),
            **({"conditions": conditions} if conditions else {}),
        }
        return _finite(content) | {
            "findings": [asdict(finding) for finding in self.findings],
            "provenance": asdict(self.provenance) if self.provenance else None,
        }


def _place_fields(entry: Whereabouts | FoundEffect) -> dict[str, Any]:
    """Fields of what has a place; its kind is the first key."""
    values = asdict(entry)
    return {values.pop("kind"): values.pop("place")} | values


def _effect(effect: FoundEffect) -> dict[str, Any]:
    values = _place_fields(effect)
    place = {key: values[key] for key in (effect.kind, "name", "term", "estimates")}
    evidence = {"evidence": {"held_out": effect.held_out, "bic": effect.bic}}
    some = {key: values[key] for key in ("bounds", "states") if values[key]}
    if effect.reads_as:
        some["reads_as"] = {"expression": effect.reads_as, "effect": effect.reads_as_effect or None}
    return place | evidence | some


def _gap(size: GapSize) -> dict[str, Any]:
    return {
        **dict(zip(SIZES, (size.before, size.after, size.noise_floor), strict=True)),
        "unexplained": size.unexplained,
        "p": size.p,
        "pieces": size.pieces,
        "alpha": size.alpha,
        **({"of": size.of} if size.of else {}),
        "channels": {name: dict(zip(SIZES, sizes, strict=True)) for name, sizes in size.channels.items()},
    }


def _finite(value: Any) -> Any:
    """Return what JSON knows: lists, and null in the place of a number that is not finite."""
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float):
        return float(value) if np.isfinite(value) else None
    return value
