"""Public docstrings name the real parameters, in order: each test lists all that differ."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from pathlib import Path

import pytest
from numpydoc.docscrape import FunctionDoc

import gaitdisc

PROJECT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def public():
    return dict(_public())


def _public():
    for info in pkgutil.walk_packages(gaitdisc.__path__, "gaitdisc."):
        if info.name.startswith(("gaitdisc.cli", "gaitdisc.data_schema")) or info.name.endswith("__main__"):
            continue
        module = importlib.import_module(info.name)
        for name, thing in vars(module).items():
            if name.startswith("_") or getattr(thing, "__module__", None) != info.name:
                continue
            if info.name == f"gaitdisc.commands.{name}":
                continue  # a command's parameters are explained by its options
            if inspect.isfunction(thing):
                yield f"{info.name}.{name}", thing
            elif inspect.isclass(thing):
                yield f"{info.name}.{name}", thing
                for method, function in vars(thing).items():
                    written_here = inspect.isfunction(function) and function.__module__ == info.name  # not by pydantic
                    if written_here and not method.startswith("_"):
                        yield f"{info.name}.{name}.{method}", function


def _signature(thing) -> list[str]:
    if hasattr(thing, "_fields"):
        return list(thing._fields)
    return [name for name in inspect.signature(thing).parameters if name not in ("self", "cls")]


def _documented(thing) -> list[str]:
    entries = FunctionDoc(thing)["Attributes" if hasattr(thing, "_fields") else "Parameters"]
    return [part.strip().lstrip("*") for entry in entries for part in entry.name.split(",")]


def _differing(public) -> list[str]:
    """What each public thing whose docstring names other parameters documents, and what it takes."""
    listed = {
        name: thing
        for name, thing in public.items()
        if inspect.isfunction(thing) or "__dataclass_fields__" in vars(thing) or hasattr(thing, "_fields")
    }
    return [
        f"{name}: documented {_documented(thing)}, signature {_signature(thing)}"
        for name, thing in listed.items()
        if inspect.getdoc(thing) and _documented(thing) != _signature(thing)
    ]


def test_every_public_thing_has_a_docstring(public):
    assert len(public) > 1000
    assert [name for name, thing in public.items() if not inspect.getdoc(thing)] == []


def test_docstrings_name_the_real_parameters(public):
    assert _differing(public) == []


def test_functions_take_at_most_seven_arguments(public):
    functions = {name: thing for name, thing in public.items() if inspect.isfunction(thing)}
    assert [name for name, thing in functions.items() if len(_signature(thing)) > 7] == []


def test_the_reference_shows_every_module_and_none_that_is_gone(public):
    page = (PROJECT / "docs" / "reference.md").read_text(encoding="utf-8")
    shown = [line.removeprefix("::: ") for line in page.splitlines() if line.startswith("::: ")]
    shown = [
        name for name in shown if name.removeprefix("gaitdisc.") not in gaitdisc.__all__
    ]  # test_library.py has these
    modules = {thing.__module__ for name, thing in public.items() if not name.startswith("gaitdisc.commands.")}
    assert sorted(modules - set(shown)) == []
    assert [name for name in shown if not (PROJECT / f"{name.replace('.', '/')}.py").is_file()] == []


def test_a_docstring_that_names_another_parameter_is_found():
    def wrong(length_m):
        """Take a length.

        Parameters
        ----------
        length : float [m]
            Of the leg.
        """

    assert _differing({"wrong": wrong, "none": lambda x: x}) == ["wrong: documented ['length'], signature ['length_m']"]
