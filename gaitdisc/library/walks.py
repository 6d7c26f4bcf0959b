"""What a script may give where a walk is wanted."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, Union

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.ingest.columns import stream_of
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.table import frame_columns
from gaitdisc.recording import Recording, Trial

if TYPE_CHECKING:
    import pandas as pd

Walk: TypeAlias = Union[Trial, Recording, Path, str, "pd.DataFrame", Sequence["Path | str | pd.DataFrame"]]
PLAIN = ("signal", "1")
Kind = tuple[str, str]  # quantity and unit


def recording_of(signal: Recording | Trial | pd.DataFrame, kind: Kind | None = None) -> Recording:
    """Recording of every column of a table beside its times, under its own names; a recording as it is.

    Names of the vocabulary have their unit, all others none, where no kind is given.
    """
    if isinstance(signal, Recording):
        return signal
    if isinstance(signal, Trial):
        raise ChannelError(
            "one stream of a trial is taken, not all of them",
            f"{signal.name} has {', '.join(signal.streams) or 'none'}",
            'Give one of them: trial.stream("kinematics"), for instance.',
        )
    if not hasattr(signal, "columns"):
        raise ShapeError(
            "a recording is a Recording, or a DataFrame with times [s] in a column 'time'",
            f"found {type(signal).__name__}",
            "Read a file with gaitdisc.read first; put arrays into a DataFrame.",
        )
    columns = frame_columns(signal)
    known = {} if kind else {channel.name: channel for channel in vocabulary().channels}
    channels = tuple(known.get(label) or Channel(label, *(kind or PLAIN)) for label in columns.labels)
    return Recording(columns.time, columns.values, channels)


def trial_of(walk: Walk) -> Trial:
    """Trial of a walk: itself, what its files or tables hold, or a recording sorted into streams."""
    if isinstance(walk, Trial):
        return walk
    if not isinstance(walk, Recording):
        return read_trial(walk)
    keys = dict.fromkeys(map(stream_of, walk.channels))
    streams = {key: walk.selected_by(lambda channel, key=key: stream_of(channel) == key) for key in keys}
    return Trial(walk.source.file or "the recording", streams, subject=walk.subject, condition=walk.condition)
