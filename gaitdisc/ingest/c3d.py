"""C3D files: one becomes one trial, read in a process of its own, its counts, length and scales checked."""

import itertools
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Self

import numpy as np

from gaitdisc._version import __version__
from gaitdisc.errors import ReadError, SamplingError
from gaitdisc.ingest.c3d_analog import analog_labels, analog_streams
from gaitdisc.ingest.c3d_kinetics import house_kinetics
from gaitdisc.ingest.c3d_labels import LabelMap, file_events
from gaitdisc.ingest.c3d_layout import (
    C3DLayout,
    check_common_scales,
    counts_agree,
    find_layout,
    list_unscaled,
    read_frames,
)
from gaitdisc.ingest.c3d_parameters import C3DHeader, C3DParameters, body_mass, read_c3d_header, read_c3d_parameters
from gaitdisc.ingest.c3d_points import Streams, add_part, file_segments, point_names, point_streams
from gaitdisc.ingest.columns import is_ignored
from gaitdisc.ingest.force_plates import force_plates, plate_loads, plate_streams
from gaitdisc.ingest.reader_process import Arrays, ReaderProcess, find_limits
from gaitdisc.recording import Finding, Recording, Source, Surface, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.regular_file import file_sha256

GLANCES = 30  # frames by which `glance_at_c3d` sees what a file has
ANALOG_STREAMS = ("emg", "forces", "signals")


class C3DReader:
    """Reads C3D, `.mat` and `.npz` files one after the other in one isolated process.

    The process starts with the first file, restarts after a crash and after 100 files, and ends with the `with` block.
    The reader can be used again afterwards. Threads that share a reader take turns.

    >>> with C3DReader() as reader:
    ...     reader.read("missing.c3d")
    Traceback (most recent call last):
    ...
    gaitdisc.errors.MissingFileError: the path must lead to a C3D file; missing.c3d does not exist. Check the path.
    """

    def __init__(self) -> None:
        self.process = ReaderProcess()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """End the isolated process."""
        self.process.close()

    def read(self, path: str | Path, channels: Mapping[str, str] | None = None) -> Trial:
        """Read one C3D file as a trial.

        Streams: `markers` [m], as `<marker>.x`; `segments`, the poses of the group ROTATION (see `file_segments`);
        `kinematics` [deg], the angles that a gait model wrote into the file, with names of the vocabulary or as
        `<label>.x`; `moments`, internal moments, forces and powers of that model [N m/kg, N/kg, W/kg; or N m, N, W];
        `emg` [V]; `forces` of the ground on the foot [N, N m, m] (see `force_plates`); `signals`, every other analog
        channel. The first frame is at 0 s. Everything that names a person is removed: label prefixes and the groups
        SUBJECTS, TRIAL, MANUFACTURER.

        Parameters
        ----------
        path : Path or str
            The C3D file.
        channels : mapping of str to str, optional
            Names of the study (see `LabelMap`): label, description, `#<n>` for the n-th analog channel, or `<label>.x`
            -> `name` or `name [unit]`.

        Returns
        -------
        Trial
            The trial, with findings for everything that is missing from the file or contradictory.
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
            return Trial(path.stem, file_segments(path, header, parameters, Source(header.file, file_sha256(path))))
        layout, findings = find_layout(header, parameters)
        rate_hz, doubts = _rate(header, parameters, layout)
        with ThreadPoolExecutor(1) as beside:  # the hash is done while the other process reads
            sha256 = beside.submit(file_sha256, path)
            reader, (points, analog), more = self._read_frames(path, header, parameters, layout)
        findings += [*doubts, *more]
        labels = LabelMap(channels)
        streams, surfaces, seen = _streams(points, analog, layout, parameters, labels)
        events, more = file_events(parameters, layout.frames, rate_hz, header.first_frame)
        analog_channels = analog_labels(parameters, layout.channels)
        all_labels = [text for channel in analog_channels for text in (channel.label, channel.description)]
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
                rows = values if all(used) else values[:, used]
                recordings[key] = Recording(times, rows, tuple(itertools.compress(columns, used)), source=source)
        recordings |= file_segments(path, header, parameters, source)
        return Trial(path.stem, recordings, events, tuple(findings), surfaces=surfaces)

    def _read_frames(
        self, path: Path, header: C3DHeader, parameters: C3DParameters, layout: C3DLayout
    ) -> tuple[str, Arrays, list[Finding]]:
        """Reader, arrays and findings: by ezc3d, held to the header's counts, or decoded here where it cannot."""
        counts = (layout.frames, layout.points, layout.channels, layout.frames * layout.samples_per_frame)
        answer, arrays = self.process.read(path, "ezc3d", counts, **find_limits(header.size))
        if "said" not in answer:
            return answer["reader"], arrays, []
        # on one line, without the folder, which may name a person
        failure = " ".join(answer["said"].replace(str(path), path.name).split())[:200].rstrip(".")
        if not counts_agree(header, parameters, layout):
            raise ReadError(
                "the header and the parameters of a C3D file must agree",
                f"those of {header.file} contradict each other ({layout.frames} frames, {layout.points} points and "
                f"{layout.channels} analog channels are most likely), and ezc3d reports: {failure}",
                "Export the trial again, or repair it in the software that wrote it.",
            )
        what = f"the file was decoded without ezc3d, which failed: {failure}"
        spoils = "nothing; the counts agree with the header"
        note = Finding("note", "second reader", header.file, what, spoils)
        return f"gaitdisc {__version__}", [*read_frames(path, header, parameters, layout)], [note]


def read_c3d(path: str | Path, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one C3D file; `C3DReader` is faster for many."""
    with C3DReader() as reader:
        return reader.read(path, channels)


def glance_at_c3d(path: Path) -> Trial:
    """Markers, model outputs, EMG (without values) and events of a C3D file, by some 30 frames read in this process."""
    header = read_c3d_header(path)
    parameters = read_c3d_parameters(path, header)
    check_common_scales(header, parameters)
    layout, findings = find_layout(header, parameters)
    if not counts_agree(header, parameters, layout):  # reading all of it may refuse it
        raise ReadError("header and parameters must agree", f"those of {header.file} do not", "Read the entire file.")
    rate_hz, _ = _rate(header, parameters, layout)
    step = max(layout.frames // GLANCES, 1)
    points, _ = read_frames(path, header, parameters, layout, step)
    labels = LabelMap()
    streams, _, _ = point_streams(points, parameters, labels)
    analog, _ = analog_streams(np.full((len(points), layout.channels), np.nan), parameters, set(), labels)
    events, _ = file_events(parameters, layout.frames, rate_hz, header.first_frame)
    times = np.arange(len(points)) * step / rate_hz
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
            "a trial must have a frame rate",
            f"{header.file} gives POINT:RATE {stated} Hz, header {header.rate_hz:g} Hz, ANALOG:RATE {analog} Hz",
            "Set POINT:RATE in the file.",
        )
    rate = rates[0]
    findings = []
    if stated is not None and abs(header.rate_hz - rate) > 1e-3 * rate:
        what = f"POINT:RATE is {stated:g} Hz, but the header states {header.rate_hz:g} Hz; {rate:g} Hz is used"
        findings.append(Finding("warning", "contradictory rate", header.file, what, "all times if this is wrong"))
    if analog is not None and of_analog is not None and abs(of_analog - rate) > 1e-9 * rate:
        what = (
            f"ANALOG:RATE ({analog:g} Hz) is {analog / rate:.6g} times POINT:RATE ({rate:g} Hz), but the file has "
            f"{layout.samples_per_frame} samples per frame; {layout.samples_per_frame * rate:g} Hz is used"
        )
        severity = "note" if abs(of_analog - rate) < 1e-3 * rate else "warning"
        findings.append(Finding(severity, "analog rate", header.file, what, "analog times if this is wrong"))
    return rate, findings


def _make_finite(values: Values, what: str, file: str) -> list[Finding]:
    infinite = np.isinf(values)
    if not infinite.any():
        return []
    values[infinite] = np.nan
    words = f"infinite {what}, treated as missing: {int(infinite.sum())}"
    return [Finding("warning", "infinite values", file, words, what)]
