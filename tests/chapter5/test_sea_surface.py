"""A sea's surface from netCDF files, its season, and the study of it."""

import ch5_sea_surface
import numpy as np
import pytest
from chapter5.files import read_navy_winds, read_oisst, read_sst_mat, read_sst_pacific, read_variables
from chapter5.modes import season_of
from manufactured_field import travelling_wave
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


WAVE = travelling_wave(58, quantities=2)  # the slower wave has a period of 29, the faster one of 17


def test_departures_and_season_make_up_the_field_again():
    season = season_of(WAVE, np.arange(40), 29)
    apart = season.departures(WAVE)
    np.testing.assert_allclose(apart.values + season.at(np.arange(58)), WAVE.values, atol=1e-6)


def test_what_comes_back_every_year_departs_from_nothing():
    field = type(WAVE)(WAVE.time, np.tile(WAVE.values[:29], (2, 1, 1)), WAVE.axes, WAVE.mask, ("h", "g"), ("m", "m"))
    assert np.abs(season_of(field, np.arange(58), 29).departures(field).values).max() < 1e-6


def test_without_a_season_and_at_a_time_of_year_never_trained_it_is_the_mean():
    season = season_of(WAVE, np.arange(10), 0)
    np.testing.assert_allclose(
        season.at(np.array([3, 57])), np.tile(WAVE.values[:10].mean(axis=0), (2, 1, 1)), atol=1e-6
    )
    season = season_of(WAVE, np.array([0, 1]), 3)
    np.testing.assert_allclose(season.course[2], WAVE.values[:2].mean(axis=0), atol=1e-6)


@pytest.fixture
def fields(gait_data):
    return gait_data.parent / "fields"


def test_the_pacific_as_its_source_tells_it(fields):
    field = read_sst_pacific(fields / "sst_pacific" / "sst_pacific_monthly_1970_2003.npz")
    assert (len(field), field.points, field.mask.shape) == (399, 2261, (30, 84))
    assert (round(float(field.values.min()), 1), round(float(field.values.max()), 1)) == (-3.6, 6.5)
    assert not field.mask[2, 3]  # 25 S, 130 E lies in Australia


def test_the_winds_as_their_source_tells_them(fields):
    field = read_navy_winds(fields / "navy_winds" / "monthly_navy_winds.npz")
    assert (len(field), field.points, field.quantities) == (132, 73 * 144, ("u", "v"))
    trades = field.values[:, field.number_at[42, 76], 0]  # 15 N, 150 W blows from the east
    assert trades.mean() < -3


def test_a_grid_with_holes_winds_that_do_not_fit_and_another_file_are_refused(tmp_path):
    held = {"sst": np.zeros((2, 3)), "landmask": np.zeros(3), "lon": np.array([0, 2, 0]), "lat": np.array([0, 0, 2])}
    np.savez(tmp_path / "a.npz", **held)
    with pytest.raises(ReadError, match=r"a.npz.*3 cells, 2 latitudes.*2 longitudes"):
        read_sst_pacific(tmp_path / "a.npz")
    held = {"u": np.zeros((2, 3, 4)), "v": np.zeros((2, 3, 3)), "lon": np.arange(4.0), "lat": np.arange(3.0)}
    np.savez(tmp_path / "a.npz", **held)
    with pytest.raises(ReadError, match=r"a.npz.*3, 4\).*3, 3\)"):
        read_navy_winds(tmp_path / "a.npz")
    (tmp_path / "a.npz").write_bytes(b"x")
    with pytest.raises(ReadError, match="u, v, lon, lat"):
        read_navy_winds(tmp_path / "a.npz")


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


def test_an_absent_variable_is_named_with_those_there_and_another_file_is_refused(tmp_path):
    with pytest.raises(ReadError, match=r"a.nc.*lacks lat.*has t"):
        read_variables(classic(tmp_path / "a.nc"), ("t", "lat"))
    (tmp_path / "b.nc").write_bytes(b"not netCDF at all")
    with pytest.raises(ReadError, match=r"b.nc.*netCDF"):
        read_variables(tmp_path / "b.nc", ("t",))


def test_routes_stay_on_their_fields_and_come_back_after_a_year(gait_data):
    for field, task, region in ch5_sea_surface.fields():
        routes = ch5_sea_surface.routes_of(field, task.season, region)
        assert [route.sensors for route in routes] == [3, 1, 1, 1, 1, 2, 2, 2, 3]
        for route in routes:
            assert (route.points[: -task.season] == route.points[task.season :]).all()


@pytest.mark.slow
def test_the_quick_study(gait_data, tmp_path):
    result = ch5_sea_surface.run(quick=True, folder=tmp_path)
    temporal = [c for c in result.cells if c.split == "temporal" and c.field.startswith("Pacific")]
    three = {c.model: c for c in temporal if c.route == "3 fixed"}
    assert 0.7 < three["delay ridge"].relative_l2 < 0.9
    assert three["POD ceiling"].relative_l2 < 0.3
    assert (tmp_path / "figures" / "errors-1.png").exists()
