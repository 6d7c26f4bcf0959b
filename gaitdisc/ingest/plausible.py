"""What a quantity can be: values beyond `data_schema/ranges.csv` and stretches that stand still are taken out.

Knees bend one way: flexion is positive inside, and a knee that a file counts the other way is turned.
"""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, schema_folder, vocabulary
from gaitdisc.errors import ReadError
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Values, finite_rows, finite_values, runs, spans_s

JOINTS = ("angle", "translation")
CHANCE = 1e-6  # of a stretch that repeats one value, with the channel's own share of repeated samples; no false one in
FEWEST_REPEATS = 3  # 4,000 made channels (smooth, noisy, quantised, held, clamped), tests/ingest/test_plausible.py
LEGS = re.compile("(pelvis|hip|knee|ankle|subtalar|foot)_")  # a model holds arms that no marker shows
LEAP_TIMES = 3.0  # of the three steps beyond the edge of a stretch: a joint that turns slows down before it and after
OFF_LEAP, FOOT_N = 0.2, 50.0  # of the largest force, and at least, in one sample: no foot loses and gains as much
SHORTEST_SWING_S = 0.3
FEW = 0.01  # of the samples; where EMG is beyond its range more often, it is counted by a converter
BENT_DEG = 30.0  # no knee is hyperextended that far, so it was flexed
HYPEREXTENDED_DEG = 25.0  # what a lax knee or an offset of the model may show on the other side
FEWEST = 20  # samples of a knee
_PLATE = re.compile(r"plate_\d+(?=_)")
_KNEE = re.compile(r"knee_angle_[rl](_beta)?")
_MOVES = re.compile(r"(knee_angle_[rl](?:_beta)?)(/speed|/accel|_moment|_force)")
_GENERALISED = ("mot", "sto")  # OpenSim: the moment belongs to the coordinate and has its sign


@dataclass(frozen=True)
class PlausibleRange:
    """Least and largest value that a quantity can have."""

    quantity: str
    unit: str
    channels: str  # pattern of their names; empty for all
    low: float
    high: float

    def covers(self, channel: Channel) -> bool:
        """Whether a channel is meant."""
        meant = (channel.quantity, channel.unit) == (self.quantity, self.unit)
        return meant and (not self.channels or re.fullmatch(self.channels, channel.name) is not None)


@cache
def plausible_ranges() -> tuple[PlausibleRange, ...]:
    """Ranges of `data_schema/ranges.csv`, in its order: the first that covers a channel holds."""
    with (schema_folder() / "ranges.csv").open(newline="", encoding="utf-8") as file:
        _, *rows = csv.reader(file)
    return tuple(PlausibleRange(row[0], row[1], row[2], float(row[3]), float(row[4])) for row in rows)


def without_impossible(
    streams: Mapping[str, Recording], begin_s: Mapping[str, float] | None = None
) -> tuple[dict[str, Recording], list[Finding]]:
    """Streams in which values beyond the range of their quantity are missing, and which they were.

    EMG of which a channel is often beyond the range is in another unit than the file states. It is left and named: its
    course is right, its amplitude is not.

    begin_s: time of the file's first frame of each stream, where the streams are a part of the file [s]
    returns findings: one for each channel, with the first such frame, its number and its unit
    """
    cleaned: dict[str, Recording] = {}
    findings: list[Finding] = []
    for key, recording in streams.items():
        beyond = np.zeros(recording.values.shape, bool)
        ranges = {}
        for place, channel in enumerate(recording.channels):
            limits = next((limit for limit in plausible_ranges() if limit.covers(channel)), None)
            if limits is not None:
                values, ranges[place] = recording.values[:, place], limits
                beyond[:, place] = (values < limits.low) | (values > limits.high)  # NaN is neither
        counted = [i for i, c in enumerate(recording.channels) if c.quantity == "emg" and beyond[:, i].any()]
        if any(beyond[:, i].mean() > FEW for i in counted):
            for i in counted:
                channel, high = recording.channels[i], ranges[i].high
                most = float(np.nanmax(np.abs(recording.values[:, i])))
                thousandth = channel.unit == "V" and most <= 1e3 * high
                looks = "it seems to be in mV or counts" if thousandth else "it may be in counts"
                what = f"reaches {most:.6g} {channel.unit}, but EMG stays within {high:g} {channel.unit}, so {looks}"
                spoils = "the amplitude; state the unit in the file or in [channels]"
                findings.append(Finding("warning", "unit", recording.source.file, what, spoils, channel.name))
            beyond[:, counted] = False
        before_s = recording.time[0] - (begin_s or {}).get(key, recording.time[0]) if len(recording.time) else 0.0
        frames = round(before_s * recording.rate_hz) if before_s else 0
        plates = [match[0] if (match := _PLATE.match(channel.name)) else "" for channel in recording.channels]
        lost: set[str] = set()
        for place in np.flatnonzero(beyond.any(axis=0)).tolist():
            lost |= {plates[place]} - {""}
            others = bool({*plates} - lost - {""})
            findings.append(_finding(recording, place, ranges[place], beyond[:, place], frames, others))
        known = recording.with_values(np.where(beyond, np.nan, recording.values)) if beyond.any() else recording
        rest = [channel.name for channel, plate in zip(known.channels, plates, strict=True) if plate not in lost]
        cleaned[key] = known.selected(rest) if lost else known
    return cleaned, findings


def without_frozen(streams: Mapping[str, Recording]) -> tuple[dict[str, Recording], list[Finding]]:
    """Streams in which stretches that repeat one value are missing, and which they were.

    A lost marker is often filled by its last place or by zeros. A stretch of n repeats counts where chance, with the
    share p of repeats elsewhere in the channel, would give it with p^n N < 1e-6; in a quantised channel, which also
    repeats where it turns, where it ends in a leap. A value that a model clamps at is met often and without a leap, a
    locked coordinate repeats throughout: both stay. Vertical forces rest at zero, unless they leap to it and back.

    returns findings: one for each channel or marker, with its first such stretch
    """
    cleaned: dict[str, Recording] = {}
    findings: list[Finding] = []
    for key, recording in streams.items():
        still = np.zeros(recording.values.shape, bool)
        groups: dict[str, list[int]] = {}  # columns that are lost together: a marker, a plate, an angle
        for place, channel in enumerate(recording.channels):
            if channel.quantity == "marker" or key == "forces":
                groups.setdefault(re.sub("[._][^._]*$", "", channel.name), []).append(place)
            elif channel.name in vocabulary().by_name and channel.quantity in JOINTS and LEGS.match(channel.name):
                groups[channel.name] = [place]
        for columns in map(np.array, groups.values()):
            load = [int(at) for at in columns if recording.channels[at].quantity == "vertical_force"]
            here = _mark_dropped(recording, load) if key == "forces" else _frozen(recording.values[:, columns])
            if here.any():
                still[np.ix_(here, columns)] = True
                place = (load or columns)[0]
                channel, spans = recording.channels[place], spans_s(recording.time, here)
                marker, others = channel.quantity == "marker", len(spans) - 1
                value = f"{recording.values[int(np.argmax(here)), place]:.4g} {channel.unit}"
                more = f", and in {others} more stretch{'es' if others > 1 else ''}" if others else ""
                what = f"is constant at {'one place' if marker else value} from {spans[0].start:.3f} to "
                what += f"{spans[0].end:.3f} s{more}: too long for a measurement; these samples count as missing"
                name, file = channel.name.removesuffix(".x") if marker else channel.name, recording.source.file
                spoils = "these frames; fill the gap"
                findings.append(Finding("warning", "frozen", file, what, spoils, name, spans=spans))
        cleaned[key] = recording.with_values(np.where(still, np.nan, recording.values)) if still.any() else recording
    return cleaned, findings


def _frozen(x: Values) -> NDArray[np.bool_]:
    """Samples that repeat a value beyond chance; x (time, axis)."""
    marks = np.zeros(len(x), bool)
    move = np.abs(np.diff(x, axis=0)).max(axis=1)
    same = move == 0
    if same.sum() < FEWEST_REPEATS or not (move > 0).any():
        return marks
    step = move[move > 0]
    grid = float(step.min())
    coarse = grid > 1e-6 * float(np.nanmax(np.ptp(finite_rows(x), axis=0)))
    quantised = coarse and bool(np.mean(np.abs(step / grid - np.rint(step / grid)) < 0.1) > 0.9)
    spans = runs(same)
    for start, end in spans:
        count = end - start
        leap = any(
            len(beyond) > 1 and beyond[0] > LEAP_TIMES * np.nanmax(beyond[1:], initial=grid)
            for beyond in (move[max(0, start - 4) : start][::-1], move[end : end + 4])
        )
        chance = ((same.sum() - count + 1) / len(same)) ** count * len(same)
        extreme = x.shape[1] == 1 and x[start, 0] in (np.nanmin(x), np.nanmax(x))
        clamped = extreme or (x[spans[:, 0]] == x[start]).all(axis=1).sum() > 1
        if count >= FEWEST_REPEATS and (leap or not (quantised or clamped)) and chance < CHANCE:
            marks[start : end + 1] = True
    return marks


def _mark_dropped(forces: Recording, columns: Sequence[int]) -> NDArray[np.bool_]:
    """Samples at exactly zero that a vertical force leaps to and back from, sooner than a foot comes back."""
    marks = np.zeros(len(forces.time), bool)
    for load in np.abs(forces.values[:, columns]).T:
        least = max(OFF_LEAP * np.nanmax(load, initial=0.0), FOOT_N)
        for start, end in runs(load == 0).tolist():
            short = end - start < SHORTEST_SWING_S * forces.rate_hz
            if start > 0 and end < len(load) and short and min(load[start - 1], load[end]) > least:
                marks[start:end] = True
    return marks


def _finding(
    recording: Recording, place: int, limits: PlausibleRange, beyond: NDArray[np.bool_], before: int, other_plates: bool
) -> Finding:
    """First value beyond the range, with its frame in the file, and how many there are; a force is refused."""
    channel, first, file = recording.channels[place], int(np.argmax(beyond)), recording.source.file
    count, unit = int(beyond.sum()), "" if channel.unit == "1" else f" {channel.unit}"
    more = f", as {'is' if count == 2 else 'are'} {count - 1} more of {len(beyond)} frames" if count > 1 else ""
    where = (
        f"{recording.values[first, place]:.6g}{unit} in frame {before + first + 1} (t = {recording.time[first]:.6g} "
        f"s) is outside the possible range, {limits.low:g} to {limits.high:g}{unit}{more}"
    )
    if other_plates and _PLATE.match(channel.name):
        spoils = "the plate, which is excluded; zero the plate, or correct the value or its unit, and export again"
        return Finding("refused", "out of range", file, where, spoils, channel.name)
    if channel.quantity in ("force", "vertical_force") and channel.unit == "N":
        raise ReadError(
            f"{file}: {channel.name} must have a plausible force in every sample",
            where,
            "Correct the cell or the unit and export the force again.",
        )
    most = "the entire channel, whose unit or name is probably wrong"
    spoils = most if beyond.mean() > 0.5 else "these frames"
    spans, what = spans_s(recording.time, beyond), f"{where}; all samples outside this range are treated as missing"
    return Finding("warning", "out of range", file, what, f"{spoils}; correct the file", channel.name, spans=spans)


def with_flexion_positive(streams: Mapping[str, Recording]) -> tuple[dict[str, Recording], list[Finding]]:
    """Streams with knee flexion positive, and what was turned.

    A knee bends to one side only. Where its angle goes beyond 30 deg one way and stays within 25 deg the other way
    (the central 98 % of the samples), the wide side is flexion: where that is the negative one, as in gait2392, the
    channel is turned, and with it its speed, its acceleration and OpenSim's generalised moment of that coordinate. A
    knee that hardly bends follows the other knee of the trial. One that goes beyond both is left and named.
    """
    kinematics = streams.get("kinematics")
    if kinematics is None:
        return dict(streams), []
    knees = [
        c.name for c in kinematics.channels if _KNEE.fullmatch(c.name) and (c.quantity, c.unit) == ("angle", "deg")
    ]
    finite = {name: finite_values(kinematics[name]) for name in knees}
    reaches = {
        name: tuple(np.quantile(values, [0.01, 0.99]).tolist()) if len(values) >= FEWEST else (0.0, 0.0)
        for name, values in finite.items()
    }
    senses = {name: _sense(*reach) for name, reach in reaches.items()}
    proven = {sense for sense in senses.values() if sense}
    turned = [name for name, sense in senses.items() if sense == -1 or (sense == 0 and proven == {-1})]
    spans = {name: f"ranges from {low:.0f} to {high:.0f} deg" for name, (low, high) in reaches.items()}
    file, findings = kinematics.source.file, []
    for name in (name for name, sense in senses.items() if sense is None):
        what = (
            f"{spans[name]}; a knee bends beyond {HYPEREXTENDED_DEG:g} deg in one direction only, so the sign of this "
            "angle is unknown and was not changed"
        )
        spoils = "results that depend on the knee; correct the file, or exclude the damaged part with crop_s"
        findings.append(Finding("warning", "knee sign", file, what, spoils, name))
    if not turned:
        return dict(streams), findings
    moved = {key: _turn(recording, turned) for key, recording in streams.items()}
    for name in turned:
        others = [c for key in moved for c in moved[key][1] if _of_knee(c) == name and c != name]
        why = ", so flexion is negative in this file" if senses[name] == -1 else " and takes the sign of the other knee"
        also = f"; the same holds for {', '.join(others)}" if others else ""
        what = f"{name} {spans[name]}{why}; its sign was reversed, so that flexion is positive{also}"
        findings.append(Finding("note", "knee sign", file, what, "", name))
    if proven == {1, -1}:
        same, other = (", ".join(name for name, sense in senses.items() if sense == way) for way in (1, -1))
        what = (
            f"flexion is positive in {same} and negative in {other} of this file; only the sign of {other} was reversed"
        )
        findings.append(Finding("warning", "knee sign", file, what, "knee angles if this is wrong; correct the file"))
    return {key: recording for key, (recording, _) in moved.items()}, findings


def _sense(low: float, high: float) -> int | None:
    """+1 where flexion is positive, -1 where it is negative, 0 where the knee hardly bends, None where it cannot be."""
    if max(-low, high) < BENT_DEG:
        return 0
    if min(-low, high) > HYPEREXTENDED_DEG:
        return None
    return 1 if high > -low else -1


def _of_knee(name: str) -> str:
    match = _MOVES.fullmatch(name)
    return match[1] if match else name


def _turn(recording: Recording, knees: list[str]) -> tuple[Recording, list[str]]:
    signs, names = np.ones(len(recording.channels)), []
    generalised = set(recording.source.reader.split(" + ")) <= set(_GENERALISED)
    for place, channel in enumerate(recording.channels):
        if _of_knee(channel.name) in knees and (channel.quantity != "moment" or generalised):
            signs[place] = -1.0
            names.append(channel.name)
    return (replace(recording, values=recording.values * signs) if names else recording), names
