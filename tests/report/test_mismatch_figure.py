import numpy as np
import pytest
from driven_walker import DrivenWalker

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.report.figure import save_figure
from gaitdisc.report.mismatch_figure import mismatch_figures, mismatch_numbers


@pytest.fixture(scope="module")
def mismatch():
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    return compare_walks(*walk_pair(*walks), ("ankle_angle_r", "knee_angle_r"))


def test_the_numbers_drawn_are_those_found(mismatch):
    numbers = mismatch_numbers(mismatch, ["ankle_angle_r"])
    column = mismatch.names.index("ankle_angle_r")
    np.testing.assert_array_equal(numbers["gap"], mismatch.curves["gap"][:, column])
    shaded = numbers["percent"][numbers["differs"]]
    row = mismatch.regions_of("ankle_angle_r")[0]
    assert row["from_percent"] in shaded.to_numpy()


def test_curves_and_gap_are_drawn_alike_each_time(mismatch, tmp_path):
    figures = mismatch_figures(mismatch)
    assert [figure.name for figure in figures] == ["mismatch-curves", "mismatch-gap"]
    assert "right ankle angle" in figures[0].alt
    assert "permutation test" in figures[0].caption
    for figure, again in zip(figures, mismatch_figures(mismatch), strict=True):
        assert save_figure(figure, tmp_path / "a").data == save_figure(again, tmp_path / "b").data
