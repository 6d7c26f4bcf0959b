"""Numbers in README and docs that a command prints: run the commands, and write or compare what stands between marks.

    python studies/printed_numbers.py [PAGES ...] [--only WORD] [--check]

A block is opened by `<!-- printed by: COMMAND; COMMAND | FORM -->` and closed by `<!-- end -->`. The commands run in an
empty folder, each once for all pages, and what the last one prints is brought into its FORM. DATA stands for the
folder of real recordings; what needs it is skipped where it is absent. --check writes nothing and ends with 1 where
words differ, or a number by more than one unit of its last printed digit. Numbers of the form `measured` (seconds, and
what follows a chaotic path) are those of one machine, and only their words are compared.
"""

from __future__ import annotations

from pathlib import Path

from command_line import SHARED, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("pages", "Markdown files (default: README.md and all of docs)", nargs="*", type=Path),
    argument("--only", "only blocks whose command holds this word", ""),
    argument("--check", "compare, and write nothing", False),
)  # before the slow imports

import os
import re
import shlex
import subprocess
import sys
import tempfile
import textwrap
from collections.abc import Callable
from dataclasses import dataclass

PROJECT = Path(__file__).parents[1]
BLOCK = re.compile(r"(<!-- printed by: (.+?) \| (.+?) -->\n)(.*?)(\n<!-- end -->)", re.DOTALL)
NUMBER = re.compile(r"(?<![\w.])[-−+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?|(?<![\w.])\.\d+")
PLACEHOLDER, WIDTH = "#", 150


@dataclass(frozen=True)
class Block:
    """One block of a page."""

    commands: tuple[str, ...]
    form: str
    written: str


def pages() -> list[Path]:
    """README and the pages of docs."""
    return [PROJECT / "README.md", *sorted((PROJECT / "docs").glob("*.md"))]


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


def as_printed(printed: str) -> str:
    """Markdown as the command prints it."""
    return printed.strip("\n")


FORMS: dict[str, Callable[[str], str]] = {
    "sentence": quoted,
    "two sentences": first_two,
    "scores": scores,
    "code": fenced,
    "markdown": as_printed,
    "measured": fenced,
}


def run(commands: tuple[str, ...], folder: Path, done: dict[str, str]) -> str:
    """What the last command prints; those that ran before in this folder are not run again."""
    for command in commands:
        if command not in done:
            words = [word.replace("DATA", str(SHARED)) for word in shlex.split(command)]
            program = [sys.executable, "-m", "gaitdisc"] if words[0] == "gaitdisc" else [sys.executable]
            rest = [str(PROJECT / word) if (PROJECT / word).is_file() else word for word in words[1:]]
            print(f"  {command}", file=sys.stderr, flush=True)
            environment = {**os.environ, "PYTHONPATH": str(PROJECT), "COLUMNS": "200"}
            answer = subprocess.run(
                [*program, *rest], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=True
            )
            done[command] = answer.stdout
    return done[commands[-1]]


def difference(block: Block, printed: str) -> str:
    """What a block has otherwise than it is printed; empty where words and numbers agree."""
    return apart(block.written, printed, numbers=block.form != "measured")


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


def answer(block: Block, folder: Path, done: dict[str, str]) -> str | None:
    """What the block should hold; None where recordings are absent."""
    if any("DATA" in command for command in block.commands) and not SHARED.is_dir():
        print(f"  skipped, {SHARED} is absent: {block.commands[-1]}", file=sys.stderr)
        return None
    return FORMS[block.form](run(block.commands, folder, done))


def gone_through(page: Path, folder: Path, done: dict[str, str]) -> int:
    """Run the commands of one page, say what differs, write it unless it is only compared; how many blocks differ."""

    def wanted(block: Block) -> str | None:
        chosen = any(GIVEN.only in command for command in block.commands)
        return answer(block, folder, done) if chosen else None

    text = page.read_text(encoding="utf-8")
    new = renewed(text, wanted)
    pairs = zip(blocks(text), blocks(new), strict=True)
    different = [found for old, renewed_one in pairs if (found := difference(old, renewed_one.written))]
    for found in different:
        print(f"{page.name}: {found}")
    if not GIVEN.check:
        page.write_text(new, encoding="utf-8")
    return len(different)


def main() -> int:
    """Go through the pages."""
    done: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as name:
        wrong = sum(gone_through(page, Path(name), done) for page in GIVEN.pages or pages())
    return int(GIVEN.check and wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
