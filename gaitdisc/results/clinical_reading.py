"""What is read of a person's cycles beside a reference: what stands out, scores, consistency; for a page to show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.results.leg_curves import LegCurves
from gaitdisc.results.pooled_cycles import PooledCycles


@dataclass(frozen=True)
class Limits:
    """Limits of a value in a reference.

    Parameters
    ----------
    low, high : float
        Prediction limits for one more healthy leg, corrected for all rules of the page.
    mean, sd : float
        Over the legs of the reference.
    """

    low: float
    high: float
    mean: float
    sd: float
    people: int


@dataclass(frozen=True)
class Noted:
    """A value of one leg that a rule looks at.

    Parameters
    ----------
    rule, words : str
        Name of the rule, and what it calls a value that stands out; no words for one that does not.
    excess : float
        Distance from the reference's mean over that of the limit; beyond 1 outside.
    """

    rule: str
    words: str
    side: str
    value: float
    unit: str
    digits: int
    limits: Limits
    cycles: int
    excess: float


@dataclass(frozen=True)
class Score:
    """A score of a leg or of both.

    Parameters
    ----------
    low, high : float
        Smallest and largest of single cycles; NaN where they are not computed one by one.
    reference_mean, reference_sd : float
        The same score of each control against the others.
    """

    value: float
    low: float
    high: float
    cycles: int
    reference_mean: float
    reference_sd: float
    people: int


@dataclass(frozen=True)
class Profile:
    """Movement analysis profile and gait profile score.

    Parameters
    ----------
    variables : mapping of (str, str) to Score
        Variable and side -> rms difference to the reference's mean [deg].
    legs : mapping of str to Score
        Side -> gait profile score of the leg [deg].
    both : Score or None
        Gait profile score over fifteen curves; None where a leg or a curve is missing.
    """

    variables: Mapping[tuple[str, str], Score]
    legs: Mapping[str, Score]
    both: Score | None


@dataclass(frozen=True, eq=False)
class Band:
    """Mean and standard deviation of a curve over the legs of a reference."""

    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    people: int


@dataclass(frozen=True, eq=False)
class ClinicalReading:
    """One person, session and condition, read beside a reference.

    Parameters
    ----------
    light : str
        `green`, `amber` or `red`.
    reasons : tuple of str
        Why it is amber or red.
    numbers : tuple of Noted
        Every value that a rule looks at, those that stand out first.
    silent : str
        Why nothing can be said to stand out; empty where the rules were applied.
    deviation_index : mapping of str to float
        Side -> GDI; empty with the reason in `no_index`.
    consistency : mapping of (str, str) to float
        Variable and side -> coefficient of multiple correlation of its cycles, NaN where it is not defined.
    spatiotemporal : mapping of str to Limits
        Spatiotemporal value -> mean and spread of the reference.
    beside : tuple of str
        Which controls of the reference the person is read beside, and what could not be allowed for.
    """

    pooled: PooledCycles
    legs: Mapping[str, LegCurves]
    light: str
    reasons: tuple[str, ...]
    numbers: tuple[Noted, ...]
    silent: str
    profile: Profile | None
    no_profile: str
    deviation_index: Mapping[str, float]
    no_index: str
    consistency: Mapping[tuple[str, str], float]
    bands: Mapping[str, Band]
    spatiotemporal: Mapping[str, Limits]
    beside: tuple[str, ...] = ()

    @property
    def noted(self) -> tuple[Noted, ...]:
        """What stands out, the farthest first."""
        return tuple(one for one in self.numbers if one.words)


@dataclass(frozen=True)
class DifferingSpan:
    """A stretch of the cycle in which two sets of cycles of a leg differ.

    Parameters
    ----------
    first, last : int
        [% of the cycle].
    difference : float
        Largest in the stretch, second minus first [the variable's unit].
    p : float
        Corrected for the whole cycle and all variables of the leg.
    matters : bool
        Whether the difference is as large as the smallest that matters.
    """

    variable: str
    side: str
    first: int
    last: int
    difference: float
    p: float
    matters: bool


@dataclass(frozen=True, eq=False)
class Contrast:
    """Two sessions or conditions of one person, one over the other.

    Parameters
    ----------
    untested : mapping of str to str
        Side -> why no test was done.
    """

    first: ClinicalReading
    second: ClinicalReading
    spans: tuple[DifferingSpan, ...]
    untested: Mapping[str, str]
    tested: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class PersonSession:
    """A person's session: its conditions, the first the one that page 1 shows, and what is compared.

    Parameters
    ----------
    title : str
        Pseudonym, and session where there are sessions.
    """

    title: str
    readings: tuple[ClinicalReading, ...]
    contrasts: tuple[Contrast, ...] = ()
