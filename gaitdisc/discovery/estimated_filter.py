"""The low-pass that a record went through, where the file does not say: found in its spectrum, with a finding.

Where noise alone shows at the cut-off, the record's spectrum shows it. Where the signal reaches there, the signal's own
fall is in the way; then the simulation as read, laid over the record run by run, may say better how the signal falls.
"""

from dataclasses import replace
from statistics import geometric_mean

import numpy as np

from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.discovery.scored_model import ScoredModel, fit_model
from gaitdisc.discovery.segments import FEWEST_SAMPLES, cut_segments
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.signals.recorded_filter import LIKELIER, RecordedFilter, find_filter
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

SURE = 4.0  # times the noise's power at the cut-off, up to which a signal there is not in the way
FELT = 1e-3  # times the noise's power at the cut-off, from which on a signal there may be in the way
ALIKE = 1.3  # between the cut-offs of channels that went through one filter
OVERLAP = 4  # times as long a run is as what it shares with the next on either side
MOTION = {"m", "mm", "deg", "rad"}  # units of what one system records
ROUGH = 1.0  # times the noise's power at the cut-off, from which on a signal there makes the number a rough one


def find_record_filter(
    simulation: Simulation, measured: Measured, period: float, guess: Values | None = None, like: Values | None = None
) -> tuple[RecordFilter, tuple[Finding, ...]]:
    """Return what the measured channels went through: as the file says, or as their spectra show.

    period: the motion's main period [s]
    guess (trial, sample, state): states of every trial, roughly
    like (run, sample, channel): the channels as the simulation has them, where it was run before
    """
    stated = tuple(simulation.sensor(name).lowpass for name in measured.channels)
    unknown = [number for number, cutoff in enumerate(stated) if cutoff is None]
    units = [simulation.sensor(name).unit for name in measured.channels]

    def find(number: int, at_hz: float | None = None) -> RecordedFilter | None:
        each = None if like is None else [*like[:, :, number]]
        return find_filter(_trials(measured, number), measured.rate, each, at_hz)

    seen = {number: estimate for number in unknown if (estimate := find(number))}
    for number in [number for number in unknown if number not in seen]:  # its own spectrum shows none clearly
        alike = MOTION if units[number] in MOTION else {units[number]}
        beside = [each.cutoff_hz for k, each in seen.items() if units[k] in alike and each.signal <= ROUGH]
        if beside and (estimate := find(number, geometric_mean(beside))):
            seen[number] = estimate
    felt = any(each.signal > FELT for each in seen.values())
    if guess is None and like is None:  # channels of one unit are taken to be recorded alike
        sure = {number: each for number, each in seen.items() if each.signal <= ROUGH}
        alike = {number: [each for k, each in sure.items() if units[k] == units[number]] for number in unknown}
        seen = {number: sure.get(number, some[0]) for number, some in alike.items() if some}
    elif guess is not None and ((inputs := bool(seen) and _inputs_are_filtered(simulation, measured)) or felt):
        length = min(max(int(period * measured.rate), FEWEST_SAMPLES), int(measured.samples.min()) // 2)
        runs = cut_segments(measured.samples, tuple(range(len(measured.trials))), length, length // OVERLAP)
        size = np.nanstd(measured.observed, axis=(0, 1))
        shooting = Shooting(measured, runs, white_noise(size), past=guess)
        as_read = fit_model(shooting, simulation, (), runs.starts(guess))
        seen = _beside_the_simulation(as_read, seen, inputs)
    cutoffs = _as_the_surer(seen, units)
    if cutoffs and max(cutoffs.values()) < ALIKE * min(cutoffs.values()):  # one filter
        cutoffs = dict.fromkeys(cutoffs, geometric_mean(cutoffs.values()))
    passed = RecordFilter(tuple(cutoffs.get(number, cutoff) for number, cutoff in enumerate(stated)), measured.rate)
    gains, findings = passed.gains, []
    noise = {number: each.noise * float(gains[number]) for number, each in seen.items() if each.signal <= FELT}
    passed = replace(passed, noise=noise)
    for number, hz in cutoffs.items():
        what = f"assumed to be low-passed at {hz:.3g} Hz without lag (order 2, run twice), because of its spectrum"
        spoils = "results that depend on this filter; state lowpass in the simulation file if you know the cut-off"
        findings.append(Finding("note", "low-pass", measured.source, what, spoils, measured.channels[number]))
    return passed, tuple(findings)


def note_other(passed: RecordFilter, source: str) -> Finding:
    """Finding that no effect is named because of another cut-off."""
    hz = ", ".join(f"{cutoff:.3g}" for cutoff in dict.fromkeys(passed.cutoffs_hz) if cutoff)
    what = f"at a cut-off of {hz} Hz, within the error of its estimate, only noise is left, so no effect is named"
    spoils = "a small effect; if you know the cut-off, state lowpass in the simulation file"
    return Finding("note", "low-pass", source, what, spoils)


def _trials(measured: Measured, channel: int) -> list[Values]:
    """One channel of each trial."""
    return [seen[:samples, channel] for seen, samples in zip(measured.observed, measured.samples, strict=True)]


def _inputs_are_filtered(simulation: Simulation, measured: Measured) -> bool:
    """Whether an input went through a filter: of a linear system, the record has then gone through no other."""
    drive = measured.drive
    trials = [signal[:samples] for signal, samples in zip(drive.inputs, drive.samples, strict=True)]
    numbers = [number for number, signal in enumerate(simulation.inputs) if not signal.computed]
    estimates = [find_filter([trial[:, number] for trial in trials], drive.rate) for number in numbers]
    return any(each is not None and each.signal < SURE for each in estimates)


def _as_the_surer(seen: dict[int, RecordedFilter], units: list[str]) -> dict[int, float]:
    """Cut-offs, a rough one in the place of which stands that of surer channels of the same unit."""
    cutoffs = {}
    for number, each in seen.items():
        beside = [other for k, other in seen.items() if units[k] == units[number]]
        surer = [other.cutoff_hz for other in beside if other.signal <= ROUGH < each.signal]
        cutoffs[number] = geometric_mean(surer) if surer else each.cutoff_hz
    return cutoffs


def _beside_the_simulation(
    now: ScoredModel, seen: dict[int, RecordedFilter], inputs: bool
) -> dict[int, RecordedFilter]:
    """Find the cut-offs anew, the signal falling as that of the simulation.

    Where inputs were filtered too, none are found if the simulation goes better with the record as it is.
    """
    measured, like, kept = now.shooting.measured, _stitch(now), dict(seen)
    for number, each in seen.items():
        if each.signal <= FELT:
            continue
        again = find_filter(_trials(measured, number), measured.rate, [run[:, number] for run in like])
        if each.signal > SURE:
            kept.pop(number)
        if again and (each.signal > SURE or again.likelihood > each.likelihood + LIKELIER):
            kept[number] = again
    if not inputs or not kept:
        return kept
    cutoffs = tuple(kept[number].cutoff_hz if number in kept else None for number in range(len(measured.channels)))
    filtered = replace(now.shooting, record_filter=RecordFilter(cutoffs, measured.rate))
    return kept if now.refitted(filtered).fit.misfit < now.fit.misfit else {}


def _stitch(now: ScoredModel) -> Values:
    """Overlapping runs as whole trials (trial, sample, channel): one fades out while the next fades in."""
    segments, observed, fit = now.shooting.segments, now.shooting.measured.observed, now.fit
    runs = now.shooting.unfiltered(now.machine, fit.states[None], fit.values[None])[0]
    weight, shared = np.ones(segments.length), 2 * segments.margin
    ramp = np.sin(np.linspace(0, np.pi / 2, shared + 2)[1:-1]) ** 2
    weight[:shared], weight[segments.length - shared :] = ramp, ramp[::-1]
    total, weights = np.zeros(observed.shape), np.zeros(observed.shape[:2])
    for trial, samples, run in zip(segments.trial, segments.samples, runs, strict=True):
        total[trial, samples] += weight[:, None] * run
        weights[trial, samples] += weight
    with np.errstate(invalid="ignore"):
        return total / weights[..., None]
