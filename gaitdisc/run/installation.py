"""Whether an installation works: versions, libraries that are extra, and files that are written and read back."""

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from gaitdisc.channel import vocabulary
from gaitdisc.recording import Recording
from gaitdisc.saved.provenance import list_versions

EXTRAS = {
    "torch": "models of chapters 4 and 5",
    "pysindy": "chapter 3 (extra 'chapter3')",
    "pydmd": "chapter 3 (extra 'chapter3')",
    "h5py": "HDF5 and .mat 7.3 files (extra 'fields')",
    "xarray": "netCDF files (extra 'fields')",
    "dask": "more than one machine (extra 'cluster')",
    "typst": "PDF of a person's page (extra 'pdf')",
    "openpyxl": "normal data of Polygon (extra 'xlsx')",
}


@dataclass(frozen=True)
class Check:
    """One thing that was looked at."""

    what: str
    state: str  # `ok`, `absent` (something optional) or `wrong`
    words: str


def checks() -> Iterator[Check]:
    """Everything that is looked at, one after the other; nothing is changed on this machine."""
    for name, number in list_versions().items():
        absent = number == "absent" and name not in EXTRAS
        yield Check(name, "wrong" if absent else "absent" if number == "absent" else "ok", number)
    for name, words in EXTRAS.items():
        if find_spec(name) is None:
            yield Check(name, "absent", f"needed for {words}")
    muscle, knee = _wave("emg_sol_r", rate_hz=1000), _wave("knee_angle_r", rate_hz=100)
    for what, made, file in (("C3D", muscle, "walk.c3d"), (".mot", knee, "walk.mot"), ("CSV", knee, "walk.csv")):
        yield _read_back(what, made, file)


def _wave(name: str, rate_hz: int) -> Recording:
    """Two seconds of a channel that rises and falls."""
    time = np.arange(2 * rate_hz) / rate_hz
    values = np.asarray(np.round(30 + 30 * np.sin(6 * time)), float)
    return Recording(time, values[:, None], (vocabulary().by_name[name],))


def _read_back(what: str, made: Recording, file: str) -> Check:
    """A recording written into a folder of its own, read, and compared number by number."""
    try:
        from gaitdisc.ingest.c3d_writing import write_c3d
        from gaitdisc.ingest.reading import read_trial, write_recording

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / file
            write_c3d([made], path) if path.suffix == ".c3d" else write_recording(made, path)
            trial = read_trial(path)
            stream = next(recording for recording in trial.streams.values() if made.names[0] in recording.names)
            same = np.allclose(stream[made.names[0]], made.values[:, 0], atol=1e-6)
    except Exception as error:  # whatever it is, the installation does not read this kind of file
        return Check(f"reads {what}", "wrong", f"{type(error).__name__}: {error}")
    return Check(f"reads {what}", "ok" if same else "wrong", "as written" if same else "other than written")
