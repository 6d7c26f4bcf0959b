"""A C3D file of analog channels: EMG and forces as a motion capture system exports them, angles apart."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from gaitdisc.errors import SamplingError
from gaitdisc.ingest.columns import check_written_names
from gaitdisc.recording import Recording
from gaitdisc.whole_file import write_whole

FRAME_HZ = 100.0
MOST_FRAMES = 65_534  # 16 bits; ezc3d reads no more of a file without points, whatever TRIAL:ACTUAL_END_FIELD says


def write_c3d(recordings: Sequence[Recording], path: Path | str) -> Path:
    """Write recordings of one clock as the analog channels of a C3D file, whole or not at all.

    The file has frames at 100 Hz without points, a whole number of analog samples in each, and 32-bit floats. Time
    begins at 0 in it. A muscle's name tells the reader that a channel is EMG; that another is a ground force the
    study's `[channels]` must say (`"ground_force_r_vy" = "ground_force_r_vy [N]"`), as for any treadmill that is no
    force plate.

    Parameters
    ----------
    recordings : sequence of Recording
        With the same time base, of a multiple of 100 Hz; samples of a last frame that is not whole are left away.
    path : Path or str
        `.c3d` file to write.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    SamplingError
        If the recordings differ in time base, do not begin at 0 s, or their rate is no multiple of 100 Hz, or they last
        more than 655 s.
    ChannelError
        If a name holds a tab, a line break or a blank at its ends.
    WriteError
        If the file cannot be written.

    References
    ----------
    The C3D file format, c3d.org: ANALOG:LABELS, ANALOG:UNITS, ANALOG:RATE.

    Examples
    --------
    >>> write_c3d([emg, forces], "walk.c3d")  # doctest: +SKIP
    PosixPath('walk.c3d')
    """
    import ezc3d

    path = Path(path)
    samples = _samples_per_frame(recordings, path.name)
    channels = [channel for recording in recordings for channel in recording.channels]
    check_written_names([channel.name for channel in channels], path.name)
    values = np.hstack([recording.values for recording in recordings])
    values = values[: len(values) - len(values) % samples]
    frames = len(values) // samples
    if frames > MOST_FRAMES:
        raise SamplingError(
            f"a C3D file of {FRAME_HZ:g} frames a second holds {MOST_FRAMES / FRAME_HZ:g} s at most",
            f"{path.name} would last {frames / FRAME_HZ:g} s",
            "Write a shorter part, or a table.",
        )
    file = ezc3d.c3d()
    settings = {
        ("POINT", "RATE"): [FRAME_HZ],
        ("POINT", "UNITS"): ["m"],
        ("ANALOG", "RATE"): [FRAME_HZ * samples],
        ("ANALOG", "LABELS"): [channel.name for channel in channels],
        ("ANALOG", "UNITS"): [channel.unit for channel in channels],
    }
    for (group, name), value in settings.items():
        file.add_parameter(group, name, value)
    file["data"]["points"] = np.empty((4, 0, frames))
    file["data"]["analogs"] = np.ascontiguousarray(values.T)[None]
    with tempfile.TemporaryDirectory() as folder:
        written = Path(folder) / "whole.c3d"
        file.write(str(written))
        return write_whole(path, written.read_bytes())


def _samples_per_frame(recordings: Sequence[Recording], file: str) -> int:
    needed = f"the analog channels of {file} need one time base, from 0 s on, of a multiple of {FRAME_HZ:g} Hz"
    first = recordings[0]
    for other in recordings[1:]:
        if not np.array_equal(other.time, first.time):
            found = f"{first.names[0]} has {len(first.time)} samples at {first.rate_hz:g} Hz, {other.names[0]} has "
            found += f"{len(other.time)} at {other.rate_hz:g} Hz"
            raise SamplingError(needed, found, "Bring them to one time base first.")
    samples = round(first.rate_hz / FRAME_HZ)
    if samples < 1 or abs(samples * FRAME_HZ - first.rate_hz) > 1e-6 * first.rate_hz or abs(first.time[0]) > 1e-9:
        found = f"{first.names[0]} begins at {first.time[0]:g} s and has {first.rate_hz:g} Hz"
        raise SamplingError(needed, found, "Resample it, or write a table.")
    return samples
