"""Public docstrings name the real parameters, in order."""

from __future__ import annotations

import importlib
import inspect
import pkgutil

import pytest
from numpydoc.docscrape import FunctionDoc

import gaitdisc


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


def _is_data_class_or_function(thing) -> bool:
    return inspect.isfunction(thing) or "__dataclass_fields__" in vars(thing)


@pytest.mark.parametrize(("name", "thing"), list(_public()), ids=lambda value: value if isinstance(value, str) else "")
def test_docstring_names_the_real_parameters(name, thing):
    text = inspect.getdoc(thing)
    assert text, f"{name} has no docstring"
    if not _is_data_class_or_function(thing):
        return
    signature = [p for p in inspect.signature(thing).parameters if p not in ("self", "cls")]
    documented = [
        part.strip().lstrip("*") for entry in FunctionDoc(thing)["Parameters"] for part in entry.name.split(",")
    ]
    assert documented == signature, f"{name}: documented {documented}, signature {signature}"


@pytest.mark.parametrize(("name", "thing"), list(_public()), ids=lambda value: value if isinstance(value, str) else "")
def test_functions_take_at_most_seven_arguments(name, thing):
    if inspect.isfunction(thing):
        arguments = [p for p in inspect.signature(thing).parameters if p not in ("self", "cls")]
        assert len(arguments) <= 7, f"{name} takes {len(arguments)} arguments"
