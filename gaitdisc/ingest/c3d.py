"""C3D files: one file becomes one trial, read in a process of its own, checked against its header."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, SamplingError
from gaitdisc.ingest.c3d_analog import analog_labels, analog_streams
from gaitdisc.ingest.c3d_kinetics import body_mass, house_kinetics
from gaitdisc.ingest.c3d_labels import LabelMap, file_events
from gaitdisc.ingest.c3d_layout import C3DLayout, check_common_scales, expected_layout, unscaled_channels
from gaitdisc.ingest.c3d_parameters import C3DHeader, C3DParameters, read_c3d_header, read_c3d_parameters
from gaitdisc.ingest.c3d_points import Streams, file_segments, point_names, point_streams
from gaitdisc.ingest.force_plates import force_plates, plate_loads, plate_streams
from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.ingest.reader_process import Arrays, ReaderProcess, ReadRequest
from gaitdisc.recording import Finding, Recording, Source, Surface, Trial

ANALOG_STREAMS = ("emg", "forces", "signals")


class C3DReader:
    """Reads C3D, `.mat` and `.npz` files one after the other in one isolated process.

    The process is started at the first file, started anew when a file kills it and after 100 files, and ends with the
    `with` block. The reader may be used again after that. Threads that share a reader take turns.

    >>> with C3DReader() as reader:
    ...     reader.read("missing.c3d")
    Traceback (most recent call last):
    ...
    gaitdisc.errors.ReadError: a C3D file is needed; missing.c3d is not there. Check the path.
    """

    def __init__(self) -> None:
        self.process = ReaderProcess()

    def __enter__(self) -> C3DReader:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the isolated process."""
        self.process.close()

    def read(self, path: str | Path, channels: Mapping[str, str] | None = None) -> Trial:
        """Trial of one C3D file.

        Streams: `markers` [m] as `<marker>.x`; `segments`, the poses of the group ROTATION (see `file_segments`);
        `kinematics` [deg], the model's angles under the names of the vocabulary where it knows them, `<label>.x`
        otherwise; `moments`, the model's, internal, [N m/kg, N/kg, W/kg] where the file holds them per body mass and
        [N m, N, W] otherwise; `emg` [V]; `forces` [N, N m, m], ground on foot (see `force_plates`); `signals`, every
        other analog channel. The first frame is at 0 s. Nothing passes that names a person: neither label prefixes nor
        the groups SUBJECTS, TRIAL, MANUFACTURER.

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
        except OSError as error:
            raise ReadError(
                "a C3D file is needed that stays while it is read",
                f"{path.name}: the system says: {error.strerror}",
                "Check that the disk is there and the file is not being replaced, and try again.",
            ) from error

    def _trial(self, path: Path, channels: Mapping[str, str] | None) -> Trial:
        header = read_c3d_header(path)
        parameters = read_c3d_parameters(path, header)
        check_common_scales(header, parameters)
        if not header.points and not header.analog_values and parameters.count("ROTATION", "USED"):
            segments = file_segments(path, header, parameters, Source(header.file, file_sha256(path)))
            return Trial(path.stem, {"segments": segments} if segments is not None else {})
        layout, findings = expected_layout(header, parameters)
        rate_hz, doubts = _rate(header, parameters, layout)
        with ThreadPoolExecutor(1) as beside:  # the hash is done while the other process reads
            sha256 = beside.submit(file_sha256, path)
            reader, (points, analog), more = self._raw(path, header, layout)
        findings += [*doubts, *more]
        labels = LabelMap(channels)
        streams, surfaces, seen = _streams(points, analog, layout, parameters, labels, header.file)
        first = parameters.field("ACTUAL_START_FIELD") or max(header.first_frame, 1)
        events, more = file_events(parameters, layout.frames, rate_hz, first, header.file)
        findings += [*seen, *more, *labels.unused(_all_labels(parameters, layout), header.file)]
        source = Source(header.file, sha256.result(), reader)
        times = {
            "points": np.arange(layout.frames) / rate_hz,
            "analog": np.arange(layout.frames * layout.samples_per_frame)
            / (rate_hz * max(layout.samples_per_frame, 1)),
        }
        recordings = {
            key: Recording(times["analog" if key in ANALOG_STREAMS else "points"], values, columns, source=source)
            for key, (values, columns) in streams.items()
        }
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
                f"{header.file} promises {layout.frames} frames, {layout.points} points and "
                f"{layout.channels} analog channels, and a reader that finds them",
                "; ".join(f"{reader}: {words}" for reader, words in said.items()),
                "Export the trial again, or repair it in the software that wrote it.",
            )
        if not said:
            return answer["reader"], arrays, []
        what = f"read by {answer['reader']}, as ezc3d could not: {said['ezc3d']}"
        spoils = "nothing; the counts are those of the header"
        return answer["reader"], arrays, [Finding("note", "second reader", header.file, what, spoils)]


def read_c3d(path: str | Path, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one C3D file; `C3DReader` is faster for many.

    >>> read_c3d("missing.c3d")
    Traceback (most recent call last):
    ...
    gaitdisc.errors.ReadError: a C3D file is needed; missing.c3d is not there. Check the path.
    """
    with C3DReader() as reader:
        return reader.read(path, channels)


def _streams(
    points: NDArray[np.float64],
    raw: NDArray[np.float64],
    layout: C3DLayout,
    parameters: C3DParameters,
    labels: LabelMap,
    file: str,
) -> tuple[Streams, tuple[Surface, ...], list[Finding]]:
    unscaled, seen = unscaled_channels(parameters, layout.channels, file)
    raw[:, sorted(unscaled)] = np.nan
    findings = [
        *seen,
        *_made_finite(points, "coordinates of points", file),
        *_made_finite(raw, "analog values", file),
    ]
    streams, unit, doubts = point_streams(points, parameters, labels, file)
    plates, described = force_plates(parameters, layout.channels, unit, file, unscaled)
    forces, columns, of_plates = plate_streams(raw, plates, parameters, unit, file)
    if "moments" in streams:
        loads = plate_loads(forces, max(layout.samples_per_frame, 1))
        streams["moments"], more = house_kinetics(streams["moments"], loads, body_mass(parameters), file)
        of_plates = [*of_plates, *more]
    analog, of_analog = analog_streams(raw, parameters, columns, labels, file)
    for part in (forces, analog):
        for key, (values, channels) in part.items():
            if key in streams:
                before, earlier = streams[key]
                streams[key] = (np.hstack([before, values]), (*earlier, *channels))
            else:
                streams[key] = (values, channels)
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
            "a trial needs a rate",
            f"{header.file} gives POINT:RATE {stated} Hz, header {header.rate_hz:g} Hz, ANALOG:RATE {analog} Hz",
            "Set POINT:RATE in the file.",
        )
    rate = rates[0]
    findings = []
    if stated is not None and abs(header.rate_hz - rate) > 1e-3 * rate:
        what = f"POINT:RATE is {stated:g} Hz, the header says {header.rate_hz:g} Hz; read at {rate:g} Hz"
        findings.append(Finding("warning", "contradictory rate", header.file, what, "every time if this is wrong"))
    if analog is not None and of_analog is not None and abs(of_analog - rate) > 1e-9 * rate:
        what = (
            f"ANALOG:RATE {analog:g} Hz is {analog / rate:.6g} times POINT:RATE {rate:g} Hz, the file holds "
            f"{layout.samples_per_frame} samples a frame; read at {layout.samples_per_frame * rate:g} Hz"
        )
        severity = "note" if abs(of_analog - rate) < 1e-3 * rate else "warning"
        findings.append(
            Finding(severity, "analog rate", header.file, what, "times of analog channels if this is wrong")
        )
    return rate, findings


def _made_finite(values: NDArray[np.float64], what: str, file: str) -> list[Finding]:
    infinite = np.isinf(values)
    if not infinite.any():
        return []
    values[infinite] = np.nan
    return [
        Finding(
            "warning", "infinite values", file, f"{int(infinite.sum())} {what} are infinite; taken as missing", what
        )
    ]


def _all_labels(parameters: C3DParameters, layout: C3DLayout) -> list[str]:
    analog = analog_labels(parameters, layout.channels)
    return [
        *(one.label for one in analog),
        *(one.description for one in analog),
        *point_names(parameters, layout.points),
    ]
