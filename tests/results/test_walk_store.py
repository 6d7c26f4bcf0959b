import re

import numpy as np
import pandas as pd

from gaitdisc.results.walk_store import load_walk, save_walk, unit_name


def test_a_walk_comes_back_as_it_was(walk, tmp_path):
    save_walk(walk, tmp_path, "key")
    loaded, key = load_walk(tmp_path)
    assert key == "key"
    np.testing.assert_array_equal(loaded.curves, walk.curves)
    pd.testing.assert_frame_equal(loaded.strides, walk.strides, check_dtype=False)
    for name in ("subject", "condition", "duration_s", "rate_hz", "detector", "channels", "findings", "files"):
        assert getattr(loaded, name) == getattr(walk, name)


def test_a_folder_name_has_no_characters_that_a_disk_refuses():
    assert re.fullmatch(r"P_1-10___up_hill-[0-9a-f]{8}", unit_name("P/1", "10 % up:hill"))


def test_no_two_walks_share_a_folder():
    """Conditions that differ in signs alone, and a hyphen in the pseudonym or in the condition."""
    walks = [("P01", "[exo]"), ("P01", "(exo)"), ("P01", "_exo_"), ("P01-a", "b"), ("P01", "a-b")]
    assert len({unit_name(*walk) for walk in walks}) == len(walks)
