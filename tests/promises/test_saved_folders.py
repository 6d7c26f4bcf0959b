"""Folders that earlier versions saved are read, and nothing in them is changed; tests/test_approved.py draws them."""

import re
import shutil

import pytest
from approve import SAVED

import gaitdisc as gd
from gaitdisc.clinic.clinical_reference import load_reference
from gaitdisc.own_files import file_sha256
from gaitdisc.saved.unit_folder import damage_lines

PAGE = (SAVED.parents[2] / "docs" / "compatibility.md").read_text(encoding="utf-8")
PROMISED = set(re.findall(r"\| `(\w+\.json)` \|", PAGE))
RESULTS = sorted(path.relative_to(SAVED) for name in PROMISED for path in SAVED.rglob(name))


def test_every_kind_that_compatibility_names_is_here():
    assert {path.name for path in RESULTS} == PROMISED and len(PROMISED) == 7


@pytest.mark.parametrize("place", RESULTS, ids=str)
def test_a_saved_result_is_loaded_and_left_as_it_is(place, tmp_path):
    kind = shutil.copytree(SAVED / place.parts[0], tmp_path / "kind")
    before = {path: file_sha256(path) for path in kind.rglob("*") if path.is_file()}
    result = gd.load((kind / place.relative_to(place.parts[0])).parent)
    assert type(result).__module__.startswith("gaitdisc.")
    assert {path: file_sha256(path) for path in kind.rglob("*") if path.is_file()} == before
    assert damage_lines(kind) == ()


def test_a_saved_reference_is_loaded_with_its_people():
    reference = load_reference(SAVED / "cycles" / "reference")
    assert set(reference.legs) == {"nominal", "exo"} and reference.people("nominal") == 1
