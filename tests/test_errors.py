"""The error tree, its codes, and the page that explains each."""

import ast
import pickle
import re
from importlib import import_module
from pathlib import Path

import pytest
from texts import says

from gaitdisc.errors import ChannelError, GaitdiscError

PROJECT = Path(__file__).parents[1]
FILES = {path: path.read_text(encoding="utf-8") for path in sorted((PROJECT / "gaitdisc").rglob("*.py"))}


def kinds():
    """Every class of refusal, by its code."""
    for path, text in FILES.items():
        if re.search(r"^class \w+Error\(", text, re.MULTILINE):
            import_module(".".join(path.relative_to(PROJECT).with_suffix("").parts))
    found, wait = {}, [GaitdiscError]
    while wait:
        one = wait.pop()
        wait += one.__subclasses__()
        if "code" not in vars(one):  # one of its own; a missing file has that of any file that cannot be read
            found[one("", "", "").code] = one
    return {
        code: one for code, one in found.items() if one is not GaitdiscError and one.__module__.startswith("gaitdisc")
    }


def sections():
    page = (PROJECT / "docs" / "errors.md").read_text(encoding="utf-8")
    return {part.partition("\n")[0]: part for part in page.split("\n## ")[1:]}


def template(node):
    """Pattern of a string of the code, anything where a value stands."""
    parts = node.values if isinstance(node, ast.JoinedStr) else [node]
    return "".join(
        re.escape(p.value) if isinstance(p, ast.Constant) and isinstance(p.value, str) else ".*" for p in parts
    )


def refused_by(name):
    """Patterns of what a class is raised with, `needed; found. remedy`."""
    for text in FILES.values():
        for node in ast.walk(ast.parse(text)) if name in text else ():
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == name and len(node.args) >= 3:
                needed, found, remedy = map(template, node.args[:3])
                if len(needed.replace(".*", "")) + len(remedy.replace(".*", "")) > 30:
                    yield f"{'; '.join(filter(None, (needed, found)))}\\. {remedy}"


def test_sentence_says_needed_found_remedy():
    error = ChannelError("strides need a vertical force", "walk.mot has none", "Name it in [channels].")
    assert says(str(error), "walk.mot", "none", "[channels]")
    assert (error.needed, error.found, error.remedy) == error.args


def test_errors_cross_process_borders():
    error = pickle.loads(pickle.dumps(ChannelError("a", "b", "c")))
    assert isinstance(error, GaitdiscError)
    assert (str(error), error.code) == ("a; b. c", "gd-channel")


def test_every_kind_of_refusal_has_its_place_on_the_page_and_none_is_left_over():
    assert set(sections()) == set(kinds())


@pytest.mark.parametrize("code", sorted(kinds()))
def test_the_page_says_what_it_means_with_a_refusal_that_the_code_holds_and_the_remedy(code):
    means, example, remedy = (part.strip() for part in sections()[code].partition("\n")[2].strip().split("\n\n"))
    assert means == kinds()[code].__doc__.partition("\n")[0]
    patterns = list(refused_by(kinds()[code].__name__))
    assert any(re.fullmatch(one, example.removeprefix("> ")) for one in patterns)
    assert remedy.startswith("**Remedy**: ")
