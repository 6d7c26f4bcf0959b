import random
import sys

import numpy as np
import pytest
from chapter5.files import read_cutout, read_oisst

from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.hdf5 import SIGNATURE, attributes, data_set, hdf5_file, is_hdf5


def test_the_signature_tells(tmp_path):
    (tmp_path / "a.h5").write_bytes(SIGNATURE + b"rest")
    (tmp_path / "b.nc").write_bytes(b"CDF\x01")
    assert is_hdf5(tmp_path / "a.h5")
    assert not is_hdf5(tmp_path / "b.nc")
    with pytest.raises(ReadError, match=r"absent.nc"):
        is_hdf5(tmp_path / "absent.nc")


def test_a_damaged_file_is_refused(tmp_path):
    pytest.importorskip("h5py")
    (tmp_path / "cut.h5").write_bytes(SIGNATURE + b"\0" * 100)
    said = r"cut.h5 .*HDF5"
    with pytest.raises(ReadError, match=said), hdf5_file(tmp_path / "cut.h5"):
        pass


def test_without_the_library_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ReadError, match=r"pip install 'gaitdisc\[fields\]'"), hdf5_file(tmp_path / "a.h5"):
        pass


def _cutout(path, h5py):
    with h5py.File(path, "w") as file:
        for name, count in zip(("zcoor", "ycoor", "xcoor"), (2, 3, 4), strict=True):
            file[name] = 0.1 * np.arange(count)
        for number, packed in ((1, None), (2, "gzip"), (3, None)):
            file.create_dataset(f"Velocity_{number:04d}", data=np.ones((2, 3, 4, 3), np.float32), compression=packed)


def _temperatures(path, h5py):
    with h5py.File(path, "w") as file:
        sst = file.create_dataset("sst", data=np.ones((5, 3, 4), np.int16))
        sst.attrs.update({"scale_factor": [0.01], "units": np.bytes_("degC"), "missing_value": [np.int16(32767)]})
        file["lat"], file["lon"] = np.arange(3.0), np.arange(4.0)
        file.create_dataset("time", data=7.0 * np.arange(5)).attrs["units"] = np.bytes_("days since 1800")


@pytest.mark.parametrize(
    ("write", "read"), [(_cutout, lambda path: read_cutout([path], 0.002)), (_temperatures, read_oisst)]
)
def test_mutated_files_are_read_or_refused_in_words(tmp_path, write, read):
    """85 of each kind, the same ones every time: flipped bits, bytes at their limits, cut files."""
    write(tmp_path / "sound.h5", pytest.importorskip("h5py"))
    sound, dice, path = (tmp_path / "sound.h5").read_bytes(), random.Random(11), tmp_path / "broken.h5"
    refused = 0
    for number in range(85):
        broken = bytearray(sound)
        for _ in range(dice.randint(1, 30)):
            place = dice.randrange(len(broken))
            broken[place] = broken[place] ^ (1 << dice.randrange(8)) if number % 3 else dice.choice([0, 1, 127, 255])
        path.write_bytes(broken if number % 5 else broken[: dice.randrange(len(broken))])
        try:
            read(path)
        except GaitdiscError as error:
            refused += 1
            assert "broken.h5" in str(error) or "1 cut-outs" in str(error)
    assert 20 < refused < 85


def test_what_is_no_data_set_of_numbers_is_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_group("group")
        file["words"] = ["one", "two"]
        file.create_dataset("huge", (2**20, 2**20), np.float32, chunks=(1, 1024))
    with hdf5_file(tmp_path / "a.h5") as file:
        for name, said in (
            ("group", r"a\.h5: 'group' .*none"),
            ("words", r"a\.h5: 'words' .*another type"),
            ("huge", r"a\.h5: .*4294967296 bytes.*'huge' claims 4398046511104"),
            ("absent", r"a\.h5 .*HDF5.*absent"),
        ):
            with pytest.raises(ReadError, match=said):
                data_set(file, name, tmp_path / "a.h5")


def test_a_text_of_variable_length_is_read_beside_and_within_a_time(tmp_path, monkeypatch):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("t", data=[1.0]).attrs["units"] = "days since Übermorgen"
    with hdf5_file(path) as file:
        assert attributes(file, "t", path, ("units", "absent")) == {"units": "days since Übermorgen"}
        worker = tmp_path / "worker.py"
        worker.write_text("import sys, time; sys.stdin.readline(); time.sleep(60)")
        monkeypatch.setattr("gaitdisc.ingest.hdf5.TEXT_LIMIT_S", 0.1)
        monkeypatch.setattr("gaitdisc.ingest.reader_process.WORKER", worker)
        with pytest.raises(ReadError, match=r"'units'.*'t'.*after 0\.6 s"):
            attributes(file, "t", path, ("units",))
