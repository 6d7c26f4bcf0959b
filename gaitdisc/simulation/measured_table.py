"""Reading measured trials: a CSV or Parquet table, or recordings."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import hint_nearest, nearest_word
from gaitdisc.errors import ChannelError, GaitdiscError, MissingFileError, ReadError, UnitError
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Values
from gaitdisc.regular_file import LARGEST_TEXT_BYTES, check_regular
from gaitdisc.simulation.even_time import TrialColumns
from gaitdisc.simulation.measured import Measured, check_measured
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.units import offset_words, unit_factor

if TYPE_CHECKING:
    import pandas as pd

ENDINGS = (".csv", ".parquet")
_OTHER_TIME = re.compile(r"(?i)(time|t)[\s_\[(]*(ms|msec|milliseconds?|us|µs|ns|min|minutes?)[\])]*|frames?|samples?")


def read_measured(path: Path | str, simulation: Simulation) -> Measured:
    """Trials of a table with the columns `trial`, `time` [s], each input and each observed channel.

    Without a column `trial` the table is one trial. Of observations that the simulation file does not list (each state
    under its own name) those are taken that the table has.
    """
    path = Path(path)
    return gather_table(_table(path), simulation, path.name)


def gather_table(table: pd.DataFrame, simulation: Simulation, source: str) -> Measured:
    """Trials of a table that is already read, in the simulation's units, as `read_measured` has them."""
    columns = [str(column).strip() for column in table.columns]
    _refuse_doubled(columns, source)
    table = table.set_axis(columns, axis="columns").reset_index(drop=True)
    inputs = tuple(signal.name for signal in simulation.inputs)
    channels = _channels(simulation, columns, source)
    for name in ("time", *inputs):
        if name not in columns:
            raise _missing(name, columns, source)
    trial = _trials(table, source)
    numbers = {name: _numbers(table, name, trial, source) for name in dict.fromkeys(("time", *inputs, *channels))}
    timeless = np.flatnonzero(~np.isfinite(numbers["time"]))
    if timeless.size:
        raise ReadError(
            "every row must have a time",
            f"{source}, line {timeless[0] + 2} (trial {trial[timeless[0]]!r}) has none",
            "Fill the column 'time', or remove the row.",
        )
    order = list(dict.fromkeys(trial.tolist()))
    trials = []
    for name in order:
        rows = np.flatnonzero(trial == name)
        series = {key: values[rows] for key, values in numbers.items()}
        trials.append(_columns(str(name), series["time"], series, inputs, channels))
    return check_measured(trials, inputs, channels, source, _report_left_out(simulation, columns, channels, source))


def gather_recordings(recordings: Sequence[Recording], simulation: Simulation) -> Measured:
    """Trials of recordings at one rate, one each, converted to the simulation's units."""
    inputs = tuple(signal.name for signal in simulation.inputs)
    findings: dict[str, Finding] = {}
    trials = []
    channels = _channels(simulation, recordings[0].names, recordings[0].source.file or "recording 1")
    for number, recording in enumerate(recordings, 1):
        name = recording.source.file or f"recording {number}"
        numbers = {}
        for column in dict.fromkeys((*inputs, *channels)):
            if column not in recording.names:
                raise _missing(column, recording.names, name)
            values = _convert(recording, column, simulation, name, findings)
            doubtful = int(np.count_nonzero(np.asarray(recording.suspect)[:, recording.names.index(column)]))
            if doubtful:
                what = f"samples marked as unreliable: {doubtful} of {len(values)}"
                findings[f"{name} {column}"] = Finding(
                    "warning", "suspect", name, what, "results that depend on these samples", column
                )
            numbers[column] = values
        trials.append(_columns(name, np.array(recording.time), numbers, inputs, channels))
    return check_measured(trials, inputs, channels, trials[0].name, list(findings.values()))


def _columns(
    name: str, time: Values, numbers: Mapping[str, Values], inputs: Sequence[str], channels: Sequence[str]
) -> TrialColumns:
    none = np.empty((len(time), 0))
    driving, observed = (np.column_stack([numbers[key] for key in names] or [none]) for names in (inputs, channels))
    return TrialColumns(name, time, driving, observed)


def _table(path: Path) -> pd.DataFrame:
    import pandas as pd

    if path.suffix.lower() not in ENDINGS:
        fault = f"{path.name} is a folder" if path.is_dir() else f"{path.name} ends in {path.suffix!r}"
        remedy = "Export the data as CSV, with all trials in one table and a column 'trial'."
        raise ReadError("measured data must be one CSV or Parquet table", fault, remedy)
    try:
        check_regular(path, LARGEST_TEXT_BYTES)
        if path.suffix.lower() == ".parquet":
            from pyarrow.parquet import read_schema

            _refuse_doubled(read_schema(path).names, path.name)
            return pd.read_parquet(path)
        with path.open(encoding="utf-8-sig") as file:
            head = file.readline(100_000)
        european = ";" in head
        _refuse_doubled(head.split(";" if european else ","), path.name)
        return pd.read_csv(
            path,
            sep=";" if european else ",",
            decimal="," if european else ".",
            dtype={"trial": str},
            encoding="utf-8-sig",
            skipinitialspace=True,
            low_memory=False,
        )
    except GaitdiscError:
        raise
    except OSError as error:
        fault = f"{path.name}: {error.strerror or error}"
        kind = MissingFileError if isinstance(error, FileNotFoundError) else ReadError
        raise kind("measured data must be a table", fault, "Check the path.") from error
    except Exception as error:  # pandas and pyarrow have no common ancestor of theirs
        fault = f"{path.name}: {str(error).splitlines()[0][:200] if str(error) else type(error).__name__}"
        raise ReadError("measured data must be a CSV or Parquet table", fault, "Export the file again.") from error


def _refuse_doubled(head: Sequence[str], file: str) -> None:
    names = [name.strip().strip('"') for name in head]
    doubled = next((name for name in names if name and names.count(name) > 1), None)
    if doubled is not None:
        raise ChannelError("each column must have its own name", f"{file} has {doubled!r} twice", "Rename one of them.")


def _channels(simulation: Simulation, columns: Sequence[str], file: str) -> tuple[str, ...]:
    """Observed channels that the data have."""
    names = tuple(name for name, _ in simulation.observations)
    if simulation.observations != tuple((state.name, state.name) for state in simulation.states):
        for name in names:
            if name not in columns:
                raise _missing(name, columns, file)
        return names
    there = tuple(name for name in names if name in columns)
    if not there:
        raise _missing(names[0], columns, file)
    return there


def _missing(name: str, columns: Sequence[str], file: str) -> ChannelError:
    timed = next((column for column in columns if _OTHER_TIME.fullmatch(column)), None) if name == "time" else None
    if timed is not None:
        return ChannelError(
            "the measured data must have a column 'time' in seconds",
            f"{file} has {timed!r}",
            "Convert this column to seconds and call it 'time'.",
        )
    hint = hint_nearest(name, columns)
    listed = ", ".join(columns[:20]) + (", ..." if len(columns) > 20 else "")
    return ChannelError(
        f"the measured data must have a column {name!r}",
        f"{file} has {listed}{hint}",
        f"Rename the column to {name!r}, or change the simulation file.",
    )


def _trials(table: pd.DataFrame, file: str) -> NDArray[np.object_]:
    if "trial" not in table.columns:
        nearest = nearest_word("trial", [column for column in table.columns if column != "time"])
        if nearest:
            raise _missing("trial", list(table.columns), file)
        return np.full(len(table), "1", object)
    empty = np.flatnonzero(table["trial"].isna().to_numpy())
    if empty.size:
        raise ReadError("every row must name its trial", f"{file}, line {empty[0] + 2} has none", "Fill in 'trial'.")
    return table["trial"].astype(str).to_numpy(object)


def _numbers(table: pd.DataFrame, name: str, trial: NDArray[np.object_], file: str) -> Values:
    import pandas as pd

    if pd.api.types.is_datetime64_any_dtype(table[name]) or pd.api.types.is_timedelta64_dtype(table[name]):
        raise ReadError(
            "every cell of a measured column must be a number" + (", time in seconds" if name == "time" else ""),
            f"{file}, column {name!r} contains dates or clock times, first {table[name].iloc[0]}",
            "Write seconds since the start of the trial." if name == "time" else "Write numbers.",
        )
    values = pd.to_numeric(table[name], errors="coerce").to_numpy(float)
    bad = np.flatnonzero(~np.isfinite(values) & ~table[name].isna().to_numpy())
    if bad.size:
        row = int(bad[0])
        raise ReadError(
            "every cell of a measured column must be a number or empty",
            f"{file}, line {row + 2} (trial {trial[row]!r}), column {name!r} contains {str(table[name].iloc[row])!r}"
            + (f"; {bad.size} such cells" if bad.size > 1 else ""),
            "Write a number, or leave the cell empty.",
        )
    return values


def _report_left_out(
    simulation: Simulation, columns: Sequence[str], channels: tuple[str, ...], file: str
) -> list[Finding]:
    """Report states that are not measured, and columns that nothing uses; of both at once, one may be the other."""
    findings = []
    absent = [name for name, _ in simulation.observations if name not in channels]
    known = {"trial", "time", *channels, *(signal.name for signal in simulation.inputs)}
    unused = [column for column in columns if column not in known]
    if absent and unused:
        raise ChannelError(
            "if an observation has no column, every column must be used: an unused one may be misnamed",
            f"{file} has no column {', '.join(absent)}, and these are not used: {', '.join(unused[:10])}",
            "Rename or remove these columns, or list the measured channels under [observations].",
        )
    if absent:
        what = f"not measured: {', '.join(absent)}"
        findings.append(Finding("note", "not measured", file, what, "nothing; these states follow from the others"))
    if unused:
        listed = ", ".join(unused[:10]) + (", ..." if len(unused) > 10 else "")
        findings.append(Finding("note", "unused columns", file, listed, ""))
    return findings


def _convert(
    recording: Recording, name: str, simulation: Simulation, file: str, findings: dict[str, Finding]
) -> Values:
    """Channel in the simulation's unit."""
    channel = recording.channels[recording.names.index(name)]
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs)}
    observed = dict(simulation.observations).get(name, name)
    to = simulation.sensor(name).unit or units.get(name, units.get(observed.strip()))
    unstated = (channel.quantity, channel.unit) == ("signal", "1")  # numbers of which no unit is known
    factor = None if to is None or unstated else unit_factor(channel.unit, to)
    if factor is None:
        what = (
            f"{channel.unit!r} cannot be compared with the simulation's unit, {to!r}"
            if to
            else f"{channel.unit!r} is used unchanged"
        )
        findings[name] = Finding("note", "unit", file, what, "nothing if file and simulation use the same unit", name)
        return recording[name]
    if np.isnan(factor):
        raise UnitError(
            f"{name!r} must have a unit of the same kind as {to!r} in the simulation",
            f"{file} has it in {channel.unit!r}{offset_words(channel.unit, to or '')}",
            "Correct the unit in the simulation file or in the study.",
        )
    return recording[name] if factor == 1.0 else recording[name] * factor
