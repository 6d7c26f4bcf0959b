"""What a quantity can be: values beyond `data_schema/ranges.csv` are taken out before anything is filtered."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, schema_folder
from gaitdisc.errors import ReadError
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.runs import spans_s

FEW = 0.01  # of the samples; where EMG is beyond its range more often, it is counted by a converter


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

    >>> knee = np.array([[10.0], [1e6], [30.0]])
    >>> walk = Recording(np.arange(3) / 100, knee, (Channel("knee_angle_r", "angle", "deg", "r"),))
    >>> kept, findings = without_impossible({"kinematics": walk})
    >>> kept["kinematics"].values[:, 0].tolist(), findings[0].kind
    ([10.0, nan, 30.0], 'out of range')
    """
    kept: dict[str, Recording] = {}
    findings: list[Finding] = []
    for key, recording in streams.items():
        beyond = np.zeros(recording.values.shape, bool)
        for place, channel in enumerate(recording.channels):
            limits = _limits(channel)
            if limits is None:
                continue
            values = recording.values[:, place]
            beyond[:, place] = (values < limits.low) | (values > limits.high)  # NaN is neither
        counted = [i for i, c in enumerate(recording.channels) if c.quantity == "emg" and beyond[:, i].any()]
        if any(beyond[:, i].mean() > FEW for i in counted):
            findings += [_other_unit(recording, i) for i in counted]
            beyond[:, counted] = False
        before_s = recording.time[0] - (begin_s or {}).get(key, recording.time[0]) if len(recording.time) else 0.0
        frames = round(before_s * recording.rate_hz) if before_s else 0
        for place in np.flatnonzero(beyond.any(axis=0)).tolist():
            findings.append(_finding(recording, place, beyond[:, place], frames))
        kept[key] = recording.with_values(np.where(beyond, np.nan, recording.values)) if beyond.any() else recording
    return kept, findings


def _limits(channel: Channel) -> PlausibleRange | None:
    return next((one for one in plausible_ranges() if one.covers(channel)), None)


def _other_unit(recording: Recording, place: int) -> Finding:
    channel = recording.channels[place]
    limits = _limits(channel)
    assert limits is not None  # it was found beyond them
    most = float(np.nanmax(np.abs(recording.values[:, place])))
    thousandth = channel.unit == "V" and most <= 1e3 * limits.high
    looks = "it looks like mV, or these may be counts" if thousandth else "these may be counts"
    what = f"reaches {most:.6g} {channel.unit}; EMG in {channel.unit} is within {limits.high:g}, so {looks}"
    spoils = "its amplitude; state the unit in the file or in [channels]"
    return Finding("warning", "unit", recording.source.file, what, spoils, channel.name)


def _finding(recording: Recording, place: int, beyond: NDArray[np.bool_], before: int) -> Finding:
    """First value beyond the range, with its frame in the file, and how many there are; a force is refused."""
    channel, first, file = recording.channels[place], int(np.argmax(beyond)), recording.source.file
    limits = _limits(channel)
    assert limits is not None  # it was found beyond them
    count, unit = int(beyond.sum()), "" if channel.unit == "1" else f" {channel.unit}"
    more = f", as {'is' if count == 2 else 'are'} {count - 1} more of {len(beyond)} frames" if count > 1 else ""
    where = (
        f"{recording.values[first, place]:.6g}{unit} in frame {before + first + 1} (t = {recording.time[first]:.6g} s) "
        f"is beyond what it can be, {limits.low:g} to {limits.high:g}{unit}{more}"
    )
    if channel.quantity in ("force", "vertical_force") and channel.unit == "N":
        raise ReadError(
            f"{file}: {channel.name} needs a plausible force in every sample",
            where,
            "Correct the cell or the unit and export the force again.",
        )
    spoils = "the unit or the name of the channel, if most of it is" if beyond.mean() > 0.5 else "these frames"
    spans, what = spans_s(recording.time, beyond), f"{where}; taken as missing"
    return Finding("warning", "out of range", file, what, f"{spoils}; correct the file", channel.name, spans)
