"""A class that says in which file it is saved; whatever is saved is recognised by its JSON file."""

import pytest

from gaitdisc.batch.citations import citations_of
from gaitdisc.errors import SchemaError
from gaitdisc.report.saved_page import draw_saved
from gaitdisc.results import kind as kinds
from gaitdisc.results.kind import Kind, Saved, load_saved
from gaitdisc.results.study_run import UNITS


class Kept(Saved, file="kept.json"):
    pass


WRITTEN = []
KEPT = Kind(Kept, "kept.json", write=lambda *given: WRITTEN.append(given))


def test_a_result_is_saved_by_its_kind_and_gives_the_folder(tmp_path, monkeypatch):
    monkeypatch.setitem(kinds.KINDS, "kept.json", "kept:KEPT")
    monkeypatch.setattr(kinds, "load_word", {"kept:KEPT": KEPT}.get)
    one = Kept()
    assert one.save(str(tmp_path / "x")) == tmp_path / "x"
    assert [(one, tmp_path / "x")] == WRITTEN


def test_every_word_names_the_kind_of_its_file_and_every_class_is_of_a_kind():
    every = {file: kinds.load_word(word) for file, word in kinds.KINDS.items()}
    assert {file: kind.file for file, kind in every.items()} == {file: file for file in every}
    nouns = {kind.noun for kind in every.values()}
    assert {kind for kind in Saved.__subclasses__() if kind is not Kept and not kind.__subclasses__()} <= nouns


def test_every_unit_of_a_run_is_of_a_kind():
    assert all(isinstance(kinds.load_word(word), Kind) for word in UNITS.values())


def test_no_result_is_refused(tmp_path):
    with pytest.raises(SchemaError, match="holds nothing"):
        load_saved(tmp_path)


def test_a_fitted_model_has_neither_page_nor_citations(tmp_path):
    (tmp_path / "model.json").touch()
    for refused in (draw_saved, citations_of):
        with pytest.raises(SchemaError, match=r"holds model\.json, a fitted model"):
            refused(tmp_path)
