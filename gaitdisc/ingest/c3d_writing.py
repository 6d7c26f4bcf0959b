"""A C3D file of markers, force plates, EMG and other analog channels, as a motion capture system exports them."""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.ingest.columns import check_written_names
from gaitdisc.ingest.force_plates import ForcePlate
from gaitdisc.recording import Recording, Surface
from gaitdisc.whole_file import write_whole

FRAME_HZ = 100.0
WHOLE = ("USED", "TYPE", "ZERO", "CHANNEL")
MOST_FRAMES = 65_534  # 16 bits; ezc3d reads no more of a file without points, whatever TRIAL:ACTUAL_END_FIELD says


def write_c3d(recordings: Sequence[Recording], path: Path | str, surfaces: Sequence[Surface] = ()) -> Path:
    """Write recordings of one clock to a C3D file, whole or not at all.

    Markers become points; all else becomes analog channels. Without markers the file has frames at 100 Hz without
    points. Every frame has a whole number of analog samples, all numbers are 32-bit floats, and time begins at 0. A
    muscle's name marks a channel as EMG for the reader. Forces become a force plate where their surface is given;
    that another channel is a ground force the study's `[channels]` must say (`"ground_force_r_vy" =
    "ground_force_r_vy [N]"`), as for any treadmill that is no force plate.

    recordings: one of markers, or none; the others with one time base, of a multiple of the markers' rate or of 100
        Hz. Samples of a last frame that is not whole are left away
    surfaces: force plates, of type 2: `<name>_fx`, `_fy`, `_fz` [N] and `_mx`, `_my`, `_mz` [N m] among the channels
        are the force on the foot and its moment about the centre of the surface, in the laboratory's axes. They are
        read back as `plate_1_fx` and on, in the order of the surfaces
    Source: The C3D file format, c3d.org: POINT, ANALOG, FORCE_PLATFORM of type 2.
    """
    import ezc3d

    path = Path(path)
    markers, analog = _apart(recordings, surfaces, path.name)
    frame_hz = markers.rate_hz if markers is not None else FRAME_HZ
    samples = _samples_per_frame(analog, frame_hz, path.name) if analog else 1
    channels = [channel for recording in analog for channel in recording.channels]
    check_written_names([channel.name for recording in recordings for channel in recording.channels], path.name)
    values = np.hstack([recording.values for recording in analog]) if analog else np.empty((MOST_FRAMES + 1, 0))
    frames = len(values) // samples
    frames = min(frames, len(markers.time)) if markers is not None else frames
    values = values[: frames * samples].copy()
    place = {channel.name: number for number, channel in enumerate(channels)}
    plates = [[place[name] for name in _plate_channels(surface)] for surface in surfaces]
    for surface, columns in zip(surfaces, plates, strict=True):
        axes = ForcePlate(1, 2, (), surface.corners, np.zeros(3), np.empty((0, 0))).axes
        for three in (columns[:3], columns[3:]):  # force and moment along the plate's own axes
            values[:, three] = values[:, three] @ axes
    if frames > MOST_FRAMES:
        raise SamplingError(
            f"a C3D file with {frame_hz:g} frames per second can be at most {MOST_FRAMES / frame_hz:g} s long",
            f"{path.name} would be {frames / frame_hz:g} s long",
            "Write a shorter part, or write a table.",
        )
    file = ezc3d.c3d()
    labels = list(dict.fromkeys(name.rpartition(".")[0] for name in markers.names)) if markers is not None else []
    settings = {
        ("POINT", "RATE"): [frame_hz],
        ("POINT", "UNITS"): ["m"],
        ("POINT", "LABELS"): labels,
        ("ANALOG", "RATE"): [frame_hz * samples * bool(analog)],
        ("ANALOG", "LABELS"): [channel.name for channel in channels],
        ("ANALOG", "UNITS"): [channel.unit for channel in channels],
    } | _platforms(surfaces, plates)
    for (group, name), value in settings.items():
        file.add_parameter(group, name, value)
        if name in WHOLE:  # ezc3d makes floats of them, which other programs refuse
            parameter = file["parameters"][group][name]
            parameter["type"], parameter["value"] = ezc3d.ezc3d.INT, np.asarray(parameter["value"]).astype(int)
    file["data"]["points"] = np.empty((4, 0, frames))
    if markers is not None:  # (4, marker, frame) [m]; one that lacks a coordinate is written as not seen
        points = markers.values[:frames].reshape(frames, -1, 3).copy()
        points[np.isnan(points).any(axis=2)] = np.nan
        file["data"]["points"] = np.concatenate([points.transpose(2, 1, 0), np.ones((1, points.shape[1], frames))])
    file["data"]["analogs"] = np.ascontiguousarray(values.T)[None]
    with tempfile.TemporaryDirectory() as folder:
        written = Path(folder) / "whole.c3d"
        file.write(str(written))
        return write_whole(path, written.read_bytes())


def _apart(
    recordings: Sequence[Recording], surfaces: Sequence[Surface], file: str
) -> tuple[Recording | None, list[Recording]]:
    """Markers, and the analog recordings without the centres of pressure, which follow from force and moment."""
    markers = [r for r in recordings if all(channel.quantity == "marker" for channel in r.channels)]
    if len(markers) > 1 or any(abs(marker.time[0]) > 1e-9 for marker in markers):
        fault = f"number of recordings: {len(markers)}; start of the first: {markers[0].time[0]:g} s"
        raise SamplingError(f"markers of {file} must be one recording that starts at 0 s", fault, "Join or shift them.")
    names = {channel.name for recording in recordings for channel in recording.channels}
    absent = [name for surface in surfaces for name in _plate_channels(surface) if name not in names]
    if absent:
        fault = f"{absent[0]!r} is missing"
        raise ChannelError(f"a plate of {file} must have its force and moment", fault, "Add it, or remove the plate.")
    pressure = {f"{surface.name}_p{axis}" for surface in surfaces for axis in "xyz"}
    others = [r for r in recordings if r not in markers]
    return markers[0] if markers else None, [
        r.selected([name for name in r.names if name not in pressure]) for r in others
    ]


def _plate_channels(surface: Surface) -> list[str]:
    return [f"{surface.name}_{kind}{axis}" for kind in "fm" for axis in "xyz"]


def _platforms(surfaces: Sequence[Surface], columns: Sequence[Sequence[int]]) -> dict[tuple[str, str], Any]:
    """Parameters of the plates; sensors at the surface."""
    if not surfaces:
        return {}
    group, count = "FORCE_PLATFORM", len(surfaces)
    return {
        (group, "USED"): [count],
        (group, "TYPE"): [2] * count,
        (group, "ZERO"): [0, 0],
        (group, "CHANNEL"): 1.0 + np.array(columns).T,
        (group, "CORNERS"): np.array([surface.corners for surface in surfaces]).T,
        (group, "ORIGIN"): np.zeros((3, count)),
    }


def _samples_per_frame(recordings: Sequence[Recording], frame_hz: float, file: str) -> int:
    needed = (
        f"the analog channels of {file} must have one time base that begins at 0 s and a rate that is a multiple of "
        f"{frame_hz:g} Hz"
    )
    first = recordings[0]
    for other in recordings[1:]:
        if not np.array_equal(other.time, first.time):
            fault = f"{first.names[0]} has {len(first.time)} samples at {first.rate_hz:g} Hz, and {other.names[0]} has "
            fault += f"{len(other.time)} at {other.rate_hz:g} Hz"
            raise SamplingError(needed, fault, "Resample the channels to one time base.")
    samples = round(first.rate_hz / frame_hz)
    if samples < 1 or abs(samples * frame_hz - first.rate_hz) > 1e-6 * first.rate_hz or abs(first.time[0]) > 1e-9:
        fault = f"{first.names[0]} begins at {first.time[0]:g} s and has {first.rate_hz:g} Hz"
        raise SamplingError(needed, fault, "Resample the channels, or write a table.")
    return samples
