"""Holm's step-down with Sidak's levels: many tests, one chance of a false alarm."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ComparisonError


@dataclass(frozen=True, eq=False)
class StepDown:
    """One family of tests, corrected."""

    # (test,), adjusted p, in the order of the tests; the test is rejected where it is alpha at most
    adjusted: NDArray[np.float64]
    level: NDArray[np.float64]  # (test,), level that the test's own p was held against: that of its step
    rejected: NDArray[np.bool_]  # (test,), whether the test says that there is a difference
    alpha: float  # chance of one false alarm or more in the whole family
    # level of the step at which the procedure stopped; alpha where it went to the end. The dissertation prints it
    critical: float


def step_levels(tests: int, alpha: float = 0.05) -> NDArray[np.float64]:
    """Levels of the steps, 1 - (1 - alpha)^(1/k) with k = m, m - 1, ..., 1 tests left: the smallest p meets the first.

    >>> step_levels(8).round(4)
    array([0.0064, 0.0073, 0.0085, 0.0102, 0.0127, 0.017 , 0.0253, 0.05  ])
    """
    return -np.expm1(np.log1p(-alpha) / np.arange(tests, 0, -1))


def holm_sidak(p: ArrayLike, alpha: float = 0.05) -> StepDown:
    """Correct a family of tests by Holm's step-down procedure with Sidak's levels.

    The smallest p is compared with the level of m tests, the next with that of m - 1, and so on, until a p is too
    large; this and later hypotheses are not rejected. Adjusted p-values are 1 - (1 - p)^k, but never below the adjusted
    value of a smaller p. The family-wise error is at most alpha for independent or positively dependent tests.

    Parameters
    ----------
    p : array_like (test,)
        p-values of one family of tests, 0 to 1.
    alpha : float
        Family-wise error rate.

    Returns
    -------
    StepDown

    Raises
    ------
    ComparisonError
        If there is no test, or a p-value or alpha is missing or outside 0 to 1.

    References
    ----------
    Holm 1979; Sidak 1967. Ebers 2023, section 4.2.3: 4 of 8 hypotheses are rejected; the fifth level is 0.013.

    Examples
    --------
    >>> found = holm_sidak([0.001, 0.002, 0.003, 0.010, 0.3, 0.4, 0.5, 0.6])
    >>> int(found.rejected.sum()), round(found.critical, 3)
    (4, 0.013)
    """
    check_level(alpha, "alpha")
    p_values = np.asarray(p, float).ravel()
    if not len(p_values) or not np.all((p_values >= 0) & (p_values <= 1)):
        wrong = [f"{value:g}" for value in p_values[~((p_values >= 0) & (p_values <= 1))]]
        raise ComparisonError(
            "the p-values of a family of tests must lie between 0 and 1",
            f"found {', '.join(wrong[:5])}" if wrong else "there is no test",
            "Exclude the comparisons that could not be tested, and state the reason.",
        )
    order = np.argsort(p_values, kind="stable")
    remaining = np.arange(len(p_values), 0, -1)
    with np.errstate(divide="ignore"):  # log1p(-1) is -inf, and 1 - 0^k is 1
        raised = -np.expm1(remaining * np.log1p(-p_values[order]))
    levels = step_levels(len(p_values), alpha)
    steps = np.flatnonzero(p_values[order] > levels)
    rejections = int(steps[0]) if len(steps) else len(p_values)
    back = np.empty(len(p_values), np.intp)
    back[order] = np.arange(len(p_values))
    return StepDown(
        adjusted=np.maximum.accumulate(raised)[back],
        level=levels[back],
        rejected=back < rejections,
        alpha=alpha,
        critical=float(levels[min(rejections, len(p_values) - 1)]),
    )


def check_level(level: float, name: str) -> None:
    """Refuse a level that is no probability between 0 and 1, as a percentage is."""
    if not 0 < level < 1:
        raise ComparisonError(
            f"{name} must be a probability between 0 and 1", f"found {level:g}", "Write 0.05 for 5 %, 0.95 for 95 %."
        )
