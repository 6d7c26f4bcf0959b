import numpy as np
import pytest
from chapter5.files import read_oisst, read_sst_mat
from scipy.io import netcdf_file, savemat

from gaitdisc.errors import ReadError, SamplingError, ShapeError, UnitError

LAT, LON = np.array([1.5, 0.5, -0.5]), np.array([0.5, 1.5])
SEA = np.array([[1, 1], [0, 1], [1, 1]], np.int8)
SST = np.round(20 + np.arange(24.0).reshape(4, 3, 2) / 4, 2)  # degC


def written(path, units="degC", days=(0.0, 7.0, 14.0, 21.0), gap=False):
    with netcdf_file(path, "w") as file:
        for name, count in (("time", 4), ("lat", 3), ("lon", 2)):
            file.createDimension(name, count)
        for name, values in (("lat", LAT), ("lon", LON), ("time", np.array(days) + 69395)):
            file.createVariable(name, "f8", (name,))[:] = values
        file.variables["time"].units = "days since 1800-01-01 00:00:00"
        sst = file.createVariable("sst", "i2", ("time", "lat", "lon"))
        packed = np.round(SST * 100).astype(np.int16)
        packed[2, 0, 1] = 32767 if gap else packed[2, 0, 1]
        sst[:] = packed
        sst.scale_factor, sst.add_offset, sst.missing_value, sst.units = 0.01, 0.0, np.int16(32767), units
    return path


def mask(path, values=SEA):
    with netcdf_file(path, "w") as file:
        for name, count in (("time", 1), ("lat", values.shape[0]), ("lon", values.shape[1])):
            file.createDimension(name, count)
        file.createVariable("mask", "i1", ("time", "lat", "lon"))[:] = values[None]
    return path


def test_weeks_degrees_and_land(tmp_path):
    field = read_oisst(written(tmp_path / "sst.nc"), mask(tmp_path / "lsmask.nc"))
    assert (field.points, field.quantities, field.units, field.time_unit) == (5, ("sst",), ("degC",), "week")
    assert field.time.tolist() == [0, 1, 2, 3]
    assert field.places[0].tolist() == [1.5, 0.5]
    np.testing.assert_allclose(field.values[:, :, 0], SST[:, SEA == 1], atol=1e-5)
    assert len(field.source.sha256) == 64


def test_a_cell_with_a_missing_week_is_left_out(tmp_path):
    assert read_oisst(written(tmp_path / "sst.nc", gap=True)).points == 5


def test_what_is_wrong_is_said(tmp_path):
    with pytest.raises(UnitError, match=r"degrees Celsius.*sst.nc.*'kelvin'"):
        read_oisst(written(tmp_path / "sst.nc", units="kelvin"))
    with pytest.raises(SamplingError, match=r"snapshot 4.*2 week"):
        read_oisst(written(tmp_path / "sst.nc", days=(0, 7, 14, 28)))
    with pytest.raises(ShapeError, match=r"\(3, 2\); lsmask.nc.*\(2, 2\)"):
        read_oisst(written(tmp_path / "sst.nc"), mask(tmp_path / "lsmask.nc", SEA[:2]))


def test_the_published_matlab_file(tmp_path):
    z = np.zeros((180 * 360, 3), np.float32)
    z[0], z[361] = [1, 2, 3], [0, 5, 6]  # the north-western cell, and one in the second row
    savemat(tmp_path / "SST_data.mat", {"Z": z})
    field = read_sst_mat(tmp_path / "SST_data.mat")
    assert field.places.tolist() == [[89.5, 0.5], [88.5, 1.5]]
    assert field.values[:, :, 0].tolist() == [[1, 0], [2, 5], [3, 6]]


def test_other_matlab_files_are_refused(tmp_path):
    savemat(tmp_path / "a.mat", {"Z": np.zeros((4, 3))})
    with pytest.raises(ReadError, match=r"\(64800, weeks\).*\(4, 3\)"):
        read_sst_mat(tmp_path / "a.mat")
    (tmp_path / "b.mat").write_bytes(b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n")
    with pytest.raises(ReadError, match="pointer of Git LFS"):
        read_sst_mat(tmp_path / "b.mat")
    (tmp_path / "c.mat").write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises(ReadError, match=r"version 7.3.*-v7`"):
        read_sst_mat(tmp_path / "c.mat")
