"""The search: every explanation is scored to first order, the best are fitted and compared under one noise."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.discovery.candidate import PASSIVE, Candidate
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.grids import Rhythm
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.score import Score, Scorer
from gaitdisc.discovery.scored_model import Explanations, Part, ScoredModel, compared
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.simulation import Simulation

REFITTED = 18
MOST_COMPARED = 5
LIMITS = {"phases": (-np.inf, np.inf), "phase widths": (0.0, 1.0)}
VANISHING = ("half widths of x", "delays")  # constants at whose zero a shape is a simpler one
VISITED = (0.01, 0.99)  # quantiles of a state between which a threshold has a meaning
TURNS = 15
FEW_TURNS = 4
DECADES = (0.1, 0.3, 3.0, 10.0)  # of the file's value, where a number without bounds is sought as well
NEARLY = 0.5  # off the misfit: too little to distinguish explanations by
EVERY = 5.0  # seconds between two lines about a round that lasts


@dataclass(frozen=True)
class Search:
    """What is searched, and in what."""

    base: Simulation
    places: tuple[Place, ...]
    candidates: tuple[Candidate, ...]
    rhythm: Rhythm
    guess: Values = field(compare=False)  # (trial, sample, state), states of the record, roughly
    progress: Callable[[str], None] = field(default_factory=lambda: lambda _: None, compare=False)

    def extended(self, current: ScoredModel) -> list[ScoredModel]:
        """Return the model and others with one explanation more, under the noise of the best; nothing if none fits."""
        penalty = float(np.log(current.fit.white.size))

        def price(score: Score) -> float:
            """By how much the criterion would rise, to first order."""
            return penalty * len(score.candidate.slots) - score.gain

        scores = self.scorer(current).scores(self.open_beside(current))
        worth = sorted((score for score in scores if price(score) < 0), key=price)[:REFITTED]
        fitted = [self.with_part(current, score) for score in self._report(worth)]
        fitted = [model for model in fitted if self.sensible(model) and is_certain(model, -1)]
        fitted += [] if current.parts else self.far_off(current)
        likeliest: dict[Explanations, ScoredModel] = {}
        for model in sorted(fitted, key=lambda model: model.bic):
            likeliest.setdefault(model.explanations, model)
        if not likeliest:
            return []
        before, *longer = compared([current, *[*likeliest.values()][:MOST_COMPARED]])
        return [before, *(replace(model, gained=before.bic - model.bic) for model in longer)]

    def with_part(self, fit: ScoredModel, part: Part, turns: int = TURNS, starts: Values | None = None) -> ScoredModel:
        """Fit a model with one explanation more to the same runs."""
        return fit.refitted(fit.shooting, (*fit.parts, part), starts, turns, NEARLY)

    def far_off(self, current: ScoredModel) -> list[ScoredModel]:
        """Fit numbers without bounds, and limits of a force along the record: slopes at the file's reach neither."""
        fitted, segments = [], current.shooting.segments
        for candidate in self.open_beside(current):
            begun, starts = list[dict[str, float]](), None
            if candidate.verdict == "wrong_parameter" and not candidate.bounds and candidate.value:
                begun = [{"value": candidate.value * factor} for factor in DECADES]
            elif candidate.name == "force_saturation":
                recorded, starts = replace(current.fit, states=segments.of(self.guess)), segments.starts(self.guess)
                begun = self.scorer(replace(current, fit=recorded)).beginnings(candidate)
            tried = [self.with_part(current, Part(candidate, values), FEW_TURNS, starts) for values in begun]
            best = min(tried, key=lambda model: np.nan_to_num(model.fit.misfit, nan=np.inf), default=current)
            if best.fit.misfit < current.fit.misfit:
                fitted.append(current.refitted(current.shooting, best.parts, best.fit.starts, TURNS, NEARLY))
        return fitted

    def _report(self, worth: list[Score]) -> Iterator[Score]:
        """Yield each in turn, and say now and then how many are fitted and how long the others will take."""
        began = last = time.perf_counter()
        for done, score in enumerate(worth):
            now = time.perf_counter()
            if done and now - last >= EVERY:
                wait_s = (now - began) / done * (len(worth) - done)
                self.progress(f"{done} of {len(worth)} explanations fitted; about {wait_s:.0f} s remain in this round")
                last = now
            yield score

    def scorer(self, model: ScoredModel) -> Scorer:
        """Return what scores further explanations beside a model, to first order."""
        return Scorer(model, self.places, self.rhythm)

    def open_beside(self, model: ScoredModel) -> tuple[Candidate, ...]:
        """Return the explanations that are not in a model."""
        present = model.explanations
        return tuple(candidate for candidate in self.candidates if candidate.identity not in present)

    def sensible(self, model: ScoredModel) -> bool:
        """Whether every number of a model lies where it means what its name says."""
        return bool(np.isfinite(model.fit.misfit)) and all(low < x < high for x, (low, high) in self._limits(model))

    def shows(self, model: ScoredModel) -> bool:
        """Whether each relaxation is shorter than the longest trial, each yield narrower than what a run can show."""
        return all(
            part.values[slot] < (self.rhythm.duration if kind == "delays" else self._widest(model, part.candidate.role))
            for part in model.parts
            if part.candidate.states
            for slot, kind in (part.candidate.constants or {}).items()
        )

    def _limits(self, model: ScoredModel) -> Iterator[tuple[float, tuple[float, float]]]:
        """Yield each constant of a model, and between which limits it means what its name says."""
        lagging = {part.candidate.place for part in model.parts if part.candidate.name == "input_lag"}
        for part in model.parts:
            bound = part.candidate.kind != "input"  # of which a limit that it never reaches does nothing anyway
            for slot, kind in (part.candidate.constants or {}).items() if bound else ():
                if kind == "quantiles of x":
                    yield part.values[slot], self._visited(model, part.candidate.role)
                elif kind == "half widths of x":
                    along = self.along(model, part.candidate.role).reshape(model.fit.states.shape[:2])
                    step = float(np.sqrt(np.nanmean(np.diff(along, axis=1) ** 2)))  # yielding within is dry friction
                    least = step if part.candidate.states else 0.0
                    yield part.values[slot], (least, self._widest(model, part.candidate.role))
                elif kind == "delays":
                    yield part.values[slot], (1 / self.rhythm.rate, self.rhythm.period)
                elif kind == "frequencies":  # what does not return within a trial is not seen to be periodic
                    yield part.values[slot], (2 * np.pi / self.rhythm.duration, np.inf)
                else:
                    yield part.values[slot], LIMITS[kind]
            if part.candidate.bounds:
                yield part.candidate.beyond_bounds(part.values["value"]), (0.0, np.inf)
            if part.candidate.name in PASSIVE and part.candidate.power:
                yield part.candidate.power * part.values["factor"], (-np.inf, 0.0)
            if part.candidate.is_late:  # a signal that lags is not early as well: the two would cancel
                early = part.candidate.name == "input_delay" and part.candidate.place not in lagging
                yield part.values["seconds"], (-self.rhythm.period * early, self.rhythm.period)

    def _visited(self, model: ScoredModel, role: str) -> tuple[float, float]:
        """Return where the run goes: a threshold beyond makes a one-sided spring a linear one, or nothing."""
        low, high = np.quantile(self.along(model, role), VISITED)
        return float(low), float(high)

    def along(self, model: ScoredModel, role: str) -> Values:
        """Return what stands for x in an explanation, along the runs."""
        known = len(self.base.states)
        states = model.fit.states[..., :known].reshape(-1, known)
        nothing = np.zeros((len(states), len(self.base.inputs)))
        return np.asarray(evaluate(self.base, role, Points(np.zeros(len(states)), states, nothing)))

    def _widest(self, model: ScoredModel, role: str) -> float:
        """Return the half width that a run can show; of an input, one that it never reaches does nothing anyway."""
        driven = any(signal.name == role for signal in self.base.inputs)
        return np.inf if driven else CRITERIA.widest * max(map(abs, self._visited(model, role)))

    def without(self, model: ScoredModel, number: int) -> ScoredModel:
        """Return the model less one explanation."""
        return self.with_others(model, model.parts[:number] + model.parts[number + 1 :])

    def with_others(self, model: ScoredModel, parts: tuple[Part, ...]) -> ScoredModel:
        """Return the simulation with other explanations, fitted to the runs of a model under its noise."""
        return model.refitted(model.shooting, parts, turns=TURNS)


def is_certain(model: ScoredModel, first: int = 0, end: int | None = None) -> bool:
    """Whether no explanation from `first` to before `end` may be idle; with bounds, a wrong number is at the nearer."""
    variance = np.diag(model.fit.covariance)
    error = np.sqrt(np.where(variance >= 0, variance, np.inf))  # rounding makes that of what is not determined negative
    errors = dict(zip(model.fit.free, error, strict=True))
    return all(
        (part.candidate.beyond_bounds(part.values[slot]) if part.candidate.bounds else abs(part.values[slot] - none))
        > CRITERIA.certain * errors[names[slot]]
        for part, names in list(zip(model.parts, model.names, strict=True))[first:end]
        if len(part.candidate.idle) == 1
        for slot, none in part.candidate.idle.items()
    )


def may_vanish(model: ScoredModel, number: int) -> bool:
    """Whether a constant of an explanation could as well be 0, where the shape is a simpler one."""
    part, names = model.parts[number], model.names[number]
    variance = dict(zip(model.fit.free, np.diag(model.fit.covariance), strict=True))
    return any(
        not part.values[slot] ** 2 > CRITERIA.certain**2 * variance[names[slot]]
        for slot, kind in (part.candidate.constants or {}).items()
        if kind in VANISHING
    )
