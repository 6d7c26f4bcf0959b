"""What chapter 3 recommends is imported by one name, wherever the studies lie."""

import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]
ASKED = """
from gaitdisc.studies.chapter3.recommend import recommend
print(recommend(0.001, 3000, "interpretability").method)
"""


def test_a_checkout_has_them_beside_the_package():
    path = importlib.import_module("gaitdisc.studies").__path__
    assert list(path) == [str(PROJECT / "studies")]


@pytest.mark.slow
def test_a_wheel_has_them_within_and_recommend_is_imported_alike(tmp_path):
    for folder, place in (("gaitdisc", "."), ("studies", "gaitdisc"), ("data_schema", "gaitdisc")):
        shutil.copytree(PROJECT / folder, tmp_path / place / folder)  # what was compiled as well: else it takes 10 s
    for place in (tmp_path, PROJECT):
        said = subprocess.run([sys.executable, "-c", ASKED], cwd=place, env={"PYTHONPATH": str(place)},
                              capture_output=True, text=True, check=True)  # fmt: skip
        assert said.stdout == "sindy\n"
