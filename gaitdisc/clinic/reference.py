"""A reference of controls: mean cycles of their legs, and bands and limits over them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.clinic.clinical_reference import SPEED, ClinicalReference, Limits, ReferenceLeg
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import make_legs
from gaitdisc.processing.pooled_cycles import PooledCycles
from gaitdisc.recording.arrays import mean_where_known
from gaitdisc.report.curve_panels import Band
from gaitdisc.saved.provenance import Provenance

FEWEST = 5  # people below whom no limit is drawn
ALPHA = 0.05  # chance that anything of a healthy person's page is beyond its limits
LINE_PEOPLE = 10  # controls from whom on limits follow the speed: the line's degree of freedom widens them by 2 %
FARTHEST = 2.0  # d²/Sxx: how far a line is followed beyond the controls' speeds; limits widen up to √3 times
SETTINGS = ("filters", "kinematics", "strides")


def make_reference(cycles: Sequence[PooledCycles], title: str, provenance: Provenance) -> ClinicalReference:
    """Reference of everybody in a run, by condition; of several sessions of a person the first counts."""
    numbers: dict[str, int] = {}
    seen: set[tuple[str, str]] = set()
    legs: dict[str, list[ReferenceLeg]] = {}
    for pooled in cycles:
        person_legs = make_legs(pooled)
        if not person_legs or (pooled.subject, pooled.condition) in seen:
            continue
        seen.add((pooled.subject, pooled.condition))
        number = numbers.setdefault(pooled.subject, len(numbers) + 1)
        for leg in person_legs.values():
            curves = {name: leg.mean(name) for name in leg.cycles}
            values = {name: float(cycle_values.mean()) for name, cycle_values in leg.values.items()}
            fields = (leg.count, leg.stance_percent, curves, values, pooled.leg_m, pooled.age_years)
            legs.setdefault(pooled.condition, []).append(ReferenceLeg(number, leg.side, *fields))
    if not legs:
        raise SchemaError(
            "a reference must have kept cycles of controls",
            f"found none in {len(cycles)} sessions and conditions",
            "Look at “Left out” on the page of the run.",
        )
    by_condition = {word: tuple(group) for word, group in legs.items()}
    settings = {name: provenance.settings[name] for name in SETTINGS if name in provenance.settings}
    return ClinicalReference(title, by_condition, settings, provenance.versions, provenance.created)


def bands(legs: Sequence[ReferenceLeg], speed: float | None = None) -> dict[str, Band]:
    """Mean and standard deviation of every variable that two people or more have, at a speed as limits are."""
    by_variable = {}
    for name in dict.fromkeys(name for leg in legs for name in leg.curves):
        curve_legs = [leg for leg in legs if name in leg.curves]
        people = len({leg.person for leg in curve_legs})
        if people >= 2:
            sample = Sample(np.array([leg.curves[name] for leg in curve_legs]), people, known_speeds(curve_legs))
            mean, sd, far = sample.spread(speed)
            by_variable[name] = Band(mean, sd * np.sqrt(1 + (far or 0.0)), people, at_speed=far is not None)
    return by_variable


def known_speeds(legs: Sequence[ReferenceLeg]) -> NDArray[np.float64] | None:
    """Speed of each leg [m/s]; None where one is not known."""
    speeds = np.array([leg.values.get(SPEED, np.nan) for leg in legs])
    return speeds if np.isfinite(speeds).all() else None


@dataclass(frozen=True, eq=False)
class Sample:
    """Numbers or curves of the reference's legs, and the speed that each was taken at where limits follow it."""

    values: NDArray[np.float64]  # (leg,) or (leg, phase)
    people: int
    speeds: NDArray[np.float64] | None = None  # (leg,) [m/s]

    def leverage(self, speed: float | None) -> float:
        """d²/Sxx of a speed, people as the count: legs of one person walk at one speed; infinite without speeds."""
        if self.speeds is None or speed is None or self.people < LINE_PEOPLE or not np.ptp(self.speeds):
            return float("inf")
        return float((speed - self.speeds.mean()) ** 2 / self.speeds.var() / self.people)

    def limits(self, tests: int = 1, speed: float | None = None) -> Limits:
        """Limits for one more leg, at a speed where the line of the numbers over the speed reaches that far.

        >>> Sample(np.array([58.0, 60.0, 62.0, 60.0]), 4).limits().mean
        60.0
        """
        mean, sd, far = self.spread(speed)
        return limits_about(float(mean), float(sd), self.people, tests, far)

    def spread(self, speed: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64], float | None]:
        """Mean and standard deviation over the legs where known; and the leverage, where both follow the speed."""
        known, far = np.isfinite(self.values), self.leverage(speed)
        mean, count, follows = mean_where_known(self.values), known.sum(axis=0), far <= FARTHEST
        rest = self.values - mean
        if speed is not None and self.speeds is not None and follows:
            speeds = np.where(known.T, self.speeds, np.nan).T
            middle = mean_where_known(speeds)
            offsets = speeds - middle
            slope = mean_where_known(offsets * rest) / np.maximum(mean_where_known(offsets**2), np.finfo(float).tiny)
            mean, rest = mean + slope * (speed - middle), rest - slope * offsets
        # degrees of freedom of the spread over legs
        legs = (count - 1) * (self.people - 1 - follows) / max(self.people - 1, 1)
        sd = np.sqrt(mean_where_known(rest**2) * count / np.where(legs > 0, legs, np.nan))
        return mean, sd, far if follows else None


def limits_about(mean: float, sd: float, people: int, tests: int = 1, far: float | None = None) -> Limits:
    """Limits within which one more healthy leg lies, all of so many tests together, with probability 1 - ALPHA.

    mean ± t(1 - ALPHA / (2 tests), n - 1) · sd · √(1 + 1/n): prediction limits of a normal distribution whose mean and
    spread are themselves estimated; legs of one person are alike, so that n counts people. Bonferroni's correction for
    the tests. About a line n - 2 degrees of freedom are left, and its leverage is added under the root.
    """
    if people < FEWEST:
        return Limits(float("-inf"), float("inf"), mean, sd, people)
    from scipy.special import stdtrit  # which takes a tenth of a second, and a run with nothing new does not need

    free, wider = people - 1 - (far is not None), far or 0.0
    reach = float(stdtrit(free, 1 - ALPHA / (2 * tests))) * sd * float(np.sqrt(1 + 1 / people + wider))
    return Limits(mean - reach, mean + reach, mean, sd * float(np.sqrt(1 + wider)), people)


def spatiotemporal_limits(legs: Sequence[ReferenceLeg]) -> Mapping[str, Limits]:
    """Mean and spread of each spatiotemporal value over the legs of a reference."""
    norms = {}
    for name in dict.fromkeys(name for leg in legs for name in leg.values):
        known = [leg for leg in legs if name in leg.values]
        norms[name] = Sample(np.array([leg.values[name] for leg in known]), len({leg.person for leg in known})).limits()
    return norms
