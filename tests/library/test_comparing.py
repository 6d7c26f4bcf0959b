"""Where two walks disagree, of files and of trials."""

import numpy as np
import pytest

import gaitdisc as gd


@pytest.fixture(scope="module")
def walks():
    return gd.example_walks(20.0)


def test_two_trials_and_their_files_say_the_same(walks, tmp_path):
    found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"], detector="angles")
    files = gd.example_files(tmp_path, 20.0)
    of_files = gd.compare(files["exo"][0], files["nominal"][0], ["ankle_angle_r"], detector="angles")
    np.testing.assert_allclose(of_files.curves["gap"], found.curves["gap"], atol=1e-3)
    assert isinstance(found, gd.Mismatch) and found.to_frame()["channel"].unique().tolist() == ["ankle_angle_r"]


def test_a_region_is_as_large_as_the_smallest_that_is_reported(walks):
    found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"], smallest_deg=3.5)
    assert len(found.regions) and (found.regions["gap"].abs() >= 3.5).all()
    assert not len(gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"], smallest_deg=30.0).regions)


def test_one_channel_may_be_named_by_a_word(walks):
    assert gd.compare(walks["exo"], walks["nominal"], "ankle_angle_r").names == ("ankle_angle_r",)
