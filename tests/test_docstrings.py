"""What the library offers is documented whole; elsewhere a docstring names real parameters alone, in order."""

import importlib
import inspect
import pkgutil
import re

import pytest
from numpydoc.docscrape import FunctionDoc
from texts import says

import gaitdisc


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


ENTRY = re.compile(
    r"^(?!returns\b|raises\b|Source\b)([a-z_]\w*(?:, \w+)*)(?: .*\)| .*\])?: ", re.M
)  # name (shape) [unit]: words


def _documented(thing) -> list[str]:
    """Names of the entries of a docstring: of numpydoc's sections, or of the lines that stand in their place inside."""
    entries = FunctionDoc(thing)["Attributes" if hasattr(thing, "_fields") else "Parameters"]
    below = (inspect.getdoc(thing) or "").partition("\n\n")[2].partition(">>> ")[0].split("\n\n")
    heads = [entry.name for entry in entries] or [
        head for lines in below if ENTRY.match(lines) for head in ENTRY.findall(lines)
    ]
    return [part.strip().lstrip("*") for head in heads for part in head.split(",")]


def _takes_parameters(thing) -> bool:
    return inspect.isfunction(thing) or "__dataclass_fields__" in vars(thing) or hasattr(thing, "_fields")


def _offered(public) -> dict[str, object]:
    """Of the public things, those that `import gaitdisc` offers, with the methods of its classes."""
    homes = {f"gaitdisc.{module}.{name}".rstrip(".") for module, name in gaitdisc._HOME.values()}
    return {name: thing for name, thing in public.items() if name in homes or name.rpartition(".")[0] in homes}


def _with_other_parameters(public, whole=False) -> list[str]:
    """What each thing documents that it does not take, or not in that order; `whole`: or not all that it takes."""
    return [
        f"{name}: documented {_documented(thing)}, signature {_signature(thing)}"
        for name, thing in public.items()
        if _takes_parameters(thing)
        and inspect.getdoc(thing)
        and [one for one in _signature(thing) if whole or one in _documented(thing)] != _documented(thing)
    ]


def test_what_the_library_offers_documents_every_parameter(public):
    offered = _offered(public)
    assert len(offered) > 100
    assert _with_other_parameters(offered, whole=True) == []


def test_no_docstring_names_a_parameter_that_is_not_there(public):
    assert len(public) > 1000
    assert _with_other_parameters(public) == []


def test_a_line_in_place_of_a_section_names_a_real_parameter_too():
    def right(length_m, time):
        """Take a length, or what
        we have in common: nothing.

        time, length_m (frame,) [m]: of the leg; what stands below
            is no name: it is indented
        returns frames (frame,): whole
        """

    def wrong(length_m):
        """Take a length.

        length (leg, 3) [m]: of the leg
        """

    [said] = _with_other_parameters({"right": right})
    assert says(said, "right", "['time', 'length_m']", "['length_m', 'time']")
    [said] = _with_other_parameters({"wrong": wrong})
    assert says(said, "wrong", "['length']", "['length_m']")


def test_a_docstring_that_names_another_parameter_is_found():
    def wrong(length_m):
        """Take a length.

        Parameters
        ----------
        length : float [m]
            Of the leg.
        """

    said = ["wrong: documented ['length'], signature ['length_m']"]
    assert _with_other_parameters({"wrong": wrong, "none": lambda x: x}) == said
    assert _with_other_parameters({"wrong": wrong, "none": lambda x: x}, whole=True) == said
