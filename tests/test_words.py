"""Words of this house alone stay out of what a user reads."""

import ast
import io
import re
import tokenize
from functools import cache
from pathlib import Path

import pytest
import typer.main

from gaitdisc.cli import COMMANDS, app

PROJECT = Path(__file__).parents[1]
# In the field's English: reconstructed, estimated, reported, distinguished, requested, tested, fitted, stable, added.
PRIVATE = re.compile(
    r"\b(told|tells?|telling|asked|asks?|tamed?|let in|lets in|accounts?|inquir(?:y|ies)|judge[sd]?|judging|manieth)\b",
    re.IGNORECASE,
)
# In code and its comments besides: process noise, stable, kept, penalised
PRIVATE_IN_CODE = re.compile(PRIVATE.pattern[:-3] + r"|shaken|shaking|paid|unheard)\b", re.IGNORECASE)
# Where the word is no private one: what stands there, and why.
ALLOWED = {"muscle activation patterns account for muscle activity": "title of a paper"}


def without_allowed(text: str) -> str:
    """The text without what may stand."""
    for allowed in ALLOWED:
        text = text.replace(allowed, "")
    return text


def found_in(text: str) -> list[str]:
    """Private words, each with what stands around it."""
    text = without_allowed(text)
    return [text[max(0, m.start() - 40) : m.end() + 30].replace("\n", " ") for m in PRIVATE.finditer(text)]


def prose(page: str) -> str:
    """A page of Markdown without code, links and names of modules."""
    page = re.sub(r"```.*?```", "", page, flags=re.DOTALL)
    page = re.sub(r"^:::.*$", "", page, flags=re.MULTILINE)
    return re.sub(r"`[^`\n]*`|\]\([^)]*\)", "", page)


PAGES = [PROJECT / "README.md", PROJECT / "CONTRIBUTING.md", *sorted((PROJECT / "docs").glob("*.md"))]
PAGES += sorted((PROJECT / "studies" / "results").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages(page):
    text = page.read_text(encoding="utf-8")
    assert found_in(prose(text)) == []
    lines = re.sub(r"```.*?```", "", text, flags=re.DOTALL).splitlines()
    assert [line for line in lines if len(line) > 160 and not line.startswith(("|", ">", "<!--", "!["))] == []
    assert page.name != "README.md" or len(text.splitlines()) <= 90


def test_help_of_every_command():
    group = typer.main.get_command(app)
    commands = {name: group.get_command(None, name) for name in COMMANDS} | {"gaitdisc": group}
    helps = {
        name: " ".join([command.help or "", *(getattr(one, "help", None) or "" for one in command.params)])
        for name, command in commands.items()
    }
    assert len(helps) > 10
    assert {name: found for name, text in helps.items() if (found := found_in(text))} == {}


@cache
def texts_in(source: str) -> tuple[list[str], set[str]]:
    """String literals with a space in them, a text that is joined from parts is one; and docstrings."""
    nodes = list(ast.walk(ast.parse(source)))
    bodies = [node.body for node in nodes if hasattr(node, "body") and isinstance(node.body, list)]
    docstrings = {id(body[0].value) for body in bodies if body and isinstance(body[0], ast.Expr)}
    texts = [node for node in nodes if isinstance(node, ast.Constant) and id(node) not in docstrings]
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    said = {ast.get_docstring(node) or "" for node in nodes if isinstance(node, kinds)}
    return [node.value for node in texts if isinstance(node.value, str) and " " in node.value.strip()], said


def test_what_pages_findings_and_errors_are_made_of():
    found = {}
    for path in sorted((PROJECT / "gaitdisc").rglob("*.py")):
        words = [word for text in texts_in(path.read_text(encoding="utf-8"))[0] for word in found_in(text)]
        if words:
            found[str(path.relative_to(PROJECT))] = words
    assert found == {}


def test_templates_and_files_that_users_open():
    paths = [*(PROJECT / "gaitdisc").rglob("*.j2"), *(PROJECT / "gaitdisc").rglob("*.toml")]
    paths += [path for path in (PROJECT / "data_schema").iterdir() if path.is_file()]
    texts = {path.name: path.read_text(encoding="utf-8") for path in paths}
    assert {name: found for name, text in texts.items() if (found := found_in(text))} == {}


def test_first_lines_of_studies_and_benchmarks():
    """They are the text of `--help`."""
    for path in [*(PROJECT / "studies").glob("*.py"), *(PROJECT / "benchmarks").glob("*.py")]:
        assert found_in(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "") == [], path.name


def words_of_code(source: str) -> list[str]:
    """Private words in names, comments and docstrings, each once and in its line."""
    texts = set(texts_in(source)[1])
    for kind, word in {token[:2] for token in tokenize.generate_tokens(io.StringIO(source).readline)}:
        if kind == tokenize.COMMENT:
            texts.add(word)
        elif kind == tokenize.NAME:
            texts.add(re.sub(r"_|(?<=[a-z])(?=[A-Z])", " ", word))
    return sorted({one.group().lower() for text in texts for one in PRIVATE_IN_CODE.finditer(without_allowed(text))})


def code_by_room() -> dict[str, dict[str, list[str]]]:
    """Files with private words in their code, by room; a file beside the rooms is a room of its own."""
    found: dict[str, dict[str, list[str]]] = {}
    for path in sorted((PROJECT / "gaitdisc").rglob("*.py")):
        where = path.relative_to(PROJECT / "gaitdisc")
        if words := words_of_code(path.read_text(encoding="utf-8")):
            found.setdefault(where.parts[0], {})[where.as_posix()] = words
    return found


def test_names_comments_and_docstrings_of_the_package():
    found = code_by_room()
    assert found == {}


def test_a_private_word_is_found_inside_a_name_a_comment_and_a_docstring():
    source = 'class ToldBy:\n    """Judged by ear."""\n\n    def is_tame(self):  # asked\n        return "told"\n'
    assert words_of_code(source) == ["asked", "judged", "tame", "told"]
    assert words_of_code("masked = untold = Hotelling  # satellite") == []


def test_the_list_finds_a_private_word_and_leaves_code_alone():
    assert found_in("7 states are told") == ["7 states are told"]
    assert found_in("angles are reconstructed; untold, tellurium") == []
    assert prose("`told` in\n```\ntold\n```\n::: account\n") == " in\n\n\n"
