import importlib
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow
STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture(scope="module")
def row():
    sys.path.insert(0, str(STUDIES))
    try:
        study = importlib.import_module("hidden_effects_in_gait")
    finally:
        sys.path.remove(str(STUDIES))
    return study.run(1, ("spring",), study.Setting()).iloc[0]


def test_the_exoskeletons_spring_is_named_at_the_ankle_and_nothing_else(row):
    assert row["named"] == "one_sided_spring at ankle_moment"


def test_its_stiffness_and_engagement_are_those_of_the_device(row):
    assert row["value"] == pytest.approx(row["truth"], rel=0.05)
    assert row["engaged_rad"] == pytest.approx(row["engaged_truth_rad"], abs=0.01)


def test_the_held_out_error_falls_near_the_noise(row):
    """Real angles hold what neither the device nor white noise explains."""
    assert row["after"] < 1.6 * row["floor"] < 0.5 * row["before"]
