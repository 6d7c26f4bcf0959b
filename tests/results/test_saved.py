"""A class that says what saves it; whatever is saved is recognised by its JSON file."""

import sys
from importlib import import_module
from operator import attrgetter
from types import ModuleType

import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results.saved import READERS, Saved, load_saved


class Kept(Saved, by="test_saved_store:write"):
    pass


def test_a_result_is_saved_by_what_its_class_names_and_gives_the_folder(tmp_path, monkeypatch):
    written, store = [], ModuleType("test_saved_store")
    store.write = lambda *given: written.append(given)
    monkeypatch.setitem(sys.modules, "test_saved_store", store)
    one = Kept()
    assert one.save(str(tmp_path / "x")) == tmp_path / "x"
    assert written == [(one, tmp_path / "x")]


def test_what_reads_and_what_saves_a_kind_is_there():
    for place in (*READERS.values(), *(kind._by for kind in Saved.__subclasses__() if kind is not Kept)):
        module, _, name = place.partition(":")
        assert callable(attrgetter(name)(import_module(module))), place


def test_no_result_is_refused(tmp_path):
    with pytest.raises(SchemaError, match="holds nothing"):
        load_saved(tmp_path)
