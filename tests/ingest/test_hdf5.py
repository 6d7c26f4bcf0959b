import sys

import pytest

from gaitdisc.errors import ReadError
from gaitdisc.ingest.hdf5 import SIGNATURE, hdf5_file, is_hdf5


def test_the_signature_tells(tmp_path):
    (tmp_path / "a.h5").write_bytes(SIGNATURE + b"rest")
    (tmp_path / "b.nc").write_bytes(b"CDF\x01")
    assert is_hdf5(tmp_path / "a.h5")
    assert not is_hdf5(tmp_path / "b.nc")
    with pytest.raises(ReadError, match=r"absent.nc is to be read; No such file"):
        is_hdf5(tmp_path / "absent.nc")


def test_a_damaged_file_is_refused(tmp_path):
    pytest.importorskip("h5py")
    (tmp_path / "cut.h5").write_bytes(SIGNATURE + b"\0" * 100)
    said = r"cut.h5 is to be read as HDF5; it cannot be: .* Fetch the file again"
    with pytest.raises(ReadError, match=said), hdf5_file(tmp_path / "cut.h5"):
        pass


def test_without_the_library_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ReadError, match=r"pip install 'gaitdisc\[fields\]'"), hdf5_file(tmp_path / "a.h5"):
        pass
