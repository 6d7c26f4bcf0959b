"""Numbers in README and docs that a command prints: run the commands, and write or compare what stands between marks.

    python studies/printed_numbers.py [PAGES ...] [--only WORD] [--check]

A block is opened by `<!-- printed by: COMMAND; COMMAND | FORM -->` and closed by `<!-- end -->`. The commands run in an
empty folder, each once for all pages, and what the last one prints is brought into its FORM. DATA stands for the
folder of real recordings; what needs it is skipped where it is absent. --check writes nothing and ends with 1 where
words differ, or a number by more than one unit of its last printed digit. Numbers of a form with `measured` (seconds,
and what follows a chaotic path) are those of one machine, and only their words are compared.
"""

from __future__ import annotations

from pathlib import Path

from command_line import SHARED, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("pages", "Markdown files (default: README.md, docs, studies/results)", nargs="*", type=Path),
    argument("--only", "only blocks whose command holds this word", ""),
    argument("--check", "compare, and write nothing", False),
)  # before the slow imports

import os
import shlex
import subprocess
import sys
import tempfile

from printed_blocks import FORMS, Block, blocks, difference, renewed

PROJECT = Path(__file__).parents[1]


def pages() -> list[Path]:
    """README, the pages of docs, and the results behind them."""
    return [PROJECT / "README.md", *sorted(PROJECT.glob("docs/*.md")), *sorted(PROJECT.glob("studies/results/*.md"))]


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
