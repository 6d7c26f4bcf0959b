"""The names of `import gaitdisc as gd`: loaded when first used, seen by type checkers, documented with an example."""

import ast
import inspect
from pathlib import Path

import pytest
from fresh_process import modules_loaded_by
from numpydoc.docscrape import FunctionDoc

import gaitdisc as gd
from gaitdisc.simulation.parts import Term

SOURCE = Path(gd.__file__)
MOST_NAMES = 60


def test_the_package_loads_nothing_by_itself():
    assert not modules_loaded_by("gaitdisc") & {"numpy", "pandas", "torch", "typing"}


def test_every_name_is_there_and_listed_once():
    assert len(gd.__all__) == len(set(gd.__all__)) <= MOST_NAMES
    assert {name for name in gd.__all__ if getattr(gd, name) is None} == set()
    assert set(gd.__all__) <= set(dir(gd))


def test_type_checkers_see_the_names_that_are_loaded():
    seen = {}
    for node in ast.walk(ast.parse(SOURCE.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("gaitdisc"):
            seen |= {alias.asname or alias.name: (node.module, alias.name) for alias in node.names}
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple):  # those of another name inside
            for name, inside in zip(node.targets[0].elts, node.value.elts, strict=True):
                seen[name.id] = seen.pop(inside.id)
    loaded = {
        name: (f"gaitdisc.{module}", inside) if inside else (f"gaitdisc.{module.rpartition('.')[0]}", name)
        for name, (module, inside) in gd._HOME.items()
    }
    assert seen.pop("__version__") == ("gaitdisc._version", "__version__")
    assert seen == loaded
    assert sorted(gd.__all__) == sorted(loaded)


def test_a_name_that_is_none_of_them_is_refused():
    with pytest.raises(AttributeError, match="has no attribute 'discovr'"):
        gd.discovr  # noqa: B018


def _functions():
    public = {name: getattr(gd, name) for name in gd.__all__ if inspect.isfunction(getattr(gd, name))}
    drawn = {f"plot.{name}": thing for name, thing in vars(gd.plot).items()
             if inspect.isfunction(thing) and thing.__module__ == gd.plot.__name__ and name[0] != "_"}  # fmt: skip
    return public | drawn


def test_every_function_has_its_parameters_what_it_returns_and_an_example():
    lacking = []
    for name, function in _functions().items():
        doc = FunctionDoc(function)
        if any(not entry.desc for entry in doc["Parameters"]) or not (doc["Examples"] and inspect.getdoc(function)):
            lacking.append(name)
        returned = inspect.signature(function).return_annotation
        if not doc["Returns"] and returned not in ("None", None, "Axes") and name not in PLAIN:
            lacking.append(f"{name}: what it returns")
    assert lacking == []


# what their first line says they return
PLAIN = ("bundled_simulation",)


def test_the_reference_shows_every_name_first():
    page = (SOURCE.parents[1] / "docs" / "reference.md").read_text(encoding="utf-8")
    shown = [line.removeprefix("::: gaitdisc.") for line in page.splitlines() if line.startswith("::: gaitdisc.")]
    assert shown[: len(gd.__all__)] == list(gd._HOME)


def test_what_a_notebook_shows_is_short_and_names_what_it_is():
    walk = gd.example_walks(10.0)["nominal"]
    pendulum = gd.bundled_simulation("pendulum")
    shown = {
        "Trial": walk,
        "Recording": walk.stream("emg"),
        "Contacts": gd.contacts(walk)["r"],
        "Strides": gd.cycles(walk),
        "Inspection": gd.check(walk),
        "Simulation": pendulum.with_effect(Term("omega", "equation", "viscous_damping", "-0.4*omega")),
    }
    for name, thing in shown.items():
        assert repr(thing).startswith(name) and len(repr(thing)) <= 160 and "\n" not in repr(thing)
        if name != "Contacts":
            assert thing._repr_html_().startswith("<table><caption>")
    assert "viscous_damping at omega" in repr(shown["Simulation"]) and "-0.4*omega" in shown["Simulation"]._repr_html_()
    assert "green" in repr(shown["Inspection"]) and "<th>emg</th>" in walk._repr_html_()


def test_completion_shows_the_names_alone_and_a_misspelt_one_finds_its_neighbour():
    assert "stride" not in dir(gd) and "recording" not in dir(gd) and {"read", "plot", "__version__"} <= set(dir(gd))
    with pytest.raises(AttributeError) as refused:
        gd.low_pass  # noqa: B018
    assert (refused.value.name, refused.value.obj) == ("low_pass", gd)  # of which Python makes its "Did you mean"
