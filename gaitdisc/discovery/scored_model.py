"""Models scored and ranked: the information criterion under autocorrelated noise estimated from residuals.

Source: Schwarz 1978, Ann. Stat. 6, 461 (the criterion, BIC); Cochrane and Orcutt 1949, J. Am. Stat. Assoc. 44, 32
(fit, estimate the autocorrelation of the residuals, whiten, fit again); Foster and George 1994, Ann. Stat. 22, 1947
(2 log p for each of p that was selected, the risk inflation criterion).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate import UNNAMED, Candidate
from gaitdisc.discovery.candidate_model import CandidateModel
from gaitdisc.discovery.catalogue import read_shapes
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.noise import Noise, find_noise
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording.arrays import Values

TURNS = 4
INTEGRATED = 1e-4  # of a channel's spread: how far two integrators of one model may be apart
# Where two explanations fit equally well, the simpler statement first.
PREFERENCE = ("wrong_parameter", "input_error", "sensor_error", "missing_physics")


@dataclass(frozen=True)
class ScoredModel:
    """A model fitted under a noise that was estimated from its residuals, or from a better model's."""

    model: CandidateModel
    shooting: Shooting
    gained: float = 0.0  # fall of the criterion against the same without its last explanation, under one noise

    @property
    def bic(self) -> float:
        """Minus twice the log likelihood plus log(N) for each number fitted; the smaller the better.

        Comparable between models of the same segments under the same noise, and only between these.
        """
        return self.model.bic

    @property
    def noise(self) -> Noise:
        """The noise that the model was fitted under."""
        return self.shooting.noise

    @property
    def labels(self) -> tuple[str, ...]:
        """Name and place of each explanation."""
        return tuple(part.candidate.label for part in self.model.parts)

    @property
    def word(self) -> str:
        """The verdict that it is: of what is missing without a name, that; else what kind its first explanation is."""
        candidates = [part.candidate for part in self.model.parts]
        return UNNAMED if any(one.name == UNNAMED for one in candidates) else candidates[0].verdict

    @property
    def verdicts(self) -> tuple[str, ...]:
        """What kind of explanation each is."""
        return tuple(part.candidate.verdict for part in self.model.parts)

    def under(self, other: ScoredModel) -> ScoredModel:
        """Return the model fitted again under another's noise, so that the two can be compared."""
        if other.shooting is self.shooting:
            return self
        return ScoredModel(self.model.refitted(other.shooting, turns=TURNS), other.shooting, self.gained)


def score(shooting: Shooting, model: CandidateModel, rounds: int = 2) -> ScoredModel:
    """Estimate a model's own noise, and its own past for what comes late, and fit it again under them."""
    least = max(INTEGRATED, model.base.inexact) * np.nanstd(shooting.measured.observed, axis=(0, 1))
    for _ in range(rounds):
        used = model.fit.starts.shape[1] / model.fit.residual.shape[2]
        noise = find_noise(model.fit.residual, used, least=least, autocorrelation=shooting.filter_autocorrelation)
        shooting = shooting.with_noise(noise).with_past(model.fit.states)
        model = model.refitted(shooting, turns=TURNS)
    return ScoredModel(model, shooting)


def leaves(now: ScoredModel, noise: Values) -> float:
    """Return the mean square of what a model leaves, over the variance of the sensors' noise.

    noise (channel,): its standard deviation [the channel's unit]
    """
    return float(np.nanmean((now.model.fit.residual / noise) ** 2))


def compared(models: list[ScoredModel]) -> list[ScoredModel]:
    """Put models under one noise: what the best of them leaves.

    models: of the same segments; those under the noise of the first stay as they are
    """
    models = [one.under(models[0]) for one in models]
    for _ in range(len(models)):
        best = min(range(len(models)), key=lambda number: models[number].bic)
        own = replace(score(models[best].shooting, models[best].model), gained=models[best].gained)
        models = [own if number == best else one.under(own) for number, one in enumerate(models)]
        if min(range(len(models)), key=lambda number: models[number].bic) == best:
            break
    return models


def ranked(models: list[ScoredModel], candidates: tuple[Candidate, ...]) -> list[ScoredModel]:
    """Return models, the best first.

    A kind of explanation with many members (a missing term: any shape at any place) is more likely to have one that
    fits by chance than a kind with few (a wrong parameter): each kind is penalised for the number of its
    members. Of what the criterion does not distinguish the simplest statement stands first.
    """
    models = [one for one in models if np.isfinite(one.bic)]
    if not models:
        return models
    members = Counter(verdict for verdict, _ in {(one.verdict, one.label) for one in candidates})

    def penalised(one: ScoredModel) -> float:
        return one.bic + sum(2 * float(np.log(max(members[verdict], 1))) for verdict in one.verdicts)

    models.sort(key=penalised)
    least = min(models, key=lambda one: one.bic)
    fewer = [one for one in models if one.model.size < least.model.size]
    simple = [one for one in fewer if one.bic < least.bic + CRITERIA.margin]
    first = simple[0] if simple else models[0]
    order = {shape.name: number for number, shape in reversed(list(enumerate(read_shapes())))}

    def complexity(one: ScoredModel) -> tuple[list[int], float, list[int]]:
        names = [order.get(part.candidate.name, len(order)) for part in one.model.parts]
        return [PREFERENCE.index(verdict) for verdict in one.verdicts], round(one.model.penalty, 6), names

    tied = [one for one in models if one.model.size == first.model.size]
    first = min((one for one in tied if penalised(one) <= penalised(first) + CRITERIA.tie), key=complexity)
    return [first, *(one for one in models if one is not first)]
