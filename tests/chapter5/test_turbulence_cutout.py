import numpy as np
import pytest
from chapter5.files import read_cutout

from gaitdisc.errors import ReadError, SamplingError, ShapeError

h5py = pytest.importorskip("h5py")
SHAPE = (2, 3, 4)  # z, y, x


def written(path, numbers, shift=0.0, shape=(*SHAPE, 3)):
    with h5py.File(path, "w") as file:
        for name, count in zip(("zcoor", "ycoor", "xcoor"), SHAPE, strict=True):
            file[name] = shift + 0.1 * np.arange(count)
        for number in numbers:
            file[f"Velocity_{number:04d}"] = number + np.arange(np.prod(shape), dtype=np.float32).reshape(shape)
    return path


def test_snapshots_of_several_files_in_order(tmp_path):
    parts = [written(tmp_path / "b.h5", [9]), written(tmp_path / "a.h5", [1, 5])]
    field = read_cutout(parts, 0.002)
    assert (len(field), field.points, field.quantities) == (3, 24, ("u", "v", "w"))
    np.testing.assert_allclose(field.time, [0, 0.008, 0.016])
    assert field.values[:, 0, 0].tolist() == [1, 5, 9]
    assert [axis.name for axis in field.axes] == ["z", "y", "x"]
    assert field.on_grid(field.values[0, :, 2])[0, 1, 2] == 1 + 3 * (4 + 2) + 2  # x fastest, then y


def test_what_is_wrong_is_said(tmp_path):
    one = written(tmp_path / "a.h5", [1])
    with pytest.raises(ReadError, match=r"b.h5 holds Velocity_0001 again"):
        read_cutout([one, written(tmp_path / "b.h5", [1])], 0.002)
    with pytest.raises(ShapeError, match=r"c.h5.*a.h5"):
        read_cutout([one, written(tmp_path / "c.h5", [2], shift=1.0)], 0.002)
    with pytest.raises(SamplingError, match=r"evenly spaced"):
        read_cutout([written(tmp_path / "d.h5", [1, 2, 4])], 0.002)
    with pytest.raises(ShapeError, match=r"3, 4, 3\).*e.h5.*3, 2, 3\)"):
        read_cutout([written(tmp_path / "e.h5", [1], shape=(4, 3, 2, 3))], 0.002)
    with pytest.raises(ReadError, match=r"Pressure_0001.*a.h5.*Velocity_0001"):
        read_cutout([one], 0.002, "pressure")
    with pytest.raises(ReadError, match=r"requested: 'heat'"):
        read_cutout([one], 0.002, "heat")
    with pytest.raises(ReadError, match=r"no file was named"):
        read_cutout([], 0.002)


def test_a_file_without_coordinates_is_refused(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["Velocity_0001"] = np.zeros((*SHAPE, 3))
    with pytest.raises(ReadError, match=r"a.h5 lacks zcoor, ycoor, xcoor"):
        read_cutout([tmp_path / "a.h5"], 0.002)
