import numpy as np
import pytest
from chapter5.files import read_variables
from scipy.io import netcdf_file

from gaitdisc.errors import ReadError


def classic(path):
    with netcdf_file(path, "w") as file:
        file.createDimension("x", 3)
        packed = file.createVariable("t", "i2", ("x",))
        packed[:] = [100, 32767, -250]
        packed.scale_factor, packed.add_offset, packed.missing_value, packed.units = 0.01, 1.0, np.int16(32767), "degC"
    return path


def test_packed_numbers_become_what_is_meant(tmp_path):
    found = read_variables(classic(tmp_path / "a.nc"), ("t",))["t"]
    assert found.units == "degC"
    np.testing.assert_allclose(found.unpacked(), [2.0, np.nan, -1.5], atol=1e-6)


def test_netcdf4_reads_alike(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.nc", "w") as file:
        held = file.create_dataset("t", data=np.array([100, 32767, -250], np.int16))
        held.attrs.update({"scale_factor": [0.01], "add_offset": [1.0], "missing_value": [np.int16(32767)]})
        held.attrs["units"] = np.bytes_("degC")
    found = read_variables(tmp_path / "a.nc", ("t",))["t"]
    assert found.units == "degC"
    np.testing.assert_allclose(found.unpacked(), [2.0, np.nan, -1.5], atol=1e-6)


def test_an_absent_variable_is_named_with_those_there(tmp_path):
    with pytest.raises(ReadError, match=r"a.nc.*lacks lat.*has t"):
        read_variables(classic(tmp_path / "a.nc"), ("t", "lat"))


def test_another_file_is_refused(tmp_path):
    (tmp_path / "b.nc").write_bytes(b"not netCDF at all")
    with pytest.raises(ReadError, match=r"b.nc.*netCDF"):
        read_variables(tmp_path / "b.nc", ("t",))
