"""What a release needs is checked before anything is built."""

import importlib.util
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]
CHECK = PROJECT / ".ci" / "agreed_version.py"


@pytest.fixture(scope="module")
def check():
    spec = importlib.util.spec_from_file_location("agreed_version", CHECK)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def folder(check, tmp_path):
    """The project's four files, its changes dated."""
    for name in check.PLACES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(PROJECT / name, tmp_path / name)
    changes = tmp_path / "CHANGELOG.md"
    changes.write_text(changes.read_text(encoding="utf-8").replace("(not released)", "(2027-01-31)", 1))
    return tmp_path


def test_the_versions_of_this_project_agree(check):
    assert [line for line in check.disagreements(PROJECT) if "no date" not in line] == []


def test_dated_changes_may_be_released(folder):
    done = subprocess.run([sys.executable, str(CHECK), str(folder)], capture_output=True, text=True, check=True)
    version = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert done.stdout == f"{version}\n"


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("CITATION.cff", "\nversion: ", "\nversion: 9", "CITATION.cff says 9"),
        ("gaitdisc/_version.py", "__version__ = ", "version = ", "gaitdisc/_version.py says no version"),
        ("CHANGELOG.md", "(2027-01-31)", "(not released)", "CHANGELOG.md has no date: write '## "),
    ],
)
def test_what_disagrees_is_said_and_nothing_is_released(folder, name, old, new, said):
    file = folder / name
    file.write_text(file.read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8")
    done = subprocess.run([sys.executable, str(CHECK), str(folder)], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and said in done.stderr


def test_a_release_checks_first_and_builds_wheel_sdist_and_pages():
    recipe = (PROJECT / "Makefile").read_text(encoding="utf-8").partition("\nrelease:")[2].partition("\n\n")[0]
    assert recipe.index("agreed_version.py") < recipe.index("-m build") and "docs" in recipe
    built = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]["targets"]
    assert built["wheel"]["force-include"] == {"data_schema": "gaitdisc/data_schema", "studies": "gaitdisc/studies"}
    assert {"CITATION.cff", "CHANGELOG.md", "studies", "data_schema"} <= set(built["sdist"]["include"])
