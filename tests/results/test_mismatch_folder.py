import numpy as np
import pandas as pd
import pytest
from driven_walker import DrivenWalker

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.errors import SchemaError
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.results.mismatch_folder import load_mismatch, save_mismatch


@pytest.fixture(scope="module")
def mismatch():
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    return compare_walks(*walk_pair(*walks))


def test_saved_is_loaded(mismatch, tmp_path):
    save_mismatch(mismatch, tmp_path)
    again = load_mismatch(tmp_path)
    for name, curves in mismatch.curves.items():
        np.testing.assert_array_equal(again.curves[name], curves)
    pd.testing.assert_frame_equal(again.regions, mismatch.regions)
    pd.testing.assert_frame_equal(again.summary, mismatch.summary)
    assert (again.exchange, again.findings, again.channels) == (
        mismatch.exchange,
        mismatch.findings,
        mismatch.channels,
    )


def test_a_changed_table_is_told(mismatch, tmp_path):
    save_mismatch(mismatch, tmp_path)
    (tmp_path / "regions.csv").write_text("channel\n")
    with pytest.raises(SchemaError, match=r"regions\.csv is changed since it was saved"):
        load_mismatch(tmp_path)
