"""Is this trial walking (or running) at all? Calibration and range-of-motion trials are refused, with numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import StrideError
from gaitdisc.recording import Recording, Strides

FEWEST_STRIDES = 3
LEAST_REGULARITY = 0.72
LEAST_COVERAGE = 0.6
LEAST_KNEE_DEG = 25.0
SHORTEST_STRIDE_S, LONGEST_STRIDE_S = 0.4, 2.5


@dataclass(frozen=True)
class Walking:
    """How steadily somebody walks."""

    strides: int
    stride_s: float  # median duration [s]
    coverage: float  # share of the time between first and last sample that strides cover
    # median over hips and knees of the correlation with the same angle one stride later; NaN where the recording is
    # shorter than four strides
    regularity: float
    knee_deg: float  # excursion of the knee, 5th to 95th percentile; NaN without a knee


def measured_walking(kinematics: Recording, strides: Strides) -> Walking:
    """Measure how steadily somebody walks.

    kinematics: with hip and knee flexion [deg]
    """
    hips_and_knees = [
        n for n in kinematics.names if n in {f"{j}_{s}" for j in ("hip_flexion", "knee_angle") for s in "rl"}
    ]
    median = float(np.median(strides.duration_s)) if len(strides) else float("nan")
    known = {name: kinematics[name][np.isfinite(kinematics[name])] for name in hips_and_knees}
    known = {name: x for name, x in known.items() if len(x)}
    regularity = float("nan")
    if known and kinematics.duration_s > 4 * median:
        regularity = float(np.median([stride_period(kinematics[name], kinematics.rate_hz)[1] for name in known]))
    knees = [float(np.subtract(*np.percentile(x, [95, 5]))) for name, x in known.items() if name.startswith("knee")]
    return Walking(
        len(strides),
        median,
        float(np.sum(strides.duration_s) / kinematics.duration_s),
        regularity,
        min(knees) if knees else float("nan"),
    )


def verify_walking(
    kinematics: Recording, strides: Strides, fewest: int = FEWEST_STRIDES, least_coverage: float = LEAST_COVERAGE
) -> Walking:
    """Refuse a trial that is not walking or running.

    Walking means: at least `fewest` strides, which cover 60 % of the trial, repeat with a correlation of 0.72 or more,
    and bend both knees by 25 deg or more. On treadmill_walk_ik the twelve walks, each with a stumble, have 0.82 to 0.98
    and cover 84 to 96 %; the two range-of-motion trials 0.58 and 0.64 and cover below 20 %.

    kinematics: with hip and knee flexion [deg]
    least_coverage: share of the trial that strides must cover; 0 for walks over ground that begin and end within the
        trial
    """
    found = measured_walking(kinematics, strides)
    fails = []
    if found.strides < fewest:
        fails.append(f"{found.strides} stride{'s' if found.strides != 1 else ''} where {fewest} are needed")
    if found.coverage < least_coverage:
        fails.append(f"strides cover {100 * found.coverage:.0f} % of {kinematics.duration_s:.1f} s")
    if found.regularity < LEAST_REGULARITY:
        fails.append(f"hips and knees repeat with a correlation of {found.regularity:.2f}")
    if found.knee_deg < LEAST_KNEE_DEG:
        fails.append(f"a knee moves {found.knee_deg:.0f} deg")
    if fails:
        least = "1 stride" if fewest == 1 else f"{fewest} strides"
        raise StrideError(
            f"walking means {least} or more over {100 * least_coverage:.0f} % of the trial, repeating with a "
            f"correlation of {LEAST_REGULARITY:g} or more, knees bending {LEAST_KNEE_DEG:g} deg or more",
            f"{kinematics.source.file or 'the recording'}: {'; '.join(fails)}",
            "Leave calibration and range-of-motion trials out of the study, or cut the trial to its walking part.",
        )
    return found


def stride_period(
    x: NDArray[np.float64],
    rate_hz: float,
    shortest_s: float = SHORTEST_STRIDE_S,
    longest_s: float = LONGEST_STRIDE_S,
) -> tuple[float, float]:
    """Period at which an angle repeats, and how well.

    The autocorrelation is that of the two overlapping parts (each lag has its own means and variances), so a perfectly
    repeated stride gives 1 at every multiple of its period. The shortest lag whose peak comes within 0.1 of the highest
    one is the period.

    x (time,): NaN allowed; lags use the pairs that are there
    shortest_s, longest_s: range searched [s]
    returns period_s, regularity: NaN and 0 where nothing repeats or the recording is shorter than 1.7 strides.
        Regularity is the correlation at the period, -1 to 1

    >>> t = np.arange(1000) / 100
    >>> period, regularity = stride_period(np.sin(2 * np.pi * t) + 0.5 * np.sin(4 * np.pi * t), 100.0)
    >>> round(period, 2), round(regularity, 2)
    (1.0, 1.0)
    """
    first = max(1, round(shortest_s * rate_hz))
    last = min(round(longest_s * rate_hz), int(0.6 * len(x)))
    if last <= first + 1 or np.isfinite(x).sum() < first:
        return float("nan"), 0.0
    lags = np.arange(first - 1, last + 2)
    r = np.array([_correlation(x[:-lag], x[lag:]) for lag in lags])
    inner = r[1:-1]
    peaks = np.flatnonzero((inner > r[:-2]) & (inner >= r[2:]) & (inner > 0)) + 1
    if not len(peaks):
        return float("nan"), 0.0
    first_high = peaks[np.flatnonzero(r[peaks] >= r[peaks].max() - 0.1)[0]]
    left, centre, right = r[first_high - 1 : first_high + 2]
    shift = 0.5 * (left - right) / (left - 2 * centre + right)
    return float((lags[first_high] + shift) / rate_hz), float(centre)


def _correlation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    both = np.isfinite(a) & np.isfinite(b)
    if (count := np.count_nonzero(both)) < 10:
        return 0.0
    a, b = (part - part.mean() for part in ((a, b) if count == len(both) else (a[both], b[both])))
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0 else 0.0
