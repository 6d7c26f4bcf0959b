"""EMG: its envelope, and channels that are dead, clipped, exchanged or in another unit.

The calf works while its foot stands, the tibialis anterior while it swings: in eleven walks of six young people
(young_straight_and_turn) the natural logarithm of stance over swing is 1.0 to 3.4 in the calf and -1.5 to -0.66 in the
tibialis anterior. A muscle that rests or an electrode that comes off changes single channels by as much as another unit
does, so that four of five have to agree on one.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gaitdisc.channel import Channel, other_side
from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.recording import Finding, Recording, Strides
from gaitdisc.recording.arrays import Values, finite_rows, finite_values, robust_sd, spans_s
from gaitdisc.recording.trial import Limits
from gaitdisc.signals.butterworth import high_pass, low_pass

HIGHPASS_HZ = 40.0
ENVELOPE_HZ = 10.0
DEAD_SHARE = 0.001  # standard deviation, of the range: 1.25 mV of 1.25 V
WEAK_SHARE = 0.004  # 5 mV of 1.25 V
BURST = 3.4  # 99th percentile of the envelope over its median; Gaussian noise has 1.3 to 2.3
UNPLUGGED_SHARE = 0.5
AT_RAIL_SHARE = 0.98
CLIPPED_SHARE = 1e-3
SILENT_SHARE = 5e-4  # robust standard deviation: 160 live channels of ten laboratories have 1.0e-3 or more
RAILS_SHARE = 1e-2  # at the rails
FLAT_BURST = 1.5  # burst ratio of 400 made channels of clipped Gaussian noise: 1.45 at most
USUAL_RANGES_V = (0.01, 1.25, 2.5, 5.0, 10.0)  # the least at the skin, where no EMG is larger; the others amplified
STEPS = 2**15  # either side of zero, of a 16-bit converter; one of 12 bits has a sixteenth of the range at this step
FEWEST_AT_RAIL = 3
OVER_STANDING = Limits(0.1, 100.0, "1")  # who walks has more than a tenth of the EMG of standing
OVER_WALKING = Limits(1 / 30, 30.0, "1")
AGREE = 0.8  # share of the channels
FEWEST = 3  # channels that both trials have
STANDS, SWINGS = slice(10, 56), slice(65, 96)  # % stride
CLEAR = 0.5  # of the logarithm; below it a muscle says nothing
_CALF = re.compile(r"emg_(gas|gasmed|gaslat|gm|gl|sol)_([rl])")
_SHIN = re.compile(r"emg_(ta)_([rl])")


def envelopes(
    emg: Recording, highpass_hz: float = HIGHPASS_HZ, lowpass_hz: float = ENVELOPE_HZ, order: int = 4
) -> Recording:
    """EMG envelope of every channel, at the rate of the recording; raw EMG only, as digitised [V]."""
    file = emg.source.file or "the recording"
    for channel in emg.channels:
        if channel.quantity != "emg":
            raise ChannelError(
                "an EMG envelope must be computed from raw EMG",
                f"{file}: {channel.name!r} is {channel.quantity}",
                "Select the EMG channels, or name the muscle in the study's [channels].",
            )
    if emg.rate_hz <= 2 * highpass_hz:
        raise SamplingError(
            f"for an EMG high-pass of {highpass_hz:g} Hz, the rate must exceed {2 * highpass_hz:g} samples per second",
            f"{file} has {emg.rate_hz:g} samples per second",
            "Export the raw EMG at its full rate (usually 1000 Hz). If this EMG is an envelope, apply a low-pass only.",
        )
    for column, channel in enumerate(emg.channels):
        x = finite_values(emg.values[:, column])
        if len(x) > 100 and x.min() >= 0 and x.std() > 0 and np.median(x) > 0:  # its high-pass would be noise
            raise SamplingError(
                "raw EMG must oscillate about zero",
                f"{file}, {channel.name}: all {len(x)} samples lie between {x.min():.3g} and {x.max():.3g} "
                f"{channel.unit}, and none is below zero",
                "The signal is rectified or an envelope. Apply a low-pass only, or export the raw signal.",
            )
    fast = high_pass(emg, highpass_hz, order)
    return low_pass(fast.with_values(np.abs(fast.values)), lowpass_hz, order)


@dataclass(frozen=True)
class AmplifierRange:
    """Largest voltage that an amplifier can give."""

    volts: float
    how: str  # what it was inferred from
    shown: bool = True  # by the recording itself, in whatever unit it is
    dead_share: float = DEAD_SHARE  # of the range: a smaller standard deviation is no muscle's, bursts or not


def amplifier_range(emg: Recording) -> AmplifierRange:
    """Range of the amplifier, inferred from the recording.

    In this order: the voltage at which channels stop (the largest value of the recording, met three times or more by
    one channel, exactly); 32768 times the quantisation step, which quiet channels show; the smallest usual range
    (1.25, 2.5, 5, 10 V) that holds the largest value.

    >>> from gaitdisc.channel import Channel
    >>> clipped = np.clip(np.random.default_rng(0).normal(size=(999, 1)), -1.25, 1.25)
    >>> amplifier_range(Recording(np.arange(999) / 1000, clipped, (Channel("emg_sol_r", "emg", "V", "r"),))).how
    'the largest value, reached 199 times'
    """
    known = emg.values[:, np.isfinite(emg.values).any(axis=0)]
    values = np.abs(finite_rows(known))
    if not values.size or values.max() == 0:
        return AmplifierRange(USUAL_RANGES_V[0], "assumed: the recording is empty", False)
    top = float(values.max())
    met = int((values > top * (1 - 1e-6)).sum(axis=0).max())
    below = int(((values > 0.95 * top) & (values <= top * (1 - 1e-6))).sum(axis=0).max())
    if met >= FEWEST_AT_RAIL and met > below / 10:  # a rail piles up; the largest value of noise does not
        return AmplifierRange(top, f"the largest value, reached {met} times")
    steps = [step for column in emg.values.T if (step := _quantisation_step(column)) is not None]
    if steps and STEPS * (step := float(np.median(steps))) >= top:
        return AmplifierRange(STEPS * step, f"the quantisation step of {step:.3g} V", dead_share=DEAD_SHARE / 16)
    usual = next((v for v in USUAL_RANGES_V if v >= top), top)
    return AmplifierRange(usual, f"the smallest usual range that contains the largest value, {top:.3g} V", False)


def emg_findings(emg: Recording) -> list[Finding]:
    """Say which channels of raw EMG [V] are dead, unplugged or clipped.

    - dead: the standard deviation is below 0.1 % of the range, or below 0.4 % in a channel whose envelope has no bursts
      (its 99th percentile stays below 3.4 times its median): nothing but the amplifier's noise, or a muscle that rests.
      Bursts count from a sixteenth of 0.1 % on where the range is that of 16 bits with the recording's step.
      Dead, too, is a channel that is clipped and below 0.05 % for most of the time: an electrode that lost contact.
    - unplugged: the standard deviation is above half of the range. Even a Gaussian signal cut off at its own standard
      deviation stays below that after clipping at two; an input without electrodes swings from rail to rail. So does
      one that is clipped in 1 % of the samples and has the envelope of noise.
    - clipped: one sample in a thousand or more lies within 2 % of the range. The channel lives; its peaks are lost.

    The limits were set on the 14 files of young_straight_and_turn, whose manifest lists the live channels; dead ones
    have bursts of at most 3.3, live ones of that size at least 3.5.

    returns: `refused` for dead and unplugged channels: leave them out. `warning` for clipped ones
    """
    limit = amplifier_range(emg)
    findings = []
    for column, channel in enumerate(emg.channels):
        x = emg.values[:, column]
        known = finite_values(x)
        if not len(known):
            continue  # an empty channel is a gap from end to end
        share = float(known.std()) / limit.volts
        at_rail = np.abs(x) >= AT_RAIL_SHARE * limit.volts
        rail = f"range of {limit.volts:.3g} V ({limit.how})"
        top, bottom = known.max(), known.min()  # a muscle meets each once: an input that stops before the others do
        ends = (x >= top - 1e-6 * (top - bottom)) | ((x <= bottom + 1e-6 * (top - bottom)) & (bottom < 0))
        if ends.mean() >= RAILS_SHARE > at_rail.mean():
            at_rail, rail = ends, f"limits in this channel, {bottom:.3g} and {top:.3g} V"
        size = f"the standard deviation is {1e3 * known.std():.3g} mV, {100 * share:.2g} % of the amplifier's"
        at_rails = f"{100 * at_rail.mean():.2g} % of the samples are at the amplifier's {rail}"
        clipped = at_rail.mean() >= CLIPPED_SHARE
        silent = robust_sd(known) / limit.volts
        if clipped and silent < SILENT_SHARE <= share:
            noise_mv = 1e3 * silent * limit.volts
            kind = "dead"
            what = f"{at_rails}; the other samples are only noise (robust standard deviation {noise_mv:.3g} mV)"
        elif share < WEAK_SHARE and (share < limit.dead_share or burst_ratio(x, emg.rate_hz) < BURST):
            least = DEAD_SHARE if share < DEAD_SHARE else WEAK_SHARE
            bursts = "" if share < limit.dead_share else " or bursts"
            kind = "dead"
            what = f"{size} {rail}; a connected channel has at least {100 * least:g} %{bursts}"
        elif share > UNPLUGGED_SHARE:
            kind = "unplugged"
            what = f"{size} {rail}; no muscle exceeds 50 %"
        elif at_rail.mean() >= RAILS_SHARE and burst_ratio(x, emg.rate_hz) < FLAT_BURST:
            kind = "unplugged"
            what = f"{at_rails}, without bursts between these samples"
        elif clipped:
            kind = "clipped"
            what = at_rails
        else:
            continue
        spoils = "the peaks of the envelope there" if kind == "clipped" else "the channel, which is excluded"
        spans = spans_s(emg.time, at_rail) if kind == "clipped" else ()
        severity = "warning" if kind == "clipped" else "refused"
        findings.append(Finding(severity, kind, emg.source.file, what, spoils, channel=channel.name, spans=spans))
    return findings


def burst_ratio(x: Values, rate_hz: float) -> float:
    """How far bursts rise above the rest: 99th percentile of the envelope over its median.

    x (time,) [V]: raw EMG of one channel
    returns: 0 where less than a second was recorded, which shows no burst; infinite where the rate (80 Hz or below)
        allows no envelope, so that nothing is refused for it

    >>> noise = np.random.default_rng(0).normal(size=4000)
    >>> bursts = noise * np.where(np.arange(4000) % 1000 < 250, 10, 1)
    >>> round(burst_ratio(noise, 1000.0), 1), round(burst_ratio(bursts, 1000.0), 1)
    (1.2, 11.4)
    """
    if rate_hz <= 2 * HIGHPASS_HZ:
        return float("inf")
    if np.isfinite(x).sum() < rate_hz:
        return 0.0
    raw = Recording(np.arange(len(x)) / rate_hz, x[:, None], (Channel("emg", "emg", "V"),))
    fast = high_pass(raw)
    envelope = low_pass(fast.with_values(np.abs(fast.values)), ENVELOPE_HZ)
    trusted = envelope.values[~np.asarray(envelope.suspect)]
    return float(np.percentile(trusted, 99) / np.median(trusted)) if len(trusted) else 0.0


def live_channels(emg: Recording) -> tuple[str, ...]:
    """Names of the channels of raw EMG that carry a muscle's signal, in order."""
    lost = {finding.channel for finding in emg_findings(emg) if finding.severity == "refused"}
    empty = {name for name in emg.names if not np.isfinite(emg[name]).any()}
    return tuple(name for name in emg.names if name not in lost | empty)


def _quantisation_step(x: Values) -> float | None:
    """Step between neighbouring values of a channel that uses few of them; None for a filtered one."""
    known = finite_values(x)
    most = float(np.abs(known).max(initial=0.0)) or 1.0
    levels = most * np.unique(np.round(known / most, 7))
    if len(levels) < 10 or len(levels) > len(known) / 4:
        return None
    steps = np.diff(levels)
    step = float(np.median(steps))
    even = np.abs(steps / step - np.round(steps / step)) < 0.1
    return step if step > 0 and even.mean() > 0.8 else None


def emg_sizes(emg: Recording) -> dict[str, float]:
    """Standard deviation of each channel that has one [V]; without dead and unplugged ones, which have no unit to show.

    The amplifier's range separates them, and only where the recording shows it: a usual range would depend on the unit.
    """
    sizes = {name: float(np.nanstd(emg[name])) for name in emg.names if np.isfinite(emg[name]).any()}
    limit = amplifier_range(emg)
    least, most = (DEAD_SHARE * limit.volts, UNPLUGGED_SHARE * limit.volts) if limit.shown else (0.0, np.inf)
    return {name: size for name, size in sizes.items() if size > least and size <= most}


def other_unit_findings(
    sizes: Mapping[str, float], others: Mapping[str, float], usual: Limits, trial: str, other: str
) -> list[Finding]:
    """Say that EMG of a trial is so much weaker or stronger than that of another that one states a wrong unit.

    sizes, others: of `emg_sizes`; the channels in common are compared
    usual: ratios that need no other unit
    """
    common = sorted(set(sizes) & set(others))
    if len(common) < FEWEST:
        return []
    ratios = np.array([sizes[name] / others[name] for name in common])
    weak, strong = float(np.mean(ratios < usual.least)), float(np.mean(ratios > usual.most))
    if max(weak, strong) < AGREE:
        return []
    ratio = float(np.median(ratios))
    how, looks, stated = f"{ratio:.0f} times stronger", "mV", "V"
    if ratio < 1:
        how, looks, stated = f"{1 / ratio:.0f} times weaker", "V", "mV"
    what = (
        f"EMG is {how} than in {other} (median of {len(common)} channels). The values seem to be in {looks} instead of "
        f"{stated}, or those of {other} in {stated} instead of {looks}"
    )
    return [Finding("warning", "EMG unit", trial, what, "EMG; state the unit in [channels], or export the file again")]


def stance_over_swing(envelope: Recording, strides: Strides, name: str) -> float:
    """Natural logarithm of a channel's mean in stance over that in swing; NaN without a whole stride."""
    curves = finite_rows(strides.normalised(envelope.selected([name]))[:, :, 0])
    if not len(curves):
        return float("nan")
    mean = curves.mean(axis=0)
    stands, swings = float(mean[STANDS].mean()), float(mean[SWINGS].mean())
    return float(np.log(stands / swings)) if min(stands, swings) > 0 else float("nan")


class _Muscle(NamedTuple):
    """When a muscle of a leg works, as natural logarithms of stance over swing."""

    name: str
    by_both: float  # by the steps of both feet, of which one swings while the other stands
    by_own: float  # by those of its own foot

    def words(self) -> str:
        """Say while what it is stronger."""
        where = ("on the ground", "in the air")[:: 1 if self.by_own > 0 else -1]
        return f"{self.name} is {np.exp(abs(self.by_own)):.1f} times as strong with the foot {' as '.join(where)}"


def order_of_muscles(envelope: Recording, strides: Mapping[str, Strides]) -> list[Finding]:
    """Say that calf and tibialis anterior of a leg, or the calves of both legs, are exchanged.

    A muscle alone is not tested: a foot that drops or a calf that is spastic has its own course. Two that each do what
    the other should are. Each is held against the steps of both feet, of which one swings while the other stands.
    """
    muscles: dict[tuple[str, str], _Muscle] = {}
    for name in envelope.names:
        for kind, pattern in (("calf", _CALF), ("shin", _SHIN)):
            match = pattern.fullmatch(name)
            if match and match[2] in strides:
                by_foot = {side: stance_over_swing(envelope, cut, name) for side, cut in strides.items()}
                own_ratio, other_ratio = by_foot[match[2]], by_foot.get(other_side(match[2]), np.nan)
                value = (own_ratio - other_ratio) / 2 if np.isfinite(other_ratio) else own_ratio
                worst = muscles.get((kind, match[2]))
                if np.isfinite(value) and (worst is None or value > worst.by_both):
                    muscles[kind, match[2]] = _Muscle(name, value, own_ratio)
    calf_swings = {side for (kind, side), muscle in muscles.items() if kind == "calf" and muscle.by_both < -CLEAR}
    shin_stands = {side for (kind, side), muscle in muscles.items() if kind == "shin" and muscle.by_both > CLEAR}
    pairs = [(muscles["calf", side], muscles["shin", side]) for side in sorted(calf_swings & shin_stands)]
    if calf_swings == {"l", "r"} and not shin_stands:
        pairs.append((muscles["calf", "l"], muscles["calf", "r"]))
    findings = []
    for first, second in pairs:
        what = f"{first.name} and {second.name} seem to be exchanged, or left and right muscles"
        what += f": {first.words()}, {second.words()}"
        file, both = envelope.source.file, f"{first.name}, {second.name}"
        findings.append(Finding("warning", "exchanged EMG", file, what, "both muscles; correct the labels", both))
    return findings
