import numpy as np
import pytest

import gaitdisc as gd
from gaitdisc.errors import WriteError


@pytest.fixture
def angles():
    time = np.arange(50) / 100
    return gd.Recording(time, np.column_stack([30 * np.sin(time), time]), tuple(map(angle, ("knee_angle_r", "tilt"))))


def angle(name):
    return gd.Channel(name, "angle", "deg", "r" if name.endswith("_r") else "")


@pytest.mark.parametrize("ending", ["mot", "sto", "csv", "parquet", "MOT"])
def test_what_is_written_is_read_again(angles, tmp_path, ending):
    file = gd.write(angles, tmp_path / f"walk.{ending}")
    again = gd.read(file).stream("kinematics")
    np.testing.assert_allclose(again["knee_angle_r"], angles["knee_angle_r"], rtol=1e-12)
    np.testing.assert_allclose(again.time, angles.time, atol=1e-12)


@pytest.mark.parametrize(("name", "said"), [("walk.txt", "ends with '.txt'"), ("walk.parqet", "nearest is '.parquet'")])
def test_another_ending_is_refused_before_anything_is_written(angles, tmp_path, name, said):
    with pytest.raises(WriteError, match=said):
        gd.write(angles, tmp_path / name)
    assert list(tmp_path.iterdir()) == []
