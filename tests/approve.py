"""Texts that a user reads are approved in tests/approved, one file each: pages, help, refusals and findings.

    python tests/approve.py            # shows what differs from the approved texts
    python tests/approve.py --yes      # and approves it

So a sentence is mended in one place and read once more here; tests hold errors by class, file, channel, number and
unit. Pages are those of the saved folders in tests/data/saved. Refusals and findings stand by room as the code has
them, `{name}` where a value stands.
"""

import ast
import contextlib
import difflib
import io
import re
import shutil
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from fnmatch import fnmatchcase
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from unittest.mock import patch

TESTS = Path(__file__).parent
APPROVED, SAVED = TESTS / "approved", TESTS / "data" / "saved"
sys.path.insert(0, str(TESTS / "house"))
from budget import CHECKOUT, read_rooms  # noqa: E402

LINES = frozenset(("title", "p", "h1", "h2", "h3", "tr", "figcaption", "li", "dt", "dd", "summary", "a", "div", "img"))
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?")  # P01 is a name


class Words(HTMLParser):
    """Words of a page, a line for each paragraph and row; figures by what is said in their place."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.parts: list[str] = []
        self.silent = 0
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """A new line, a cell, or the words of a figure."""
        self.silent += tag in ("style", "script", "svg")
        self.parts += ["\n"] * (tag in LINES) + [" | "] * (tag in ("td", "th"))
        self.parts += [f"[figure: {dict(attrs).get('alt')}]"] * (tag == "img")

    def handle_endtag(self, tag: str) -> None:
        """The end of what is not read."""
        self.silent -= tag in ("style", "script", "svg")

    def handle_data(self, data: str) -> None:
        """Words."""
        self.parts += [re.sub(r"\s+", " ", data)] * (not self.silent)

    def text(self) -> str:
        """All lines that hold something."""
        lines = (re.sub(r"[ \xa0]+", " ", line).strip(" |") for line in "".join(self.parts).splitlines())
        return "\n".join(filter(None, lines)) + "\n"


def draw_pages(kind: str) -> dict[str, str]:
    """Words of all pages that `gaitdisc report` draws of a saved folder; figures are laid out and not painted."""
    from gaitdisc.cli import app

    unpainted = [patch(f"gaitdisc.report.figure.{name}", lambda _: b"") for name in ("_svg", "_png")]
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        for one in (*unpainted, contextlib.redirect_stdout(io.StringIO())):
            stack.enter_context(one)
        copied = shutil.copytree(SAVED / kind, Path(folder) / kind)
        app(["report", str(copied)], standalone_mode=False)
        pages = sorted(copied.rglob("*.html"))
        return {
            f"pages/{kind}/{page.relative_to(copied).with_suffix('.txt').as_posix()}": Words(page.read_text()).text()
            for page in pages
        }


def list_help() -> dict[str, str]:
    """What `--help` says of each command: itself, its arguments and options, without the layout of a terminal."""
    import typer

    from gaitdisc.cli import COMMANDS, app

    group: Any = typer.main.get_command(app)
    texts = {}
    for name in COMMANDS:
        command = group.get_command(None, name)
        lines = [command.help, ""]
        for one in command.params:
            lines.append(f"{', '.join((*one.opts, *one.secondary_opts))}: {getattr(one, 'help', '') or ''}")
        texts[f"help/{name}.txt"] = "\n".join(lines) + "\n"
    return texts


def list_templates() -> dict[str, str]:
    """Refusals and findings of each room, as the code has them."""
    rooms, _ = read_rooms()
    owner = {pattern: name for name, room in rooms.items() for pattern in room["files"]}
    said: dict[str, set[str]] = defaultdict(set)
    for path in sorted((CHECKOUT / "gaitdisc").rglob("*.py")):
        place = path.relative_to(CHECKOUT).as_posix()
        room = owner[max((pattern for pattern in owner if fnmatchcase(place, pattern)), key=len)]
        said[room] |= set(_templates(ast.parse(path.read_text(encoding="utf-8"))))
    said.pop("chapters", None)  # they leave for studies/
    return {f"refusals/{room}.txt": "\n".join(sorted(lines)) + "\n" for room, lines in said.items() if lines}


def _templates(module: ast.Module) -> Iterator[str]:
    functions = (node for node in ast.walk(module) if isinstance(node, ast.FunctionDef))  # outer ones first
    inside = {node: function for function in functions for node in ast.walk(function)}
    for node in ast.walk(module):
        name = getattr(node.func, "attr", getattr(node.func, "id", "")) if isinstance(node, ast.Call) else ""
        if isinstance(node, ast.Call) and (name.endswith("Error") or name == "Finding") and len(node.args) >= 2:
            assigned = _assigned(inside.get(node, module))
            named = (_template(one.value, assigned) for one in node.keywords)
            words = [*(_template(one, assigned) for one in node.args), *(one for one in named if " " in one)]
            if any(" " in one for one in words):
                yield f"{name}: {' / '.join(words)}"


def _assigned(scope: ast.AST) -> dict[str, list[str]]:
    """Words that a function puts into its names, in the order of its lines."""
    words: dict[str, list[str]] = defaultdict(list)
    for node in ast.walk(scope):
        if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name) and words[node.target.id]:
            words[node.target.id][-1] += _template(node.value, {})
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            text = _template(node.value, {})
            words[node.targets[0].id] += [text] if " " in text else []
    return {name: texts for name, texts in words.items() if texts}


def _template(node: ast.expr, assigned: dict[str, list[str]]) -> str:
    """Words of an argument, `{}` where a value stands."""
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(_template(one, assigned) for one in node.values)
    if isinstance(node, ast.FormattedValue):
        return _template(node.value, assigned)
    if isinstance(node, ast.IfExp):
        return f"{_template(node.body, assigned)} (or: {_template(node.orelse, assigned)})"
    if isinstance(node, ast.Name) and node.id in assigned:
        return " (or: ".join(assigned[node.id]) + ")" * (len(assigned[node.id]) - 1)
    return "{}"


def make_texts() -> dict[str, str]:
    """Every text, by its place in tests/approved."""
    pages = {name: text for kind in sorted(SAVED.iterdir()) for name, text in draw_pages(kind.name).items()}
    return {**pages, **list_help(), **list_templates()}


def difference(approved: str, made: str) -> str:
    """Lines that differ, as `diff -u` has them; a number may differ by one in its last printed digit."""
    old, new = approved.splitlines(), made.splitlines()
    if len(old) == len(new) and all(map(_same, old, new)):
        return ""
    return "\n".join(difflib.unified_diff(old, new, "approved", "made", lineterm="", n=0))


def _same(one: str, other: str) -> bool:
    pairs = list(zip(NUMBER.findall(one), NUMBER.findall(other), strict=False))
    digits = [10.0 ** -len(number.partition(".")[2]) for number, _ in pairs]
    near = all(abs(float(a) - float(b)) < 1.01 * digit for (a, b), digit in zip(pairs, digits, strict=True))
    return one == other or (near and NUMBER.sub("0", one) == NUMBER.sub("0", other))


def read_approved() -> dict[str, str]:
    """Approved texts, by their place."""
    files = sorted(APPROVED.rglob("*.txt"))
    return {file.relative_to(APPROVED).as_posix(): file.read_text(encoding="utf-8") for file in files}


if __name__ == "__main__":
    made, approved = make_texts(), read_approved()
    for name in sorted(made.keys() | approved.keys()):
        changed = difference(approved.get(name, ""), made.get(name, ""))
        print(*([f"== {name}", changed] if changed else []), sep="\n", end="\n" if changed else "")
        if changed and "--yes" in sys.argv:
            (APPROVED / name).parent.mkdir(parents=True, exist_ok=True)
            (APPROVED / name).write_text(made.get(name, ""), encoding="utf-8")
            if name not in made:
                (APPROVED / name).unlink()
