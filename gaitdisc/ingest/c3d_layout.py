"""Where the data of a C3D file lie, by its own counts and its length; their scales; and reading them without ezc3d."""

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_parameters import BLOCK, C3DHeader, C3DParameters, decoded
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values

_SATURATED = 65535  # a 16-bit frame number that stands for "more than that"
_REMEDY = (
    "Export the trial again, or set the value in the software that wrote it. Numbers without a scale have no unit."
)


@dataclass(frozen=True)
class C3DLayout:
    """Shape of the data section."""

    frames: int
    points: int  # a frame
    channels: int  # analog
    samples_per_frame: int  # of each analog channel
    word_bytes: int  # 4 where values are floats, 2 where they are integers
    data_block: int  # where the data begin [blocks of 512 bytes, from 1]

    @property
    def frame_bytes(self) -> int:
        """Bytes of one frame."""
        return (4 * self.points + self.channels * self.samples_per_frame) * self.word_bytes

    @property
    def end(self) -> int:
        """Bytes that the file has at least."""
        return (self.data_block - 1) * BLOCK + self.frames * self.frame_bytes

    def fills(self, size: int) -> bool:
        """Whether a file of that size [bytes] holds the data and no more than the padding of the last block."""
        return self.end <= size < self.end + BLOCK


def find_layout(header: C3DHeader, parameters: C3DParameters) -> tuple[C3DLayout, list[Finding]]:
    """Layout that the file's own counts and its length agree on.

    Header and parameters usually say the same; a file that is shorter than that is truncated. Where they contradict
    each other, the counts that fill the file to its last block are believed, and the contradiction is a finding.
    """
    word_bytes = _word_bytes(header, parameters)
    frames = _frames(header, parameters)
    points = _distinct(parameters.count("POINT", "USED"), header.points)
    analog = _analog(header, parameters)
    blocks = _distinct(header.data_block, parameters.count("POINT", "DATA_START") or None)
    layouts = [
        C3DLayout(count, used, channels, samples, word_bytes, block)
        for count, used, (channels, samples), block in itertools.product(frames, points, analog, blocks)
    ]
    filling = [layout for layout in layouts if layout.fills(header.size)]
    layout = (filling or layouts)[0]
    _refuse_impossible(layout, header)
    rotations = parameters.count("ROTATION", "USED")  # their block follows the frames
    contradicted = (
        ("frames", frames, layout.frames),
        ("points", points, layout.points),
        ("analog channels and samples per frame", analog, (layout.channels, layout.samples_per_frame)),
        ("first block of the data", blocks, layout.data_block),
    )
    findings = []
    for what, values, taken in contradicted:
        if len(values) > 1:
            both = " and ".join(map(str, values))
            differ = f"header and parameters differ ({what}: {both}); {taken} is used, which "
            differ += "fills the file to its last block" if layout.fills(header.size) else "fits the file"
            trial = "the entire trial if this is wrong; compare its length with your notes"
            findings.append(Finding("warning", "contradictory header", header.file, differ, trial))
    rest = header.size - layout.end
    if rest >= layout.frame_bytes + BLOCK and not rotations:
        left = f"{rest} bytes follow the last of {layout.frames} frames, enough for {rest // layout.frame_bytes} more"
        spoils = "nothing unless they are frames; compare the trial's length with your notes"
        findings.append(Finding("warning", "bytes left over", header.file, left, spoils))
    return layout, findings


def _frames(header: C3DHeader, parameters: C3DParameters) -> tuple[int, ...]:
    """Counts of frames, the most trustworthy first: 16 bits are too few for more than 65535."""
    start, end = parameters.field("ACTUAL_START_FIELD"), parameters.field("ACTUAL_END_FIELD")
    trial = end - start + 1 if start is not None and end is not None and end >= start > 0 else None
    wide = [trial, parameters.count("POINT", "LONG_FRAMES")]
    narrow = [parameters.count("POINT", "FRAMES"), header.frames]
    if header.last_frame == _SATURATED or _SATURATED in narrow:
        narrow = [count for count in narrow if count and not any(w and w > count for w in wide)]
    return _distinct(*(count for count in (*wide, *narrow) if count)) or (0,)


def _analog(header: C3DHeader, parameters: C3DParameters) -> tuple[tuple[int, int], ...]:
    """(channels, samples a frame) as the header and as the parameters say."""
    counts = []
    samples = header.samples_per_frame
    if header.analog_values and samples and header.analog_values % samples == 0:
        counts.append((header.analog_values // samples, samples))
    used = parameters.count("ANALOG", "USED")
    rate, frame_rate = parameters.number("ANALOG", "RATE"), parameters.number("POINT", "RATE") or header.rate_hz
    if used and rate and frame_rate and 0 < rate / frame_rate < _SATURATED:
        counts.append((used, samples if abs(rate / frame_rate - samples) < 1 and samples else round(rate / frame_rate)))
    elif used and samples:
        counts.append((used, samples))
    if not header.analog_values or used == 0 or not counts:
        counts.append((0, 0))
    return _distinct(*counts)


def _word_bytes(header: C3DHeader, parameters: C3DParameters) -> int:
    """4 for floats, 2 for integers; readers differ in whom they believe, so header and POINT:SCALE must agree."""
    stated = parameters.number("POINT", "SCALE")
    scale = header.scale if stated is None else stated
    same = (scale < 0) == (header.scale < 0) and (scale < 0 or abs(scale - header.scale) <= 1e-3 * abs(scale))
    if not same:
        raise ReadError(
            "the header and POINT:SCALE of a C3D file must state the same scale (negative for floating-point points)",
            f"{header.file} has {header.scale:g} and {scale:g}",
            "Export the trial again. With the wrong scale all lengths are wrong.",
        )
    return 4 if scale < 0 else 2


def _distinct(*values):
    return tuple(dict.fromkeys(value for value in values if value is not None))


def _refuse_impossible(layout: C3DLayout, header: C3DHeader) -> None:
    if layout.end > header.size:
        n_complete = max((header.size - (layout.data_block - 1) * BLOCK) // max(layout.frame_bytes, 1), 0)
        raise ReadError(
            f"a C3D file of {layout.frames} frames, {layout.points} points and {layout.channels} analog channels must "
            f"have {layout.end} bytes",
            f"{header.file} has {header.size} bytes and ends within frame {n_complete + 1}: it is truncated",
            "Copy it again from the recording computer. Do not use this incomplete copy.",
        )
    if layout.data_block != header.data_block:
        raise ReadError(
            "the header of a C3D file must say where the data begin",
            f"{header.file} says block {header.data_block}; POINT:DATA_START and the length of the file say block "
            f"{layout.data_block}",
            "Export the trial again. This copy is damaged.",
        )
    if layout.frames < 1 or layout.frame_bytes < 1 or layout.data_block <= header.parameter_block:
        raise ReadError(
            "a trial must have at least one frame of points or analog channels",
            f"{header.file} has {layout.frames} frames, {layout.points} points, {layout.channels} analog channels",
            "Export the trial again with markers or analog channels.",
        )
    if layout.frames == _SATURATED and header.size - layout.end >= layout.frame_bytes + BLOCK:
        room = layout.frames + (header.size - layout.end) // layout.frame_bytes
        raise ReadError(
            "a C3D file of more than 65535 frames must state their number in TRIAL:ACTUAL_END_FIELD",
            f"{header.file} has room for {room} frames, but states 65535",
            "Export the trial in parts, or with software that writes the group TRIAL.",
        )


def check_common_scales(header: C3DHeader, parameters: C3DParameters) -> None:
    """Refuse a file whose scale of all points or of all analog channels cannot be used."""
    stated = [("the header's scale of points", float(header.scale))] if header.points else []
    for group, name, used in (("POINT", "SCALE", header.points), ("ANALOG", "GEN_SCALE", header.analog_values)):
        numbers = parameters.numbers(group, name).ravel()
        if used and numbers.size:
            stated.append((f"{group}:{name}", float(numbers[0])))
    for name, scale in stated:
        if not np.isfinite(scale) or scale == 0:
            stated_scale = f"{name} of {header.file} is {scale:g}"
            raise ReadError("the scales of a C3D file must be finite and not 0", stated_scale, _REMEDY)


def list_unscaled(parameters: C3DParameters, channels: int) -> tuple[frozenset[int], list[Finding]]:
    """Analog channels whose own scale or offset cannot be used: their numbers are missing, the others stand."""
    labels = [*parameters.texts("ANALOG", "LABELS"), *[""] * channels]
    bad: dict[int, str] = {}
    for name in ("SCALE", "OFFSET"):
        for place, number in enumerate(parameters.numbers("ANALOG", name).ravel()[:channels]):
            if not np.isfinite(number) or (name == "SCALE" and number == 0):
                bad.setdefault(place, f"ANALOG:{name} of channel #{place + 1} {labels[place]} is {number:g}")
    if not bad:
        return frozenset(), []
    several = f", and {len(bad) - 4} more channels" if len(bad) > 4 else ""
    what = f"{'; '.join(list(bad.values())[:4])}{several}; a channel without a scale or offset is treated as missing"
    doubt = Finding("warning", "scale", parameters.file, what, "these channels; export the trial again")
    return frozenset(bad), [doubt]


def counts_agree(header: C3DHeader, parameters: C3DParameters, layout: C3DLayout) -> bool:
    """Whether header, parameters and layout state one number of frames, points and samples, one scale and rate."""
    samples, start, end = header.samples_per_frame, *map(parameters.field, ("ACTUAL_START_FIELD", "ACTUAL_END_FIELD"))
    frames = header.frames if start is None or end is None else end - start + 1
    stated = (
        ("POINT", "USED", header.points),
        ("POINT", "SCALE", header.scale),
        ("POINT", "RATE", header.rate_hz),
        ("ANALOG", "RATE", header.rate_hz * samples),
    )
    agree = all(parameters.number(group, name) in (None, in_header) for group, name, in_header in stated)
    counts = layout.frames, layout.points, layout.channels * layout.samples_per_frame
    used = (parameters.number("ANALOG", "USED") or 0.0) * samples
    return agree and counts == (frames, header.points, header.analog_values) and used == header.analog_values


def read_frames(
    path: Path, header: C3DHeader, parameters: C3DParameters, layout: C3DLayout, step: int = 1
) -> tuple[Values, Values]:
    """Points (frame, 3 * point) and analog values (sample, channel) of every `step`-th frame, in the file's units."""
    place, shape = (layout.data_block - 1) * BLOCK, (layout.frames, layout.frame_bytes)
    frames = np.memmap(path, np.uint8, "r", place, shape)[::step]
    raw = decoded(frames.tobytes(), layout.word_bytes, header.processor).reshape(len(frames), -1).astype(float)
    cells, analog = np.split(raw, [4 * layout.points], axis=1)
    cells = cells.reshape(len(frames), layout.points, 4)
    points = cells[:, :, :3] * (header.scale if layout.word_bytes == 2 else 1.0)
    points[cells[:, :, 3] < 0] = np.nan
    analog = analog.reshape(len(frames) * layout.samples_per_frame, layout.channels)
    if layout.word_bytes == 2 and parameters.text("ANALOG", "FORMAT").upper() == "UNSIGNED":
        analog %= 2**16
    offset, factor = parameters.numbers("ANALOG", "OFFSET").ravel(), parameters.numbers("ANALOG", "SCALE").ravel()
    analog[:, : len(offset)] -= offset[: layout.channels]
    analog[:, : len(factor)] *= factor[: layout.channels]
    # as in POINT:SCALE, a negative sign says of some software's files that the numbers are floats
    return points.reshape(len(frames), -1), analog * abs(parameters.number("ANALOG", "GEN_SCALE") or 1.0)
