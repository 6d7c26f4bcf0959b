"""The time column of a text file: its printed digits round the steps, and a gap in it must not pass as rounding."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError

_NUMBER = re.compile(r"[-+]?\d*(?:[.,](\d*))?(?:[eEdD]([-+]?\d+))?")
COARSE = 0.35  # of a step; a printed digit above this hides a missing sample
ALREADY_EVEN = 1e-6  # of a step


def printed_digit(texts: Iterable[str]) -> float:
    """Size of the last digit in use, the finest of a column; zeros that only fill up a number are none.

    >>> printed_digit(["0", "0.017", "0.033"]), printed_digit(["0.000000", "0.017000"]), printed_digit(["5.25e-04"])
    (0.001, 0.001, 1e-06)
    """
    finest = 0
    for text in texts:
        found = _NUMBER.fullmatch(text.strip())
        if found:
            finest = max(finest, len((found[1] or "").rstrip("0")) - int(found[2] or 0))
    return float(10.0 ** -min(finest, 300))


def even_time(
    time: NDArray[np.float64], digit_s: float, file: str, lines: NDArray[np.intp] | None = None
) -> NDArray[np.float64]:
    """Even time base that a column of printed times rounds.

    A column is taken as even when no step differs from the mean one by more than one printed digit, and no time from
    the even base by more than that. Where the digit is coarser than 35 % of a step a missing sample would look like
    rounding, so all steps must be the same there.

    time (time,) [s]: as read
    digit_s: size of the last printed digit [s]; 0 for binary files
    lines (time,): line of each sample in the file, for the message; the row counted from 1 without it
    returns (time,) [s]: the same array where it is even already

    >>> even_time(np.array([0.0, 0.017, 0.033, 0.05]), 1e-3, "walk.mot")
    array([0.        , 0.01666667, 0.03333333, 0.05      ])
    """
    time = np.asarray(time, float)

    def place(row: int) -> str:
        return f"line {lines[row]}" if lines is not None else f"row {row + 1}"

    if len(time) < 2:
        raise SamplingError(
            f"{file}: a recording needs at least two samples", f"it has {len(time)}", "Export the whole trial."
        )
    if not np.isfinite(time).all():
        row = int(np.argmax(~np.isfinite(time)))
        raise SamplingError(
            f"{file}: every sample needs a time", f"{place(row)} has {time[row]}", "Export the file again."
        )
    steps = np.diff(time)
    if steps.min() <= 0:
        row = int(np.argmin(steps))
        raise SamplingError(
            f"{file}: time must increase",
            f"{place(row + 1)} has t = {time[row + 1]:.10g} s after {time[row]:.10g} s",
            "Remove the doubled or misplaced rows, or export the trial again.",
        )
    step = (time[-1] - time[0]) / (len(time) - 1)
    even = time[0] + step * np.arange(len(time))
    if np.abs(time - even).max() <= ALREADY_EVEN * step:
        return time
    _check_rounding(time, digit_s, file, place)
    return _rounded_rate(time, even, digit_s)


def _check_rounding(time: NDArray[np.float64], digit_s: float, file: str, place) -> None:
    steps = np.diff(time)
    step = (time[-1] - time[0]) / len(steps)
    off = np.abs(steps - step)
    allowed = 1.01 * digit_s if digit_s <= COARSE * step else 0.0
    drift = np.abs(time - (time[0] + step * np.arange(len(time))))
    if off.max() <= max(allowed, 1e-3 * step) and drift.max() <= max(allowed, 1e-3 * step):
        return
    row = int(np.argmax(np.abs(steps - np.median(steps))))
    raise SamplingError(
        f"{file}: a recording needs a constant rate",
        f"between {place(row)} and {place(row + 1)} the step is {steps[row]:.6g} s (t = {time[row]:.6g} s) where the "
        f"usual one is {np.median(steps):.6g} s, and times are printed to {digit_s:.0e} s",
        "Samples are missing, or times have too few digits: export at one rate and with more digits.",
    )


def _rounded_rate(time: NDArray[np.float64], even: NDArray[np.float64], digit_s: float) -> NDArray[np.float64]:
    """Even base at a whole number of samples a second where the digits allow one, else from first to last time."""
    rate = round((len(time) - 1) / (time[-1] - time[0]))
    if rate > 0:
        whole = time[0] + np.arange(len(time)) / rate
        if np.abs(time - whole).max() <= 1.01 * digit_s:
            return whole
    return even
