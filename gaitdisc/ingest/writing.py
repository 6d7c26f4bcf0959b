"""A recording written to a file, whatever its ending."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.channel import nearest_word
from gaitdisc.errors import WriteError
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.table import write_table
from gaitdisc.own_files import guarded
from gaitdisc.recording import Recording

WRITERS = {".mot": write_storage, ".sto": write_storage, ".csv": write_table, ".parquet": write_table}


def write_recording(recording: Recording, path: Path | str, overwrite: bool = False) -> Path:
    """Write a recording to a file that `read` reads again, whole or not at all.

    Parameters
    ----------
    recording : Recording
        Any channels, as they are: names, times [s], values. Marks of suspect samples, subject and condition are not
        written.
    path : path
        `.mot` or `.sto` for OpenSim, `.csv` or `.parquet` with the unit of each column.
    overwrite : bool
        Whether a file may be replaced that `write` did not write, or that was changed since.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    WriteError
        If the ending is another one, or the file cannot or may not be written.
    ChannelError
        If a name cannot stand in such a file.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> angles = gd.lowpass(gd.example_walks(10.0)["nominal"].stream("kinematics"))
    >>> gd.write(angles, "angles.mot")  # doctest: +SKIP
    PosixPath('angles.mot')
    """
    ending = Path(path).suffix.lower()
    if ending not in WRITERS:
        nearest = nearest_word(ending, list(WRITERS)) if ending else None
        raise WriteError(
            f"a recording is written to a file that ends with {', '.join(WRITERS)}",
            f"{Path(path).name} ends with {ending!r}" + (f", the nearest is {nearest!r}" if nearest else ""),
            "Name it with one of these endings.",
        )
    with guarded("gd.write", overwrite=overwrite):
        return WRITERS[ending](recording, path)
