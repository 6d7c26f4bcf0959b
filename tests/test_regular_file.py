"""Pipes, sockets, devices, folders and huge files: refused in words by every reader, in no time."""

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from chapter5.files import read_cutout, read_head, read_sst_mat, read_sst_pacific, read_variables

import gaitdisc as gd
from gaitdisc.discovery.catalogue import read_catalogue
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.ingest.hdf5 import hdf5_file
from gaitdisc.ingest.reading import ENDINGS, read_trial
from gaitdisc.ingest.study_file import load_study
from gaitdisc.regular_file import LARGEST_BYTES, LARGEST_TEXT_BYTES, check_regular, file_sha256
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.simulation_file import bundled, read_simulation
from gaitdisc.whole_file import write_whole


def _open_hdf5(path):
    pytest.importorskip("h5py")
    with hdf5_file(path):
        pass


READERS = {
    **{f"walk{ending}": read_trial for ending in ENDINGS},
    "study.toml": load_study,
    "model.toml": read_simulation,
    "effects.toml": read_catalogue,
    "measured.csv": lambda path: read_measured(path, bundled("pendulum")),
    "field.nc": lambda path: read_variables(path, ("sst",)),
    "field.h5": read_head,
    "open.h5": _open_hdf5,
    "cut.h5": lambda path: read_cutout([path], 0.002),
    "sst.mat": read_sst_mat,
    "sst.npz": read_sst_pacific,
    "hashed.c3d": file_sha256,
}
linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="pipes, devices and sockets of Linux")


@linux
@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("kind", ["pipe", "socket", "device", "zero"])
def test_what_is_no_file_is_refused_by_every_reader(tmp_path, name, kind, request):
    path = tmp_path / name
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "socket":
        one = socket.socket(socket.AF_UNIX)
        request.addfinalizer(one.close)
        one.bind(str(path))
    else:
        path.symlink_to("/dev/zero" if kind == "zero" else "/dev/null")
    word = {"pipe": "a named pipe", "socket": "a socket"}.get(kind, "a device")
    with pytest.raises(ReadError, match=rf"{name}.*{word}. Give the path of a file."):
        READERS[name](path)


@pytest.mark.parametrize("name", [f"walk{ending}" for ending in ENDINGS])
def test_a_folder_named_like_a_recording_is_refused(tmp_path, name):
    (tmp_path / name).mkdir()
    with pytest.raises(ReadError, match="folder"):
        read_trial(tmp_path / name)


@pytest.mark.parametrize("name", READERS)
def test_eight_gibibytes_are_refused_before_they_are_read(tmp_path, name):
    path = tmp_path / name
    with path.open("wb") as file:
        file.truncate(8 * LARGEST_TEXT_BYTES)  # a hole: it takes no room on the disk
    with pytest.raises(ReadError, match=rf"at most .* {name} has (8 GiB|8388608 KiB)"):
        READERS[name](path)


def test_the_limits_are_met_to_the_byte(tmp_path):
    path = tmp_path / "a.c3d"
    for largest in (1000, LARGEST_TEXT_BYTES, LARGEST_BYTES):
        with path.open("wb") as file:
            file.truncate(largest)
        assert check_regular(path, largest) == largest
        with path.open("ab") as file:
            file.truncate(largest + 1)
        with pytest.raises(ReadError):
            check_regular(path, largest)
    with pytest.raises(FileNotFoundError):
        check_regular(tmp_path / "absent")


@linux
def test_check_of_a_pipe_ends_with_a_refusal(tmp_path):
    """As a user meets it: the command in a process of its own, which a pipe would hold for ever."""
    os.mkfifo(tmp_path / "x.c3d")
    done = subprocess.run(
        [sys.executable, "-m", "gaitdisc", "check", str(tmp_path / "x.c3d"), "--json"],
        capture_output=True,
        text=True,
        timeout=600,  # a pipe would hold it for ever
        check=False,
        cwd=Path(__file__).parents[1],
    )
    (seen,) = json.loads(done.stdout)
    assert seen["light"] == "red" and "x.c3d is a named pipe" in seen["refusal"]


@pytest.mark.parametrize("ending", [".c3d", ".mot", ".csv", ".mat", ".npz", ".parquet"])
def test_a_name_with_nul_is_refused_in_a_sentence(tmp_path, ending):
    said = r"NUL character; found 'a\\x00b.*'"
    with pytest.raises(ReadError, match=said):
        gd.read(f"{tmp_path}/a\0b{ending}")
    with pytest.raises(ReadError, match=said):
        write_whole(f"{tmp_path}/a\0b{ending}", "text")
    with pytest.raises(ReadError, match=said):
        gd.read_simulation(f"{tmp_path}/a\0b.toml")


def test_a_study_that_names_a_file_with_nul_is_refused_at_its_line(tmp_path):
    people = '[[participants]]\nid = "P1"\n[[participants.trials]]\ncondition = "a"\nfiles = ["x\\u0000.mot"]\n'
    (tmp_path / "study.toml").write_text(f'[conditions]\nnominal = "a"\ndevice = "b"\n{people}')
    with pytest.raises(SchemaError, match=r"line.*NUL.*'x\\x00.mot'"):
        load_study(tmp_path)
