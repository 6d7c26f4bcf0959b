"""Several files of one walk become one trial, whatever their kind; a recording becomes a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaitdisc.channel import hint_nearest
from gaitdisc.errors import ChannelError, ReadError, SamplingError, StrideError, WriteError
from gaitdisc.ingest.columns import IGNORE, split_unit
from gaitdisc.ingest.plausible import with_flexion_positive, without_frozen, without_impossible
from gaitdisc.ingest.stated_units import per_kg_findings, plausible_unit
from gaitdisc.ingest.storage import read_storage, write_storage
from gaitdisc.ingest.table import read_frame, read_table, write_table
from gaitdisc.ingest.trc import read_trc
from gaitdisc.own_files import guard
from gaitdisc.recording import Finding, Recording, Source, Trial
from gaitdisc.recording.recording import join_recordings

if TYPE_CHECKING:
    import pandas as pd

    from gaitdisc.ingest.c3d import C3DReader
    from gaitdisc.ingest.study import Participant, PlannedTrial, Study

EDGE_S = 0.05  # by which an event may lie outside of its recording
READERS = {**dict.fromkeys((".mot", ".sto"), read_storage), ".trc": read_trc}
READERS |= dict.fromkeys((".csv", ".tsv", ".parquet"), read_table)
ARRAYS = (".mat", ".npz")
ENDINGS = (".c3d", *READERS, *ARRAYS)


def read_trial(
    paths: Path | str | pd.DataFrame | Sequence[Path | str | pd.DataFrame],
    channels: Mapping[str, str] | None = None,
    subject: str = "",
    condition: str = "",
    crop_s: tuple[float, float] | None = None,
    reader: C3DReader | None = None,
    part: str = "",
) -> Trial:
    """Read one walk, from one file or from several files that were recorded together.

    Parameters
    ----------
    paths : path, DataFrame, or sequence of these
        Files of the walk, such as inverse kinematics, ground forces and EMG; their times must refer to the same clock.
        A DataFrame has times in a column `time` [s] or in an index of that name, and one column per channel: a name of
        the vocabulary (`knee_angle_r` in deg), or `name [unit]`.
    channels : mapping of str to str, optional
        The study's `[channels]`: label -> `name` or `name [unit]`.
    subject, condition : str
        Pseudonym and condition, written into the trial and its streams.
    crop_s : (float, float), optional
        Start and end of the part to keep, on the files' clock [s].
    reader : C3DReader, optional
        A running reader process; by default one is started for each C3D, `.mat` or `.npz` file.
    part : str
        Trial inside a `.mat` or `.npz` file that contains several, as in `read_arrays`.

    Returns
    -------
    Trial
        Streams on their own time bases, events in chronological order, findings of all files.

    Raises
    ------
    ReadError
        If a file cannot be read, its ending is unknown, or the only ground force is outside the possible range.
    ChannelError
        If two files contain the same channel.
    SamplingError
        If two files contain one stream on different time bases, or the crop is empty.
    UnitError
        If a unit is missing, unknown or contradicted.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.read(["ik.mot", "grf.mot", "emg.sto"], subject="P01", condition="natural")  # doctest: +SKIP
    Trial(...)
    >>> import pandas as pd
    >>> gd.read(pd.DataFrame({"time": [0.0, 0.01, 0.02], "knee_angle_r": [5.0, 6.0, 7.0]}))
    Trial('the table': kinematics 1 at 100 Hz; 0 events, 0 findings)
    """
    files = list(paths) if isinstance(paths, list | tuple) else [paths]
    if not files:
        raise ReadError("a trial must have at least one file", "none is named", "Name its files in the study.")
    trials = [_read(file, channels, reader, part) for file in files]
    streams: dict[str, Recording] = {}
    findings = [finding for t in trials for finding in t.findings]
    for file_trial in trials:
        for key, recording in file_trial.streams.items():
            if key not in streams:
                streams[key] = recording
            elif key == "signals" and not _one_base(streams[key], recording):
                what = f"signals excluded because of a different time base: {', '.join(recording.names[:4])}"
                findings.append(Finding("note", "left out", recording.source.file, what, "these signals"))
            else:
                streams[key] = _join(streams[key], recording, key)
    named = {key: replace(r, subject=subject, condition=condition) for key, r in streams.items()}
    events = tuple(sorted((event for t in trials for event in t.events), key=lambda event: event.time))
    if not any(str(file).lower().endswith(".c3d") for file in files):  # that reader reports unused labels itself
        findings += _list_unused(channels, named, trials[0].name)
    _refuse_events_outside(files, trials, named)
    surfaces = tuple(surface for t in trials for surface in t.surfaces)
    trial = Trial(trials[0].name, named, events, tuple(findings), subject, condition=condition, surfaces=surfaces)
    begin_s = {key: float(recording.time[0]) for key, recording in trial.streams.items() if len(recording.time)}
    trial = trial if crop_s is None else _crop(trial, *crop_s)  # only what a crop leaves is checked
    cleaned, turned = with_flexion_positive(trial.streams)
    cleaned, still = without_frozen(cleaned)
    cleaned, beyond = without_impossible(cleaned, begin_s)
    all_findings = (*trial.findings, *turned, *still, *beyond, *per_kg_findings(trial.streams))
    return replace(trial, streams=cleaned, findings=all_findings)


def read_planned_trial(
    study: Study, participant: Participant, planned: PlannedTrial, reader: C3DReader | None = None
) -> Trial:
    """Trial as a study plans it, named by pseudonym, session, condition, and a number where there are several."""
    if planned.leave_out:
        raise StrideError("the study file leaves out this trial", planned.leave_out, "To use it, remove leave_out.")
    paths = [study.path_of(file) for file in planned.files]
    trial = read_trial(
        paths, study.channels, participant.id, planned.condition, planned.crop_s, reader=reader, part=planned.part
    )
    return replace(trial, name=participant.trial_name(planned))


def _read(source: object, channels: Mapping[str, str] | None, reader: C3DReader | None, part: str) -> Trial:
    if not isinstance(source, Path | str):
        import pandas as pd

        if isinstance(source, pd.DataFrame):
            return read_frame(source, channels)
        raise ReadError(
            "a walk must be given as a file or a DataFrame",
            f"found {type(source).__name__}",
            "Give a path, or a DataFrame with a column 'time' [s] and one column per channel.",
        )
    path = Path(source)
    ending = path.suffix.lower()
    if ending in ARRAYS:
        from gaitdisc.ingest.array_file import read_arrays

        return read_arrays(path, channels, part, reader.process if reader else None)
    if ending == ".c3d":
        from gaitdisc.ingest.c3d import read_c3d

        return reader.read(path, channels) if reader else read_c3d(path, channels)
    if ending not in READERS:
        raise ReadError(
            f"the file type of {path.name} must be one of {', '.join(ENDINGS)}",
            f"its ending is {ending!r}" + hint_nearest(ending, ENDINGS),
            "Export it in one of these formats.",
        )
    return READERS[ending](path, channels)


def _one_base(first: Recording, second: Recording) -> bool:
    if len(first.time) != len(second.time):
        return False
    return bool(np.abs(first.time - second.time).max() <= 1e-3 / first.rate_hz)


def _join(recording: Recording, other: Recording, key: str) -> Recording:
    files = f"{recording.source.file} and {other.source.file}"
    if not _one_base(recording, other):
        raise SamplingError(
            f"two files that contain {key} must have one time base",
            f"{files} have {len(recording.time)} samples from {recording.time[0]:.4g} s at {recording.rate_hz:g} Hz "
            f"and {len(other.time)} from {other.time[0]:.4g} s at {other.rate_hz:g} Hz",
            f"Use one file with all {key}, or list the files as two trials.",
        )
    doubled = sorted(set(recording.names) & set(other.names))
    if doubled:
        raise ChannelError(
            f"two files of one trial must not contain the same channel of {key}",
            f"{files} both contain {doubled[0]!r} ({len(doubled)} in all)",
            "Remove one file, or list the files as two trials.",
        )
    first, second = recording.source, other.source
    names, readers = f"{first.file} + {second.file}", f"{first.reader} + {second.reader}"
    source = Source(names, f"{first.sha256}+{second.sha256}", readers)
    return replace(join_recordings(recording, other), source=source)


def _refuse_events_outside(files: Sequence[object], trials: Sequence[Trial], streams: Mapping[str, Recording]) -> None:
    """Refuse events of a table beside a recording that has another clock."""
    ends = [time for recording in streams.values() for time in (recording.time[0], recording.time[-1])]
    start, end = min(ends, default=0.0), max(ends, default=float("inf"))
    for file, trial in zip(files, trials, strict=True):
        far = [event.time for event in trial.events if not start - EDGE_S <= event.time <= end + EDGE_S]
        if far and not trial.streams:
            raise SamplingError(
                f"{Path(str(file)).name}: events must lie within the recording, from {start:.2f} to {end:.2f} s",
                f"events outside: {len(far)} of {len(trial.events)} (first: {far[0]:.2f} s)",
                "Write times on the recording's clock; in a C3D file its first frame is at 0 s.",
            )


def _list_unused(channels: Mapping[str, str] | None, streams: Mapping[str, Recording], name: str) -> list[Finding]:
    there = {channel.rpartition(".")[0] or channel for r in streams.values() for channel in r.names}
    there |= {channel for r in streams.values() for channel in r.names} | {"time", IGNORE}
    absent = [label for label, entry in (channels or {}).items() if split_unit(entry)[0] not in there]
    if not absent:
        return []
    what = f"labels of [channels] that are in no file of this trial: {', '.join(map(repr, absent[:4]))}"
    return [Finding("note", "not found", name, what, "")]


def _crop(trial: Trial, start_s: float, end_s: float) -> Trial:
    streams = {key: recording.between(start_s, end_s) for key, recording in trial.streams.items()}
    for key, recording in streams.items():
        if len(recording.time) < 2:
            uncropped = trial.streams[key]
            raise SamplingError(
                f"{trial.name}: the crop from {start_s:g} to {end_s:g} s must lie inside the stream {key!r}",
                f"this stream lasts from {uncropped.time[0]:.4g} to {uncropped.time[-1]:.4g} s on the file's clock",
                "Correct crop_s in the study.",
            )
    events = tuple(event for event in trial.events if start_s <= event.time < end_s)
    if "kinematics" in streams:
        kinematics = streams["kinematics"]  # angles stated in degrees may look like radians in what a crop leaves
        angles = kinematics.selected_by(lambda channel: channel.quantity == "angle" and channel.unit == "deg")
        if angles.names:
            plausible_unit(angles.time, angles.values, angles.names, "deg", kinematics.source.file)
    return replace(trial, streams=streams, events=events)


WRITERS = {".mot": write_storage, ".sto": write_storage, ".csv": write_table, ".parquet": write_table}


def write_recording(recording: Recording, path: Path | str, overwrite: bool = False) -> Path:
    """Write a recording to a file that `read` can read, completely or not at all.

    Parameters
    ----------
    recording : Recording
        Recording with any channels: names, times [s] and values are written; marks of suspect samples, subject and
        condition are not.
    path : path
        `.mot` or `.sto` for OpenSim, `.csv` or `.parquet` with the unit of each column.
    overwrite : bool
        Whether to replace a file that `write` did not write, or that was changed since.

    Returns
    -------
    Path
        Path of the written file.

    Raises
    ------
    WriteError
        If the ending is unknown, or the file cannot be written.
    ChannelError
        If a name is not allowed in such a file.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> angles = gd.lowpass(gd.example_walks(10.0)["nominal"].stream("kinematics"))
    >>> gd.write(angles, "angles.mot")  # doctest: +SKIP
    PosixPath('angles.mot')
    """
    ending = Path(path).suffix.lower()
    if ending not in WRITERS:
        raise WriteError(
            f"the name of a recording's file must end with {', '.join(WRITERS)}",
            f"{Path(path).name} ends with {ending!r}" + hint_nearest(ending, WRITERS),
            "Use one of these endings.",
        )
    with guard("gd.write", overwrite=overwrite):
        return WRITERS[ending](recording, path)
