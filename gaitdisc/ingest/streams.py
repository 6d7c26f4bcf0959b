"""Columns of one file, sorted into the streams of a trial; a missing force is refused, other gaps are reported."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, ReadError, SamplingError
from gaitdisc.recording import Finding, Recording, Source, Trial

SLOWEST_S = 0.2  # between samples: people make up to 2.5 steps a second, which fewer than 5 Hz cannot show (Nyquist)
FEW = 50  # samples, of which fewer are no recording of a walk
_STREAM = {
    "angle": "kinematics",
    "translation": "kinematics",
    "marker": "markers",
    "emg": "emg",
    "force": "forces",
    "vertical_force": "forces",
    "pressure_centre": "forces",
    "moment": "moments",
    "power": "moments",
    "signal": "signals",
}


def stream_of(channel: Channel) -> str:
    """Stream that a channel belongs to.

    channel: a free moment of the ground goes with the ground forces, the generalised force of a pelvis translation
        with the joint moments

    >>> stream_of(Channel("ground_torque_r_y", "moment", "N m", "r"))
    'forces'
    >>> stream_of(Channel("pelvis_tx_force", "force", "N"))
    'moments'
    """
    if channel.quantity == "moment" and "ground" in channel.name:
        return "forces"
    if channel.quantity == "force" and channel.name.endswith("_force"):
        return "moments"
    return _STREAM[channel.quantity]


def sorted_trial(
    source: Source,
    time: NDArray[np.float64],
    values: NDArray[np.float64],
    channels: Sequence[Channel],
    findings: Sequence[Finding] = (),
) -> Trial:
    """Trial of one file whose columns share one time base.

    time (time,) [s]: even
    values (time, channel) [each channel's unit]: converted already

    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> list(sorted_trial(Source("a.mot"), np.arange(3.0), np.zeros((3, 1)), [knee]).streams)
    ['kinematics']
    """
    _check_names(channels, source.file)
    _refuse_missing_force(time, values, channels, source.file)
    _refuse_slow_walk(time, channels, source.file)
    columns: dict[str, list[int]] = {}
    for i, channel in enumerate(channels):
        columns.setdefault(stream_of(channel), []).append(i)
    streams = {
        key: Recording(time, values[:, chosen], tuple(channels[i] for i in chosen), source=source)
        for key, chosen in columns.items()
    }
    name = source.file.rpartition(".")[0] or source.file
    return Trial(name, streams, findings=tuple(findings))


def _check_names(channels: Sequence[Channel], file: str) -> None:
    names = [channel.name for channel in channels]
    doubled = next((name for name in names if names.count(name) > 1), None)
    if doubled:
        first, second = [i + 2 for i, name in enumerate(names) if name == doubled][:2]
        raise ChannelError(
            "each channel needs a column of its own",
            f"{file} has {doubled!r} in columns {first} and {second}",
            "Remove one of them, or name them differently in the study's [channels].",
        )


def _refuse_slow_walk(time: NDArray[np.float64], channels: Sequence[Channel], file: str) -> None:
    """Refuse a walk that was sampled too slowly to show a step: its times are mostly ms under the name of seconds."""
    measured = next((one.name for one in channels if one.quantity not in ("signal", "translation")), None)
    step_s = float(time[1] - time[0]) if len(time) >= FEW else 0.0
    if measured and step_s > SLOWEST_S:
        raise SamplingError(
            f"{file}: {measured} of a walk needs a sample every {SLOWEST_S:g} s or more often",
            f"times are {step_s:g} s apart, and {len(time)} samples would last {len(time) * step_s / 3600:.3g} h",
            "If they are ms, name the column 'time [ms]'.",
        )


def _refuse_missing_force(
    time: NDArray[np.float64], values: NDArray[np.float64], channels: Sequence[Channel], file: str
) -> None:
    for i, channel in enumerate(channels):
        missing = np.isnan(values[:, i])
        if channel.quantity in ("force", "vertical_force") and missing.any():
            first = int(np.argmax(missing))
            raise ReadError(
                f"{file}: {channel.name} needs a number in every sample",
                f"{missing.sum()} of {len(time)} are missing, first in sample {first + 1} at t = {time[first]:.6g} s",
                "Export the force again without gaps (0 where the foot is in the air).",
            )
