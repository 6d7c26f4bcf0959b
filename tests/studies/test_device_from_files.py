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
        study = importlib.import_module("device_from_files")
    finally:
        sys.path.remove(str(STUDIES))
    return study.run(1, 777101, True).iloc[0]


def test_the_exoskeletons_spring_is_named_from_the_files(row):
    assert row["right"]


def test_the_named_effect_leaves_less_of_the_moment_than_the_device_walks_own_muscle_model(row):
    assert row["Nominal + named effect"] < row["Exo"] < row["Nominal"]
