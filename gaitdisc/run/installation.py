"""Whether an installation works: versions, libraries that are extra, and files that are written and read back."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from gaitdisc.channel import vocabulary
from gaitdisc.recording import Recording
from gaitdisc.saved.provenance import installed_versions

EXTRAS = {
    "torch": "models of chapters 4 and 5",
    "pysindy": "chapter 3, extra chapter3",
    "pydmd": "chapter 3, extra chapter3",
    "h5py": "HDF5 and .mat 7.3, extra fields",
    "xarray": "netCDF, extra fields",
    "dask": "more than one machine, extra cluster",
    "c3d": "the second C3D reader",
}


@dataclass(frozen=True)
class Check:
    """One thing that was looked at."""

    what: str
    state: str  # `ok`, `absent` (something optional) or `wrong`
    words: str


def checks() -> Iterator[Check]:
    """Everything that is looked at, one after the other; nothing is changed on this machine."""
    for name, number in installed_versions().items():
        absent = number == "absent" and name not in EXTRAS
        yield Check(name, "wrong" if absent else "absent" if number == "absent" else "ok", number)
    for name, words in EXTRAS.items():
        if find_spec(name) is None:
            yield Check(name, "absent", f"needed for {words}")
    for what, written in (("C3D", _c3d), (".mot", _storage), ("CSV", _table)):
        yield _read_back(what, written)


def _knee() -> Recording:
    time = np.arange(200) / 100
    channel = vocabulary().named("knee_angle_r")
    assert channel is not None
    return Recording(time, np.asarray(np.round(30 + 30 * np.sin(6 * time)), float)[:, None], (channel,))


def _read_back(what: str, written: Callable[[Path], tuple[Recording, str]]) -> Check:
    """A recording written into a folder of its own, read, and compared number by number."""
    from gaitdisc.ingest.reading import read_trial

    try:
        with tempfile.TemporaryDirectory() as folder:
            made, file = written(Path(folder))
            found = read_trial(Path(folder) / file)
            stream = next(one for one in found.streams.values() if made.names[0] in one.names)
            same = np.allclose(stream[made.names[0]], made.values[:, 0], atol=1e-6)
    except Exception as error:  # whatever it is, the installation does not read this kind of file
        return Check(f"reads {what}", "wrong", f"{type(error).__name__}: {error}")
    return Check(f"reads {what}", "ok" if same else "wrong", "as written" if same else "other than written")


def _c3d(folder: Path) -> tuple[Recording, str]:
    from gaitdisc.ingest.c3d_writing import write_c3d

    time = np.arange(2000) / 1000
    channel = vocabulary().named("emg_sol_r")
    assert channel is not None
    made = Recording(time, np.round(np.sin(time) * 1024)[:, None] / 1024, (channel,))
    write_c3d([made], folder / "walk.c3d")
    return made, "walk.c3d"


def _storage(folder: Path) -> tuple[Recording, str]:
    from gaitdisc.ingest.storage import write_storage

    made = _knee()
    write_storage(made, folder / "walk.mot")
    return made, "walk.mot"


def _table(folder: Path) -> tuple[Recording, str]:
    from gaitdisc.ingest.table import write_table

    made = _knee()
    write_table(made, folder / "walk.csv")
    return made, "walk.csv"
