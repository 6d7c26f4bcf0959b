"""Walks to try things on."""

import numpy as np

import gaitdisc as gd


def test_the_files_hold_the_walks(tmp_path):
    walks, files = gd.example_walks(5.0), gd.example_files(tmp_path, 5.0)
    assert {word: [path.suffix for path in paths] for word, paths in files.items()} == {
        "nominal": [".mot", ".c3d"], "exo": [".mot", ".c3d"]}  # fmt: skip
    read = gd.read(files["exo"])
    np.testing.assert_allclose(
        read.stream("kinematics")["knee_angle_r"], walks["exo"].stream("kinematics")["knee_angle_r"], atol=1e-5
    )
    assert set(read.stream("emg").names) == set(walks["exo"].stream("emg").names)
