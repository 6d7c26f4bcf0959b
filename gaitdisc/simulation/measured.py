"""Measured trials: what drives a simulation, and what was observed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, SamplingError, ShapeError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values, finite_values, read_only
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.even_time import SHORTEST, TrialColumns, clock_findings, on_even_time
from gaitdisc.words import counted


@dataclass(frozen=True, eq=False)
class Measured:
    """Trials at one rate.

    >>> drive = Drive.of([np.empty((30, 0))] * 2, 100.0)
    >>> Measured(drive, np.zeros((2, 30, 1)), ("1", "2"), ("x",)).selected([1]).trials
    ('2',)
    """

    drive: Drive
    observed: Values  # (trial, sample, channel), measured channels; NaN beyond a trial's end
    trials: tuple[str, ...]
    channels: tuple[str, ...]  # names of the observed channels, in the order of the simulation's observations
    findings: tuple[Finding, ...] = ()  # what a user must know of them
    source: str = ""

    def __post_init__(self) -> None:
        """Freeze, and refuse what does not fit."""
        observed = read_only(np.ascontiguousarray(self.observed, float))
        shape = (len(self.trials), self.drive.inputs.shape[1], len(self.channels))
        if observed.shape != shape or len(self.drive.samples) != len(self.trials):
            raise ShapeError(
                "measured trials must have observed values of shape (trial, sample, channel)",
                f"their shape is {observed.shape} instead of {shape}",
                "Pad the trials to the same length with NaN.",
            )
        object.__setattr__(self, "observed", observed)

    @property
    def rate(self) -> float:
        """Samples a second [Hz]."""
        return self.drive.rate

    @property
    def samples(self) -> NDArray[np.int64]:
        """Length of each trial (trial,)."""
        return self.drive.samples

    def time(self, trial: int) -> Values:
        """Times of a trial's samples (sample,) [s]."""
        return self.drive.time0[trial] + np.arange(self.samples[trial]) / self.rate

    def selected(self, trials: Sequence[int]) -> Measured:
        """Some of the trials."""
        which = np.asarray(trials, int)
        longest = int(self.samples[which].max())
        drive = Drive(self.rate, self.drive.time0[which], self.drive.inputs[which, :longest], self.drive.samples[which])
        names = tuple(self.trials[trial] for trial in which)
        return replace(self, drive=drive, observed=self.observed[which, :longest], trials=names)


def check_measured(
    trials: Sequence[TrialColumns],
    inputs: Sequence[str],
    channels: Sequence[str],
    source: str,
    findings: Sequence[Finding] = (),
) -> Measured:
    """Measured trials, checked; one that is too short is left out with a finding where there are others."""
    if not trials:
        raise SamplingError(
            f"a trial must have {SHORTEST} samples", f"{source} has no rows", "Export the samples again."
        )
    short = [trial for trial in trials if len(trial.time) < SHORTEST]
    if 0 < len(short) < len(trials):
        listed = ", ".join(f"{trial.name!r} ({len(trial.time)})" for trial in short)
        too_few = f"fewer than {SHORTEST} samples in {counted(len(short), 'trial')}: {listed}"
        findings = [*findings, Finding("warning", "short trial", source, too_few, "these trials, which are excluded")]
        trials = [trial for trial in trials if len(trial.time) >= SHORTEST]
    even = [on_even_time(trial, tuple(inputs), source) for trial in trials]
    trials, rates = [trial for trial, _, _ in even], [rate for _, rate, _ in even]
    apart = int(np.argmax(np.abs(np.array(rates) - rates[0])))
    if abs(rates[apart] - rates[0]) > 2e-3 * rates[0]:
        raise SamplingError(
            "all trials must have the same sampling rate",
            f"{source}: trial {trials[0].name!r} was sampled at {rates[0]:.6g} Hz, "
            f"trial {trials[apart].name!r} at {rates[apart]:.6g} Hz",
            "Resample them to one rate.",
        )
    longest = max(len(trial.time) for trial in trials)
    observed = np.full((len(trials), longest, len(channels)), np.nan)
    for number, trial in enumerate(trials):
        observed[number, : len(trial.time)] = np.where(np.isfinite(trial.observed), trial.observed, np.nan)
    drive = Drive.of([trial.inputs for trial in trials], rates[0], [float(trial.time[0]) for trial in trials])
    seen = [*findings, *_together([note for _, _, notes in even for note in notes])]
    seen += clock_findings(trials, rates[0], source)
    seen += [*_empty(trials, channels, source), *_constant(trials, inputs, channels, source)]
    if len(trials) == 1:
        what = f"trial {trials[0].name!r} is the only trial ({len(trials[0].time)} samples)"
        spoils = "the test on other trials: only a later part of this trial can be held out; record a second one"
        seen.append(Finding("warning", "one trial", source, what, spoils))
    return Measured(drive, observed, tuple(trial.name for trial in trials), tuple(channels), tuple(seen), source)


def _together(notes: list[Finding]) -> list[Finding]:
    """One finding for several trials of which the same is to be known: the first, and how many there are."""
    alike: dict[tuple[str, str], list[Finding]] = {}
    for note in notes:
        alike.setdefault((note.kind, note.channel), []).append(note)
    return [
        replace(some[0], what=some[0].what + (f"; further trials: {len(some) - 1}" if len(some) > 1 else ""))
        for some in alike.values()
    ]


def _empty(trials: Sequence[TrialColumns], channels: Sequence[str], source: str) -> list[Finding]:
    """Refuse a channel that is as good as empty in a trial; report empty cells."""
    findings = []
    for column, name in enumerate(channels):
        missing = {trial.name: int((~np.isfinite(trial.observed[:, column])).sum()) for trial in trials}
        for trial in trials:
            there = len(trial.time) - missing[trial.name]
            if there < SHORTEST:
                raise ReadError(
                    f"an observed channel must have at least {SHORTEST} values in every trial",
                    f"{source}, trial {trial.name!r}, column {name!r} has {there} in {len(trial.time)} rows",
                    "Remove the trial, or remove the channel from [observations].",
                )
        worst = max(missing, key=lambda trial: missing[trial])
        if missing[worst]:
            rows = sum(len(trial.time) for trial in trials)
            what = f"missing samples: {sum(missing.values())} of {rows}, most in trial {worst!r} ({missing[worst]})"
            findings.append(Finding("note", "empty cells", source, what, "nothing: empty cells are excluded", name))
    return findings


def _constant(
    trials: Sequence[TrialColumns], inputs: Sequence[str], channels: Sequence[str], source: str
) -> list[Finding]:
    """Refuse an observed channel that never varies; report what does not vary in a trial."""
    findings = []
    for kind, names in (("observed", channels), ("inputs", inputs)):
        for column, name in enumerate(names):
            values = [(trial.name, getattr(trial, kind)[:, column]) for trial in trials]
            still = [trial for trial, samples in values if np.ptp(finite_values(samples)) == 0]
            if len(still) == len(trials) and kind == "observed":
                raise ShapeError(
                    f"the observed channel {name!r} must vary",
                    f"{source} has {getattr(trials[0], kind)[0, column]:g} in every sample",
                    "Remove the channel from [observations], or correct the column.",
                )
            if still:
                what = f"is constant in {len(still)} of {len(trials)} trials (first: {still[0]!r})"
                severity = "warning" if kind == "observed" else "note"
                findings.append(Finding(severity, "constant", source, what, "the evidence from these trials", name))
    return findings
