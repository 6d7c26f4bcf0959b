"""All texts that a user reads, each with its kind and place, and a draw of them by seed.

    python benchmarks/reader_texts.py [--draw 60] [--seed 7]

The list says kind, place and text; a draw is for a reader with the style sheet. Kinds: refusal, finding, sentence
(verdicts, captions, progress), page (templates), help, docs, docstring (public). Values that the program fills in
stand in braces. The draw is over texts: a kind has the weight of its number.
"""

from __future__ import annotations

import ast
import inspect
import random
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

CHECKOUT = Path(__file__).parents[1]
sys.path.insert(0, str(CHECKOUT / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--draw", "number of texts to draw; 0 for all", 0),
    argument("--seed", "of the draw", 0),
)
sys.path.insert(0, str(CHECKOUT))  # the texts of this checkout, whatever is installed
FEWEST_WORDS = 4  # [words] that make a sentence or a caption; shorter texts are labels
# A list of words, such as the labels of a column, has neither: a text has one of these, or a mark before a blank.
OF_A_TEXT = re.compile(
    r"\b(a|an|the|of|to|in|on|at|by|for|with|without|from|as|than|per|and|or|no|not|is|are|that|which)\b|[.,;:)%](\s|$)"
)
LEAST_SHARE = 1 / 11  # of such words and marks; a longer list of words has fewer
FINDING = ("severity", "kind", "file", "what", "affects", "channel")  # its arguments in their order, as its line says
OWNERS = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


class Text(NamedTuple):
    """What a user reads, and where it stands."""

    kind: str
    place: str
    text: str


def list_code_texts(path: Path) -> Iterator[Text]:
    """Refusals, findings, help and other sentences of a file, without its docstrings; the help of a command with it."""
    tree, place = ast.parse(path.read_text(encoding="utf-8")), path.relative_to(CHECKOUT).as_posix()
    command = place.startswith("gaitdisc/commands/")
    docstrings = {id(node.body[0]) for node in ast.walk(tree) if isinstance(node, OWNERS) and node.body}

    def walk(node: ast.AST) -> Iterator[Text]:
        name = getattr(node.func, "attr", getattr(node.func, "id", "")) if isinstance(node, ast.Call) else ""
        if isinstance(node, ast.Call) and (name.endswith("Error") or name == "Finding"):
            parts = [*node.args, *(key.value for key in node.keywords)]
            marks = [f"{mark}: " if name == "Finding" and mark in ("kind", "affects") else "" for mark in FINDING]
            words = zip(parts, [*marks, *("" for _ in parts)], strict=False)
            if spoken := [f"{mark}{text}" for part, mark in words if " " in (text := write_template(part))]:
                kind, text = "finding" if name == "Finding" else "refusal", "; ".join(spoken)
                bare = re.sub(r"\{[^}]*\}|kind: [^;]*|note / warning|warning / note", "", text)
                if len(bare.split()) > (FEWEST_WORDS if kind == "finding" else 1):
                    yield Text(kind, f"{place}:{node.lineno}", text)
        elif isinstance(node, ast.Constant | ast.JoinedStr):
            text = write_template(node)
            spoken = " " in text.strip() and "</" not in text and not re.match(r"<[a-z]|[A-Z]\w+\(", text)
            if (
                spoken
                and LEAST_SHARE * len(text.split()) <= len(OF_A_TEXT.findall(text))
                and len(re.findall(r"[A-Za-z]{2,}", re.sub(r"\S*_\S*", "", re.sub(r"\{[^}]*\}", "", text))))
                >= FEWEST_WORDS
            ):
                yield Text("help" if command else "sentence", f"{place}:{node.lineno}", text)
        elif not (id(node) in docstrings and isinstance(node, ast.Expr)) and name not in (
            "compile",
            "add_argument",
            "split",
        ):
            for child in ast.iter_child_nodes(node):
                yield from walk(child)

    yield from walk(tree)
    for one in tree.body if command else ():
        if isinstance(one, ast.FunctionDef) and one.name == path.stem:
            yield from (Text("help", f"{place}:{one.lineno}", words) for words in split_text(ast.get_docstring(one)))


def write_template(node: ast.AST) -> str:
    """Words of a string as the code has them, values in braces; both branches of a choice."""
    if isinstance(node, ast.JoinedStr):
        values = [one.value if isinstance(one, ast.FormattedValue) else one for one in node.values]
        parts = (str(one.value) if isinstance(one, ast.Constant) else f"{{{ast.unparse(one)}}}" for one in values)
        return re.sub(r"\s+", " ", "".join(parts))
    if isinstance(node, ast.IfExp):
        return " / ".join(filter(None, map(write_template, (node.body, node.orelse))))
    return re.sub(r"\s+", " ", node.value) if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def split_text(text: str | None) -> list[str]:
    """Paragraphs of prose, list items and rows of tables; no headings, code or doctests."""
    text = re.sub(r"^```.*?^```|<!--.*?-->", "", text or "", flags=re.DOTALL | re.MULTILINE)
    parts = [re.sub(r"\s+", " ", one).strip() for one in re.split(r"\n\s*\n|\n(?=[-*|] )|\n(?=[\w, ]+ : )", text)]
    hidden = ("#", ">>>", "|--", "| --", ":::", "![", "{{", "Examples ---")
    counts = (len(re.sub(r"\{\{.*?\}\}", "", one).split()) for one in parts)
    return [
        one for one, count in zip(parts, counts, strict=True) if count >= FEWEST_WORDS and not one.startswith(hidden)
    ]


def list_texts() -> list[Text]:
    """Every text, by kind and place."""
    import gaitdisc

    texts = [text for path in sorted((CHECKOUT / "gaitdisc").rglob("*.py")) for text in list_code_texts(path)]
    for path in [*(CHECKOUT / "gaitdisc").rglob("*.j2"), CHECKOUT / "README.md", *(CHECKOUT / "docs").glob("*.md")]:
        words, kind = path.read_text(encoding="utf-8"), "page" if path.suffix == ".j2" else "docs"
        if kind == "page":
            words = re.sub(r"\{%.*?%\}|\{#.*?#\}|</?[a-z][^>]*>", "\n\n", words, flags=re.DOTALL)
        texts += [Text(kind, path.relative_to(CHECKOUT).as_posix(), one) for one in split_text(words)]
    for name in gaitdisc.__all__:
        owner = getattr(gaitdisc, name)
        own = vars(owner).items() if inspect.isclass(owner) else ()
        for place, one in {name: owner, **{f"{name}.{key}": value for key, value in own if key[0] != "_"}}.items():
            if inspect.isroutine(one) or inspect.isclass(one) or isinstance(one, property):
                texts += [Text("docstring", f"gaitdisc.{place}", words) for words in split_text(inspect.getdoc(one))]
    return sorted(set(texts))


if __name__ == "__main__":
    texts = list_texts()
    for number, one in enumerate(random.Random(GIVEN.seed).sample(texts, GIVEN.draw) if GIVEN.draw else texts, 1):
        print(f"{number}. [{one.kind}] {one.place}\n   {one.text}")
