"""Walks to try things on: two of a simulated person of the embedded cohort."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.batch.demonstration import write_trial
from gaitdisc.cohort.cohort import the_twelve, walks_of
from gaitdisc.own_files import guarded
from gaitdisc.recording import Trial
from gaitdisc.whole_file import written_together


def example_walks(duration_s: float = 20.0) -> dict[str, Trial]:
    """Two walks of one simulated person on a treadmill, as a laboratory would record them.

    Parameters
    ----------
    duration_s : float
        Length of each [s].

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
    return walks_of(the_twelve()[0], duration_s).trials


def example_files(folder: Path | str, duration_s: float = 20.0, overwrite: bool = False) -> dict[str, tuple[Path, ...]]:
    """Write the walks of `example_walks` as a laboratory's files, to try reading on.

    Parameters
    ----------
    folder : path
        Where; made if missing.
    duration_s : float
        Length of each walk [s].
    overwrite : bool
        Whether files may be replaced that `example_files` did not write, or that were changed since.

    Returns
    -------
    dict of str to tuple of Path
        `nominal` and `exo`: joint angles as OpenSim's `.mot`, EMG and forces as `.c3d`.

    Raises
    ------
    WriteError
        If a file cannot or may not be written.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.read(gd.example_files("example")["nominal"])  # doctest: +SKIP
    """
    place = Path(folder)
    walks = example_walks(duration_s)
    with guarded("gd.example_files", overwrite=overwrite), written_together():
        return {word: tuple(place / name for name in write_trial(trial, place, word)) for word, trial in walks.items()}
