"""What may be given where a walk is wanted, and walks to try things on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, Union

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.cohort.cohort import make_walks, the_twelve
from gaitdisc.cohort.demonstration import write_trial
from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.ingest.columns import find_stream
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.table import frame_columns
from gaitdisc.own_files import guard
from gaitdisc.recording import Recording, Trial
from gaitdisc.whole_file import write_together

if TYPE_CHECKING:
    import pandas as pd

Walk: TypeAlias = Union[Trial, Recording, Path, str, "pd.DataFrame", Sequence["Path | str | pd.DataFrame"]]
PLAIN = ("signal", "1")
Kind = tuple[str, str]  # quantity and unit


def make_recording(signal: Recording | Trial | pd.DataFrame, kind: Kind | None = None) -> Recording:
    """Recording of every column of a table beside its times, under its own names; a recording as it is.

    Names of the vocabulary have their unit, all others none, where no kind is given.
    """
    if isinstance(signal, Recording):
        return signal
    if isinstance(signal, Trial):
        raise ChannelError(
            "this function must be given one stream of a trial",
            f"{signal.name} has {', '.join(signal.streams) or 'no stream'}",
            'Select a stream, for example trial.stream("kinematics").',
        )
    if not hasattr(signal, "columns"):
        raise ShapeError(
            "a recording must be a Recording, or a DataFrame with times [s] in a column 'time'",
            f"found {type(signal).__name__}",
            "Read a file with gaitdisc.read first, or put arrays into a DataFrame.",
        )
    time, labels, values = frame_columns(signal)
    known = {} if kind else vocabulary().by_name
    channels = tuple(known.get(label) or Channel(label, *(kind or PLAIN)) for label in labels)
    return Recording(time, values, channels)


def make_trial(walk: Walk) -> Trial:
    """Trial of a walk: itself, what its files or tables hold, or a recording sorted into streams."""
    if isinstance(walk, Trial):
        return walk
    if not isinstance(walk, Recording):
        return read_trial(walk)
    keys = dict.fromkeys(map(find_stream, walk.channels))
    streams = {key: walk.selected_by(lambda channel, key=key: find_stream(channel) == key) for key in keys}
    return Trial(walk.source.file or "the recording", streams, subject=walk.subject, condition=walk.condition)


def example_walks(duration_s: float = 20.0) -> dict[str, Trial]:
    """Simulate two walks of one person on a treadmill, as a laboratory would record them.

    Parameters
    ----------
    duration_s : float
        Length of each walk [s].

    Returns
    -------
    dict of str to Trial
        `nominal`, without a device, and `exo`, with a spring at the ankle; each with joint angles at 100 Hz,
        and with raw EMG and ground forces at 1000 Hz.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> sorted(gd.example_walks(5.0))
    ['exo', 'nominal']
    """
    return make_walks(the_twelve()[0], duration_s).trials


def example_files(folder: Path | str, duration_s: float = 20.0, overwrite: bool = False) -> dict[str, tuple[Path, ...]]:
    """Write the walks of `example_walks` as files of a laboratory, to try out `read`.

    Parameters
    ----------
    folder : path
        Output folder; created if missing.
    duration_s : float
        Length of each walk [s].
    overwrite : bool
        Whether to replace files that `example_files` did not write, or that were changed since.

    Returns
    -------
    dict of str to tuple of Path
        `nominal` and `exo`: joint angles as OpenSim's `.mot`, EMG and forces as `.c3d`.

    Raises
    ------
    WriteError
        If a file cannot be written.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.read(gd.example_files("example")["nominal"])  # doctest: +SKIP
    """
    place = Path(folder)
    walks = example_walks(duration_s)
    with guard("gd.example_files", overwrite=overwrite), write_together():
        return {word: tuple(place / name for name in write_trial(trial, place, word)) for word, trial in walks.items()}
