"""A candidate model scored: its information criterion under autocorrelated noise estimated from its residuals.

Source: Schwarz 1978, Ann. Stat. 6, 461 (the criterion, BIC); Cochrane and Orcutt 1949, J. Am. Stat. Assoc. 44, 32
(fit, estimate the autocorrelation of the residuals, whiten, fit again).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate_model import CandidateModel, fit_model
from gaitdisc.discovery.noise import Noise, noise_of
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.discovery.unnamed_terms import NAME as UNNAMED
from gaitdisc.simulation.simulation import Simulation

TURNS = 4
INTEGRATED = 1e-4  # of a channel's spread: how far two integrators of one model may be apart


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

    def under(self, other: ScoredModel, base: Simulation) -> ScoredModel:
        """Return the model fitted again under another's noise, so that the two can be compared."""
        if other.shooting is self.shooting:
            return self
        model = fit_model(other.shooting, base, self.model.parts, self.model.fit.starts, TURNS, like=self.model)
        return ScoredModel(model, other.shooting, self.gained)


def scored(shooting: Shooting, base: Simulation, model: CandidateModel, rounds: int = 2) -> ScoredModel:
    """Estimate a model's own noise, and its own past for what comes late, and fit it again under them."""
    least = max(INTEGRATED, base.inexact) * np.nanstd(shooting.measured.observed, axis=(0, 1))
    for _ in range(rounds):
        used = model.fit.starts.shape[1] / model.fit.residual.shape[2]
        noise = noise_of(model.fit.residual, used, least=least, autocorrelation=shooting.filter_autocorrelation)
        shooting = shooting.with_noise(noise).with_past(model.fit.states)
        model = fit_model(shooting, base, model.parts, model.fit.starts, TURNS, like=model)
    return ScoredModel(model, shooting)


def compared(models: list[ScoredModel], base: Simulation) -> list[ScoredModel]:
    """Put models under one noise: what the best of them leaves.

    models: of the same segments; those under the noise of the first stay as they are
    """
    models = [one.under(models[0], base) for one in models]
    for _ in range(len(models)):
        best = min(range(len(models)), key=lambda number: models[number].bic)
        own = replace(scored(models[best].shooting, base, models[best].model), gained=models[best].gained)
        models = [own if number == best else one.under(own, base) for number, one in enumerate(models)]
        if min(range(len(models)), key=lambda number: models[number].bic) == best:
            break
    return models
