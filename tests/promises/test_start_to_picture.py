"""From the start to a picture: a folder of files is read, filtered and cut; what a Python function lacks is found."""

import matplotlib as mpl
import numpy as np
import pandas as pd
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


TIME = np.arange(0.0, 4.0, 0.1)
HIDDEN = 0.3


def cooling(temperature, rate=0.5):
    return -rate * temperature


def truth(temperature):
    return -0.5 * temperature - HIDDEN * temperature**3


@pytest.mark.slow
def test_what_a_function_lacks_is_found_saved_loaded_drawn_and_run(tmp_path):
    noise, runs = np.random.default_rng(0), []
    for trial in range(2):
        run = gd.simulate(truth, TIME, start=[2.0 - 0.3 * trial])
        measured = run["temperature"] + noise.normal(0.0, 0.005, len(TIME))
        runs.append(pd.DataFrame({"trial": trial, "time": TIME, "temperature": measured}))
    found, augmented = gd.discover(cooling, pd.concat(runs))
    (effect,) = found.effects
    (number,) = effect.estimates.values()
    assert effect.name == "cubic_stiffness" and number.value == pytest.approx(HIDDEN, rel=0.03)

    again = gd.load(found.save(tmp_path / "found"))
    assert isinstance(again, gd.Discovery)
    assert (again.sentence, again.effects) == (found.sentence, found.effects)
    gd.plot.discovery(again, left=True).figure.savefig(tmp_path / "left.png")
    assert (tmp_path / "left.png").stat().st_size > 5000

    later = gd.simulate(augmented, TIME, start=[2.0])["temperature"]
    np.testing.assert_allclose(later, gd.simulate(truth, TIME, start=[2.0])["temperature"], atol=0.02)
