import numpy as np
import pytest
from chapter5.files import read_navy_winds, read_sst_pacific

from gaitdisc.errors import ReadError


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


def test_a_grid_with_holes_is_refused(tmp_path):
    held = {"sst": np.zeros((2, 3)), "landmask": np.zeros(3), "lon": np.array([0, 2, 0]), "lat": np.array([0, 0, 2])}
    np.savez(tmp_path / "a.npz", **held)
    with pytest.raises(ReadError, match=r"a.npz.*3 cells, 2 latitudes.*2 longitudes"):
        read_sst_pacific(tmp_path / "a.npz")


def test_winds_that_do_not_fit_are_refused(tmp_path):
    held = {"u": np.zeros((2, 3, 4)), "v": np.zeros((2, 3, 3)), "lon": np.arange(4.0), "lat": np.arange(3.0)}
    np.savez(tmp_path / "a.npz", **held)
    with pytest.raises(ReadError, match=r"a.npz.*3, 4\).*3, 3\)"):
        read_navy_winds(tmp_path / "a.npz")


def test_another_file_is_refused(tmp_path):
    (tmp_path / "a.npz").write_bytes(b"x")
    with pytest.raises(ReadError, match="u, v, lon, lat"):
        read_navy_winds(tmp_path / "a.npz")
