"""A folder of files goes through reading, filtering and cutting to one figure."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

import gaitdisc as gd

mpl.use("Agg")


def drawn(files, channel, ax):
    """Cycles of every file on one figure; how many."""
    count = 0
    for file in files:
        walk = gd.read(file)
        angles = gd.lowpass(walk.stream("kinematics"), 6.0)
        assert set(gd.contacts(walk)) == {"r", "l"}
        strides = gd.cycles(walk, "r", recording=angles)
        gd.plot.cycles(angles, strides, channel, ax)
        count += len(strides)
    return count


def test_the_files_of_a_folder_become_one_figure(tmp_path):
    gd.example_files(tmp_path, 10.0)
    ax = Figure().subplots()
    count = drawn(sorted(tmp_path.glob("*.mot")), "knee_angle_r", ax)
    means = [line for line in ax.lines if line.get_linewidth() == 1.2]
    assert count > 10 and len(means) == 2
    assert all(50 < np.max(line.get_ydata()) < 75 for line in means)  # swing flexion of a knee [deg]
    ax.figure.savefig(tmp_path / "knees.png")
    assert (tmp_path / "knees.png").stat().st_size > 5000


@pytest.mark.slow
def test_real_walks_on_a_treadmill_become_one_figure_too(gait_data):
    files = sorted((gait_data / "treadmill_walk_ik").glob("*.mot"))[:2]
    if not files:
        pytest.skip("no walks on a treadmill")
    ax = Figure().subplots()
    assert drawn(files, "knee_angle_r", ax) > 10
