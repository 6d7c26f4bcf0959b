"""Blocks of a page that a command prints: found, written, and compared number by number."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable
from dataclasses import dataclass

BLOCK = re.compile(r"(<!-- printed by: (.+?) \| (.+?) -->\n)(.*?)(\n<!-- end -->)", re.DOTALL)
NUMBER = re.compile(r"(?<![\w.])[-−+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?|(?<![\w.])\.\d+")
PLACEHOLDER, WIDTH, SLOW = "#", 150, ", slow"  # of a form: more than half a minute
CODE = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
TABLE = re.compile(r"^(.*)\n(\|.*)\n\|[-: |]+$", re.MULTILINE)  # the line above, and the heads
MEASURED = re.compile(r"<!-- measured by: (?!no command)(.+?) \| [0-9a-f]{8}, .+ -->")


@dataclass(frozen=True)
class Block:
    """One block of a page."""

    commands: tuple[str, ...]
    form: str
    written: str


def blocks(text: str) -> list[Block]:
    """Blocks of a page, in its order."""
    return [Block(tuple(found[2].split("; ")), found[3], found[4]) for found in BLOCK.finditer(text)]


def renewed(text: str, wanted: Callable[[Block], str | None]) -> str:
    """The page with every block as `wanted` has it, or as it was where that is None."""

    def one(found: re.Match[str]) -> str:
        block = Block(tuple(found[2].split("; ")), found[3], found[4])
        new = wanted(block)
        return found[1] + (block.written if new is None else new) + found[5]

    return BLOCK.sub(one, text)


def commands_of_tables(text: str) -> dict[str, str]:
    """Heads of the tables that stand in no block, and by which command each was measured; empty without one."""
    found = TABLE.finditer(CODE.sub("", BLOCK.sub("", f"\n{text}\n")))
    return {one[2]: mark[1] if (mark := MEASURED.fullmatch(one[1])) else "" for one in found}


def quoted(printed: str) -> str:
    """The first line as a quotation."""
    return textwrap.fill(printed.strip().splitlines()[0], WIDTH, initial_indent="> ", subsequent_indent="> ")


def first_two(printed: str) -> str:
    """The first two sentences of the first line, as a quotation."""
    sentences = re.split(r"(?<=\.) (?=[A-Z])", printed.strip().splitlines()[0])
    return quoted(" ".join(sentences[:2]) + (" …" if len(sentences) > 2 else ""))


def scores(printed: str) -> str:
    """The table of R² by participant, fenced."""
    lines = printed.splitlines()
    first = next((n for n, line in enumerate(lines) if line.lstrip().startswith("network")), 0)
    last = next((n for n in range(first, len(lines)) if not lines[n].strip()), len(lines))
    return fenced("\n".join(line.rstrip() for line in lines[first:last] if line.strip("─ ")))


def fenced(printed: str) -> str:
    """Everything, as code."""
    return f"```\n{printed.rstrip()}\n```"


FORMS: dict[str, Callable[[str], str]] = {
    "sentence": quoted,
    "two sentences": first_two,
    "two sentences, measured": first_two,
    "scores": scores,
    "code": fenced,
    "markdown": lambda printed: printed.strip("\n"),
    "measured": fenced,
}


def difference(block: Block, printed: str) -> str:
    """What a block has otherwise than it is printed; empty where words and numbers agree."""
    return apart(block.written, printed, numbers="measured" not in block.form)


def apart(written: str, printed: str, numbers: bool = True) -> str:
    """The first line that differs in words, or in a number by more than one unit of its last digit; empty if none."""
    old, new = (text.replace("\n> ", " ").split("\n") for text in (written, printed))  # a quotation is one line
    for one, other in zip(old, new, strict=False):
        if " ".join(NUMBER.sub(PLACEHOLDER, one).split()) != " ".join(NUMBER.sub(PLACEHOLDER, other).split()):
            return f"{one!r} is printed as {other!r}"
        if not numbers:
            continue
        pairs = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
        far = [pair for pair in pairs if abs(value(pair[0]) - value(pair[1])) > 1.001 * last_digit(pair[0])]
        if far:
            return f"{far[0][0]} is printed as {far[0][1]} in {other!r}"
    return "" if len(old) == len(new) else f"{len(old)} lines are printed as {len(new)}"


def value(number: str) -> float:
    """A printed number."""
    return float(number.replace("−", "-").replace(",", ""))


def last_digit(number: str) -> float:
    """The unit of its last digit."""
    digits, _, power = number.partition("e")
    return 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
