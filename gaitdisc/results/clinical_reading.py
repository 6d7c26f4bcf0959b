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
    """Limits of a value in a reference."""

    low: float  # prediction limits for one more healthy leg, corrected for all rules of the page
    high: float  # prediction limits for one more healthy leg, corrected for all rules of the page
    mean: float  # over the legs of the reference
    sd: float  # over the legs of the reference
    people: int


@dataclass(frozen=True)
class Noted:
    """A value of one leg that a rule looks at."""

    rule: str  # name of the rule, and what it calls a value that stands out; no words for one that does not
    words: str  # name of the rule, and what it calls a value that stands out; no words for one that does not
    side: str
    value: float
    unit: str
    digits: int
    limits: Limits
    cycles: int
    excess: float  # distance from the reference's mean over that of the limit; beyond 1 outside


@dataclass(frozen=True)
class Score:
    """A score of a leg or of both."""

    value: float
    low: float  # smallest and largest of single cycles; NaN where they are not computed one by one
    high: float  # smallest and largest of single cycles; NaN where they are not computed one by one
    cycles: int
    reference_mean: float  # the same score of each control against the others
    reference_sd: float  # the same score of each control against the others
    people: int


@dataclass(frozen=True)
class Profile:
    """Movement analysis profile and gait profile score."""

    # mapping of (str, str) to Score, variable and side -> rms difference to the reference's mean [deg]
    variables: Mapping[tuple[str, str], Score]
    legs: Mapping[str, Score]  # side -> gait profile score of the leg [deg]
    both: Score | None  # gait profile score over fifteen curves; None where a leg or a curve is missing


@dataclass(frozen=True, eq=False)
class Band:
    """Mean and standard deviation of a curve over the legs of a reference."""

    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    people: int


@dataclass(frozen=True, eq=False)
class ClinicalReading:
    """One person, session and condition, read beside a reference."""

    pooled: PooledCycles
    legs: Mapping[str, LegCurves]
    light: str  # `green`, `amber` or `red`
    reasons: tuple[str, ...]  # why it is amber or red
    numbers: tuple[Noted, ...]  # every value that a rule looks at, those that stand out first
    silent: str  # why nothing can be said to stand out; empty where the rules were applied
    profile: Profile | None
    no_profile: str
    deviation_index: Mapping[str, float]  # side -> GDI; empty with the reason in `no_index`
    no_index: str
    # mapping of (str, str) to float, variable and side -> coefficient of multiple correlation of its cycles, NaN where
    # it is not defined
    consistency: Mapping[tuple[str, str], float]
    bands: Mapping[str, Band]
    spatiotemporal: Mapping[str, Limits]  # spatiotemporal value -> mean and spread of the reference
    # which controls of the reference the person is read beside, and what could not be allowed for
    beside: tuple[str, ...] = ()

    @property
    def noted(self) -> tuple[Noted, ...]:
        """What stands out, the farthest first."""
        return tuple(one for one in self.numbers if one.words)


@dataclass(frozen=True)
class DifferingSpan:
    """A stretch of the cycle in which two sets of cycles of a leg differ."""

    variable: str
    side: str
    first: int  # [% of the cycle]
    last: int  # [% of the cycle]
    difference: float  # largest in the stretch, second minus first [the variable's unit]
    p: float  # corrected for the whole cycle and all variables of the leg
    matters: bool  # whether the difference is as large as the smallest that matters


@dataclass(frozen=True, eq=False)
class Contrast:
    """Two sessions or conditions of one person, one over the other."""

    first: ClinicalReading
    second: ClinicalReading
    spans: tuple[DifferingSpan, ...]
    untested: Mapping[str, str]  # side -> why no test was done
    tested: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class PersonSession:
    """A person's session: its conditions, the first the one that page 1 shows, and what is compared."""

    title: str  # pseudonym, and session where there are sessions
    readings: tuple[ClinicalReading, ...]
    contrasts: tuple[Contrast, ...] = ()
