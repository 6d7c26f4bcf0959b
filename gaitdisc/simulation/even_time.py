"""One trial as a logger wrote it, on an even time base: a clock that shakes, rows that are missing, empty cells."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, SamplingError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values, mean_step, runs

SHORTEST = 20  # samples of a trial
JITTER = 0.1  # of a step: how far a sample may lie from its place on the even time base
EVEN = 1e-3  # of a step, which is even enough
BRIDGED_S = 0.2  # longest gap of an input that is bridged
MILLISECONDS = "everything, if the times are in milliseconds: divide 'time' by 1000"
SLOW_HZ = 0.5  # rates below are rare where time is in seconds, and what milliseconds look like


@dataclass(frozen=True, eq=False)
class TrialColumns:
    """What one trial gives before it is checked."""

    name: str
    time: Values  # (sample,) [s], as measured
    inputs: Values  # (sample, input), columns that the simulation needs; NaN where a cell is empty
    observed: Values  # (sample, channel), the same of observed channels


def on_even_time(
    trial: TrialColumns, inputs: tuple[str, ...], source: str
) -> tuple[TrialColumns, float, list[Finding]]:
    """Put one trial on an even time base.

    inputs: names of its inputs; one called `phase` wraps at 1
    returns trial: at even times; rows that were missing are NaN in the observed channels, and bridged in the inputs
    returns rate: samples a second [Hz]
    """
    where = f"{source}, trial {trial.name!r}"
    _refuse_short(trial, where)
    rate, place = _places(trial.time, where)
    findings: list[Finding] = []
    even = trial
    if rate is None:
        rate, off = _find_even_clock(trial.time, place, where)
        worst = 100 * float(np.abs(off).max())
        if worst > 100 * EVEN:
            first = float(np.median(trial.time * rate - place))
            even, what = _resample(trial, np.asarray((place + first) / rate, np.float64), inputs)
            what = f"trial {trial.name!r}: times deviate by up to {worst:.1f} % of a step from even spacing; {what}"
            findings.append(Finding("note", "clock", source, what, "nothing at this size"))
    count = int(place[-1]) + 1
    missing = count - len(place)
    if missing:  # empty rows where the clock jumped
        driving, observed = (np.full((count, table.shape[1]), np.nan) for table in (even.inputs, even.observed))
        driving[place], observed[place] = even.inputs, even.observed
        even = TrialColumns(even.name, even.time[0] + np.arange(count) / rate, driving, observed)
        what = f"trial {trial.name!r} lacks {missing} of {len(even.time)} rows"
        findings.append(Finding("warning", "gap in time", source, what, "the missing period, which is excluded"))
    return _bridge_inputs(even, inputs, rate, source, findings), rate, findings


def clock_findings(trials: list[TrialColumns], rate: float, source: str) -> list[Finding]:
    """Note times that look like milliseconds."""
    is_whole = all(np.array_equal(trial.time, np.rint(trial.time)) for trial in trials)
    if rate >= SLOW_HZ or not is_whole:
        return []
    what = f"the time step is {1 / rate:g} s, and the trial lasts {len(trials[0].time) / rate:g} s"
    return [Finding("warning", "clock", source, what, MILLISECONDS)]


def _refuse_short(trial: TrialColumns, where: str) -> None:
    if len(trial.time) < SHORTEST:
        raise SamplingError(f"a trial must have {SHORTEST} samples", f"{where} has {len(trial.time)}", "Record longer.")
    steps = np.diff(trial.time)
    back = int(np.argmin(steps))
    if steps[back] <= 0:
        what = "occurs twice" if steps[back] == 0 else f"is followed by {trial.time[back + 1]:.6g} s"
        raise SamplingError(
            "time must increase within a trial",
            f"{where}: t = {trial.time[back]:.6g} s {what} (sample {back + 2} of the trial)",
            "Remove the duplicate rows, or give each trial its own name in the column 'trial'.",
        )


def _places(time: Values, where: str) -> tuple[float | None, NDArray[np.intp]]:
    """Rate of a clock that is even but for the digits that it was printed with (else None), and each row's place."""
    mean = mean_step(time)
    off = np.abs(time - time[0] - mean * np.arange(len(time)))
    # decimals that the times were printed with, 9 at most
    decimals = (d for d in range(9) if np.all(np.abs(time - np.round(time, d)) < 1e-12 * (1 + np.abs(time))))
    printed = 0.51 * 10.0 ** -next(decimals, 9)
    if off.max() <= max(EVEN * mean, min(2 * printed, 0.25 * mean)):
        return _round_rate(1.0 / mean), np.arange(len(time))
    steps = np.diff(time)
    place = np.concatenate([[0], np.cumsum(np.maximum(np.rint(steps / np.median(steps)), 1).astype(np.intp))])
    if place[-1] > 2 * len(time):
        raise _uneven(time, where)
    return None, place


def _find_even_clock(time: Values, place: NDArray[np.intp], where: str) -> tuple[float, Values]:
    """Rate of the even clock next to a jittering one, and how far each time lies beside it (sample,) [steps]."""
    slope, first = np.polyfit(place, time, 1)
    off = (time - first) / slope - place
    if np.abs(off).max() > JITTER:
        raise _uneven(time, where)
    rate = 1.0 / float(slope)
    return _round_rate(rate, JITTER * rate / len(time)), off


def _uneven(time: Values, where: str) -> SamplingError:
    steps = np.diff(time)
    worst = int(np.argmax(np.abs(steps - np.median(steps))))
    return SamplingError(
        f"the sampling interval of a trial must be constant within {JITTER:g} of a step",
        f"{where}: a step of {steps[worst]:.6g} s after t = {time[worst]:.6g} s (median {np.median(steps):.6g} s, "
        f"range {steps.min():.6g} to {steps.max():.6g} s)",
        "Resample the trial to an even rate, or split it there into two trials.",
    )


def _resample(trial: TrialColumns, time: Values, inputs: tuple[str, ...]) -> tuple[TrialColumns, str]:
    """The trial at even times, and how: its samples moved, or its times alone where moving makes the channels rougher.

    A jittering clock is one of two things: the samples were taken at these times, or they were taken evenly and marked
    with the times of their arrival. The channels show which: wrong times make them rough.
    """
    even, late_s = replace(trial, time=time), trial.time - time
    moved = replace(
        even,
        inputs=_along(trial.inputs, trial.time, late_s, tuple(name == "phase" for name in inputs)),
        observed=_along(trial.observed, trial.time, late_s, (False,) * trial.observed.shape[1]),
    )
    if _roughness(moved.observed, trial.observed) <= _roughness(trial.observed, trial.observed):
        return moved, "the samples were resampled to even spacing"
    return even, "the samples are evenly spaced, so their times were corrected"


def _along(values: Values, time: Values, late_s: Values, wraps: tuple[bool, ...]) -> Values:
    """Columns moved along their own slopes to where an even clock would have taken them (sample, column)."""
    out = values.copy()
    for column, turns in enumerate(wraps):
        known = np.isfinite(values[:, column])
        if known.sum() > 1:
            bridged = _between(time, known, values[:, column], turns)
            at = bridged - late_s * np.gradient(bridged, time)
            out[:, column] = np.where(known, at % 1.0 if turns else at, np.nan)
    return out


def _between(at: Values, known: NDArray[np.bool_], values: Values, turns: bool) -> Values:
    """Values at all places, linear between those that are known; of what wraps at 1 without its wraps."""
    return np.interp(at, at[known], np.unwrap(values[known], period=1.0) if turns else values[known])


def _roughness(values: Values, like: Values) -> float:
    """Sum over the columns of the squared third differences, each over that of another table."""
    sums = [np.nansum(np.diff(table, 3, axis=0) ** 2, axis=0) for table in (values, like)]
    return float(np.sum(sums[0] / np.where(sums[1] > 0, sums[1], 1.0)))


def _bridge_inputs(
    trial: TrialColumns, inputs: tuple[str, ...], rate: float, source: str, findings: list[Finding]
) -> TrialColumns:
    """Bridge gaps of inputs by straight lines, with a finding."""
    filled = trial.inputs.copy()
    for column, name in enumerate(inputs):
        empty = ~np.isfinite(filled[:, column])
        if not empty.any():
            continue
        spans = runs(empty)
        first, end = map(int, spans[np.argmax(spans[:, 1] - spans[:, 0])])
        longest = end - first
        if longest / rate > BRIDGED_S + 1e-9 or empty[0] or empty[-1]:
            raise ReadError(
                f"an input must have a value in every row, except in gaps of at most {BRIDGED_S:g} s",
                f"{source}, trial {trial.name!r}, column {name!r}: {longest} rows ({longest / rate:.3g} s) without a "
                f"value from t = {trial.time[first]:.4g} s on",
                "Split the trial there into two, or fill the gap first.",
            )
        bridged = _between(np.arange(len(empty), dtype=float), ~empty, filled[:, column], name == "phase")
        filled[:, column] = bridged % 1.0 if name == "phase" else bridged
        what = f"trial {trial.name!r} lacks {int(empty.sum())} samples, at most {longest / rate:.3g} s in a row"
        findings.append(Finding("warning", "bridged", source, what, "the simulated motion in these gaps", name))
    return replace(trial, inputs=filled)


def _round_rate(rate: float, to: float = 1e-4) -> float:
    """A rate, whole where it is as good as that [Hz]."""
    return float(np.round(rate, 9)) if abs(rate - round(rate)) > to or rate < 0.5 else float(round(rate))
