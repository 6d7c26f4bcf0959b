"""C3D files: one becomes one trial, read in a process of its own, its counts, length and scales checked."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaitdisc.errors import ReadError, SamplingError
from gaitdisc.ingest.c3d_analog import analog_labels, analog_streams
from gaitdisc.ingest.c3d_kinetics import body_mass, house_kinetics
from gaitdisc.ingest.c3d_labels import LabelMap, file_events
from gaitdisc.ingest.c3d_parameters import (
    BLOCK,
    C3DHeader,
    C3DParameters,
    decoded,
    read_c3d_header,
    read_c3d_parameters,
)
from gaitdisc.ingest.c3d_points import Streams, add_part, file_segments, point_names, point_streams
from gaitdisc.ingest.columns import is_ignored
from gaitdisc.ingest.force_plates import force_plates, plate_loads, plate_streams
from gaitdisc.ingest.reader_process import Arrays, ReaderProcess, ReadRequest
from gaitdisc.recording import Finding, Recording, Source, Surface, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.regular_file import file_sha256

GLANCES = 30  # frames by which `glance_at_c3d` sees what a file has
ANALOG_STREAMS = ("emg", "forces", "signals")
_SATURATED = 65535  # a 16-bit frame number that stands for "more than that"
_REMEDY = (
    "Export the trial again, or set the value in the software that wrote it. Without their scale the numbers have no "
    "unit."
)


class C3DReader:
    """Reads C3D, `.mat` and `.npz` files one after the other in one isolated process.

    The process starts with the first file, restarts after a crash and after 100 files, and ends with the `with` block.
    The reader may be used again after that. Threads that share a reader take turns.

    >>> with C3DReader() as reader:
    ...     reader.read("missing.c3d")
    Traceback (most recent call last):
    ...
    gaitdisc.errors.MissingFileError: the path must lead to a C3D file; missing.c3d does not exist. Check the path.
    """

    def __init__(self) -> None:
        self.process = ReaderProcess()

    def __enter__(self) -> C3DReader:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """End the isolated process."""
        self.process.close()

    def read(self, path: str | Path, channels: Mapping[str, str] | None = None) -> Trial:
        """Trial of one C3D file.

        Streams: `markers` [m] as `<marker>.x`; `segments`, the poses of the group ROTATION (see `file_segments`);
        `kinematics` [deg], the model's angles under names of the vocabulary, otherwise as `<label>.x`; `moments`, the
        model's, internal, [N m/kg, N/kg, W/kg] if the file gives them per body mass, otherwise [N m, N, W]; `emg` [V];
        `forces` [N, N m, m], ground on foot (see `force_plates`); `signals`, every other analog channel. The first
        frame is at 0 s. Everything that names a person is removed: label prefixes and the groups SUBJECTS, TRIAL,
        MANUFACTURER.

        Parameters
        ----------
        path : Path or str
            The C3D file.
        channels : mapping of str to str, optional
            The study's own names, see `LabelMap`: label, description, `#<n>` for the n-th analog channel or
            `<label>.x` -> name, or `name [unit]`.

        Returns
        -------
        Trial
            With findings for everything that the file leaves open or contradicts.
        """
        path = Path(path)
        try:
            return self._trial(path, channels)
        except ReadError:
            raise
        except OSError as error:
            raise ReadError(
                "a C3D file must not change while it is read",
                f"{path.name}: the operating system reports: {error.strerror}",
                "Check that the disk is connected and that no program replaces the file, and try again.",
            ) from error

    def _trial(self, path: Path, channels: Mapping[str, str] | None) -> Trial:
        header = read_c3d_header(path)
        parameters = read_c3d_parameters(path, header)
        check_common_scales(header, parameters)
        if not header.points and not header.analog_values and parameters.count("ROTATION", "USED"):
            segments = file_segments(path, header, parameters, Source(header.file, file_sha256(path)))
            return Trial(path.stem, {"segments": segments} if segments is not None else {})
        layout, findings = find_layout(header, parameters)
        rate_hz, doubts = _rate(header, parameters, layout)
        with ThreadPoolExecutor(1) as beside:  # the hash is done while the other process reads
            sha256 = beside.submit(file_sha256, path)
            reader, (points, analog), more = self._raw(path, header, layout)
        findings += [*doubts, *more]
        labels = LabelMap(channels)
        streams, surfaces, seen = _streams(points, analog, layout, parameters, labels)
        first = parameters.field("ACTUAL_START_FIELD") or max(header.first_frame, 1)
        events, more = file_events(parameters, layout.frames, rate_hz, first)
        analog_channels = analog_labels(parameters, layout.channels)
        all_labels = [text for one in analog_channels for text in (one.label, one.description)]
        all_labels += point_names(parameters, layout.points)
        findings += [*seen, *more, *labels.unused(all_labels, header.file)]
        source = Source(header.file, sha256.result(), reader)
        samples = layout.samples_per_frame
        point_times = np.arange(layout.frames) / rate_hz
        analog_times = np.arange(layout.frames * samples) / (rate_hz * max(samples, 1))
        recordings = {}
        for key, (values, columns) in streams.items():
            used = [not is_ignored(channel) for channel in columns]
            if any(used):
                times = analog_times if key in ANALOG_STREAMS else point_times
                own = values if all(used) else values[:, used]
                recordings[key] = Recording(times, own, tuple(itertools.compress(columns, used)), source=source)
        segments = file_segments(path, header, parameters, source)
        recordings |= {"segments": segments} if segments is not None else {}
        return Trial(path.stem, recordings, events, tuple(findings), surfaces=surfaces)

    def _raw(self, path: Path, header: C3DHeader, layout: C3DLayout) -> tuple[str, Arrays, list[Finding]]:
        """Reader, arrays and findings: ezc3d or, where it cannot, the second; both are held to the header's counts."""
        counts = (layout.frames, layout.points, layout.channels, layout.frames * layout.samples_per_frame)
        said: dict[str, str] = {}
        for reader in ("ezc3d", "c3d"):
            answer, arrays = self.process.read(ReadRequest.of_size(str(path), reader, counts, header.size))
            if "said" not in answer:
                break
            # on one line, without the folder, which may name a person
            said[reader] = " ".join(answer["said"].replace(str(path), path.name).split())[:200].rstrip(".")
        else:
            raise ReadError(
                f"{header.file} states {layout.frames} frames, {layout.points} points and {layout.channels} analog "
                "channels, which no reader finds",
                "; ".join(f"{reader}: {words}" for reader, words in said.items()),
                "Export the trial again, or repair it in the software that wrote it.",
            )
        if not said:
            return answer["reader"], arrays, []
        what = f"read by {answer['reader']}, because ezc3d failed: {said['ezc3d']}"
        spoils = "nothing; the counts agree with the header"
        return answer["reader"], arrays, [Finding("note", "second reader", header.file, what, spoils)]


def read_c3d(path: str | Path, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one C3D file; `C3DReader` is faster for many."""
    with C3DReader() as reader:
        return reader.read(path, channels)


def glance_at_c3d(path: Path) -> Trial:
    """Markers, outputs of the model, EMG and events of a C3D file by some 30 frames of it, read in this process.

    Enough to see what a file has and whether somebody walks in it; the EMG has no values.
    """
    header = read_c3d_header(path)
    parameters = read_c3d_parameters(path, header)
    check_common_scales(header, parameters)
    layout, findings = find_layout(header, parameters)
    rate_hz, _ = _rate(header, parameters, layout)
    step, size = max(layout.frames // GLANCES, 1), 4 * layout.points * layout.word_bytes
    with path.open("rb") as file:
        frames = []
        for frame in range(0, layout.frames, step):
            file.seek((layout.data_block - 1) * BLOCK + frame * layout.frame_bytes)
            frames.append(file.read(size))
    cells = decoded(b"".join(frames), layout.word_bytes, header.processor).astype(float)
    cells = cells.reshape(len(frames), layout.points, 4)
    points = cells[:, :, :3] * (abs(parameters.number("POINT", "SCALE") or 1.0) if layout.word_bytes == 2 else 1.0)
    points[cells[:, :, 3] < 0] = np.nan
    labels = LabelMap()
    streams, _, _ = point_streams(points.reshape(len(frames), 3 * layout.points), parameters, labels)
    analog, _ = analog_streams(np.full((len(frames), layout.channels), np.nan), parameters, set(), labels)
    first = parameters.field("ACTUAL_START_FIELD") or max(header.first_frame, 1)
    events, _ = file_events(parameters, layout.frames, rate_hz, first)
    times = np.arange(len(frames)) * step / rate_hz
    recordings = {key: Recording(times, *part, source=Source(header.file)) for key, part in (streams | analog).items()}
    return Trial(path.stem, recordings, events, tuple(findings))


def _streams(
    points: Values, raw: Values, layout: C3DLayout, parameters: C3DParameters, labels: LabelMap
) -> tuple[Streams, tuple[Surface, ...], list[Finding]]:
    unscaled, seen = list_unscaled(parameters, layout.channels)
    raw[:, sorted(unscaled)] = np.nan
    file = parameters.file
    findings = [*seen, *_make_finite(points, "coordinates of points", file), *_make_finite(raw, "analog values", file)]
    streams, unit, doubts = point_streams(points, parameters, labels)
    plates, described = force_plates(parameters, layout.channels, unit, unscaled)
    forces, columns, of_plates = plate_streams(raw, plates, parameters, unit)
    if "moments" in streams:
        loads = plate_loads(forces, max(layout.samples_per_frame, 1))
        streams["moments"], more = house_kinetics(streams["moments"], loads, body_mass(parameters), file)
        of_plates = [*of_plates, *more]
    analog, of_analog = analog_streams(raw, parameters, columns, labels)
    for key, part in (*forces.items(), *analog.items()):
        add_part(streams, key, part)
    surfaces = tuple(plate.surface for plate in plates if columns.issuperset(plate.columns))
    return streams, surfaces, [*findings, *doubts, *described, *of_plates, *of_analog]


def _rate(header: C3DHeader, parameters: C3DParameters, layout: C3DLayout) -> tuple[float, list[Finding]]:
    """Frames a second, and what does not fit: analog samples run on the frames' clock, so many in each frame."""
    stated = parameters.number("POINT", "RATE")
    analog = parameters.number("ANALOG", "RATE")
    of_analog = analog / layout.samples_per_frame if analog and layout.samples_per_frame else None
    rates = [rate for rate in (stated, header.rate_hz, of_analog) if rate is not None and 0.01 < rate < 1e6]
    if not rates:
        raise SamplingError(
            "a trial must have a rate",
            f"{header.file} gives POINT:RATE {stated} Hz, header {header.rate_hz:g} Hz, ANALOG:RATE {analog} Hz",
            "Set POINT:RATE in the file.",
        )
    rate = rates[0]
    findings = []
    if stated is not None and abs(header.rate_hz - rate) > 1e-3 * rate:
        what = f"POINT:RATE is {stated:g} Hz, the header says {header.rate_hz:g} Hz; read at {rate:g} Hz"
        findings.append(Finding("warning", "contradictory rate", header.file, what, "all times if this is wrong"))
    if analog is not None and of_analog is not None and abs(of_analog - rate) > 1e-9 * rate:
        what = (
            f"ANALOG:RATE {analog:g} Hz is {analog / rate:.6g} times POINT:RATE {rate:g} Hz; the file has "
            f"{layout.samples_per_frame} samples per frame; read at {layout.samples_per_frame * rate:g} Hz"
        )
        severity = "note" if abs(of_analog - rate) < 1e-3 * rate else "warning"
        findings.append(Finding(severity, "analog rate", header.file, what, "times of analog channels, if wrong"))
    return rate, findings


def _make_finite(values: Values, what: str, file: str) -> list[Finding]:
    infinite = np.isinf(values)
    if not infinite.any():
        return []
    values[infinite] = np.nan
    return [
        Finding(
            "warning", "infinite values", file, f"{int(infinite.sum())} {what} are infinite; treated as missing", what
        )
    ]


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

    def fits(self, size: int) -> bool:
        """Whether a file of that size [bytes] can hold the data."""
        return self.end <= size

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
    how = "which fills the file to its last block" if layout.fills(header.size) else "for which the file is long enough"
    contradicted = (
        ("frames", frames, layout.frames),
        ("points", points, layout.points),
        ("analog channels and samples per frame", analog, (layout.channels, layout.samples_per_frame)),
        ("first block of the data", blocks, layout.data_block),
    )
    findings = [
        Finding(
            "warning",
            "contradictory header",
            header.file,
            f"header and parameters give {what} as {' and '.join(map(str, values))}; read as {taken}, {how}",
            "the whole trial if this is wrong; compare its length with your notes",
        )
        for what, values, taken in contradicted
        if len(values) > 1
    ]
    rest = header.size - layout.end
    if rest >= layout.frame_bytes + BLOCK and not rotations:
        findings.append(
            Finding(
                "warning",
                "bytes left over",
                header.file,
                f"{rest} bytes follow the last of {layout.frames} frames, enough for {rest // layout.frame_bytes} more",
                "nothing unless they are frames; compare the trial's length with your notes",
            )
        )
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
    found = []
    samples = header.samples_per_frame
    if header.analog_values and samples and header.analog_values % samples == 0:
        found.append((header.analog_values // samples, samples))
    used = parameters.count("ANALOG", "USED")
    rate, frame_rate = parameters.number("ANALOG", "RATE"), parameters.number("POINT", "RATE") or header.rate_hz
    if used and rate and frame_rate and 0 < rate / frame_rate < _SATURATED:
        found.append((used, samples if abs(rate / frame_rate - samples) < 1 and samples else round(rate / frame_rate)))
    elif used and samples:
        found.append((used, samples))
    if not header.analog_values or used == 0 or not found:
        found.append((0, 0))
    return _distinct(*found)


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
    if not layout.fits(header.size):
        whole = max((header.size - (layout.data_block - 1) * BLOCK) // max(layout.frame_bytes, 1), 0)
        raise ReadError(
            f"a C3D file of {layout.frames} frames, {layout.points} points and {layout.channels} analog channels must "
            f"have {layout.end} bytes",
            f"{header.file} has {header.size} and ends within frame {whole + 1}: it is truncated",
            "Copy it again from the recording computer. Do not use this incomplete copy.",
        )
    if layout.data_block != header.data_block:
        raise ReadError(
            "the header of a C3D file must say where the data begin",
            f"{header.file} says block {header.data_block}; POINT:DATA_START and the length of the file say "
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
            f"{header.file} has room for {room} but states 65535",
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
            found = f"{name} of {header.file} is {scale:g}"
            raise ReadError("the scales of a C3D file must be finite and not 0", found, _REMEDY)


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
    what = f"{'; '.join(list(bad.values())[:4])}{several}; treated as missing"
    doubt = Finding("warning", "scale", parameters.file, what, "these channels; export the trial again")
    return frozenset(bad), [doubt]
