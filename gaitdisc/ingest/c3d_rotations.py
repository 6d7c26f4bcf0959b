"""Poses of segments that a C3D file holds in its group ROTATION, as markerless systems write them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_header import BLOCK, C3DHeader, decoded
from gaitdisc.ingest.c3d_labels import without_prefix
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.ingest.c3d_points import AXES, length_unit
from gaitdisc.recording import Recording, Source
from gaitdisc.units import convert

NUMBERS = 17  # 4 x 4, first index fastest, and how sure it is; negative where the pose is not known
CELLS = tuple(f"r{row}{column}" for row in "123" for column in "123")


def file_segments(path: Path, header: C3DHeader, parameters: C3DParameters, source: Source) -> Recording | None:
    """Origin [m] and axes of each segment, `<segment>.x` to `.z` and `<segment>.r11` to `.r33`; None without any.

    Axes are as the file has them, the columns of `r`, in the laboratory's frame.

    Source: ROTATION data type, c-motion.com: USED, RATIO, DATA_START, LABELS; 17 floats for each segment and frame.
    """
    used = parameters.count("ROTATION", "USED") or 0
    start = parameters.count("ROTATION", "DATA_START") or 0
    if not used or not start:
        return None
    ratio = parameters.count("ROTATION", "RATIO") or 1
    frames = (parameters.count("POINT", "FRAMES") or header.frames) * ratio
    size = 4 * NUMBERS * used * frames
    first = (start - 1) * BLOCK
    if first + size > header.size or not frames:
        raise ReadError(
            f"{header.file} promises {frames} frames of {used} segments in ROTATION",
            f"{max(header.size - first, 0)} of {size} bytes follow block {start}",
            "Export the trial again; this copy is cut off.",
        )
    with path.open("rb") as file:
        file.seek(first)
        raw = file.read(size)
    cells = decoded(raw, 4, header.processor).astype(float).reshape(frames, used, NUMBERS)
    poses = cells[:, :, :16].reshape(frames, used, 4, 4).swapaxes(2, 3)
    poses[cells[:, :, 16] < 0] = np.nan
    names = _names(parameters, used)
    rate_hz = parameters.number("ROTATION", "RATE") or ratio * (parameters.number("POINT", "RATE") or header.rate_hz)
    unit, _ = length_unit(parameters, poses[:, :, :3, 3].reshape(frames, -1), header.file)
    columns, channels = [], []
    for place, name in enumerate(names):
        columns += [convert(poses[:, place, :3, 3], unit, "m"), poses[:, place, :3, :3].reshape(frames, 9)]
        channels += [Channel(f"{name}.{axis}", "translation", "m") for axis in AXES]
        channels += [Channel(f"{name}.{cell}", "signal", "1") for cell in CELLS]
    return Recording(np.arange(frames) / rate_hz, np.hstack(columns), tuple(channels), source=source)


def _names(parameters: C3DParameters, used: int) -> list[str]:
    labels = [without_prefix(label) for label in parameters.texts("ROTATION", "LABELS")[:used]]
    labels += [f"segment_{number}" for number in range(len(labels) + 1, used + 1)]
    return [re.sub(r"(?i)_4x4$", "", label) for label in labels]
