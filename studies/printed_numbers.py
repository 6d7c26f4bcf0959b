"""Numbers in README and docs that a command prints: run the commands, and write or compare what stands between marks.

    python studies/printed_numbers.py [PAGES ...] [--only WORD] [--check] [--draw 10 [--seed 7]]

A block is opened by `<!-- printed by: COMMAND; COMMAND | FORM -->` and closed by `<!-- end -->`. The commands run in an
empty folder, each once for all pages, and what the last one prints is brought into its FORM. DATA stands for the
folder of real recordings; what needs it is skipped where it is absent. --check writes nothing and ends with 1 where
words differ, a number by more than one unit of its last printed digit, or a table of results has no command. Numbers of
a form with `measured` (seconds, and what follows a chaotic path) are those of one machine, and only their words are
compared. A table measured once has `<!-- measured by: COMMAND | COMMITS, DATE -->` above. --draw takes quick commands.
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
    argument("--draw", "only so many commands, none of them slow, drawn by --seed", 0),
    argument("--seed", "of the draw (default: a new one)", default=None, type=int),
)  # before the slow imports

import os
import random
import shlex
import subprocess
import sys
import tempfile
import time

from printed_blocks import FORMS, SLOW, Block, blocks, commands_of_tables, difference, renewed

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
            begun = time.perf_counter()
            environment = {**os.environ, "PYTHONPATH": str(PROJECT), "COLUMNS": "200"}
            answer = subprocess.run(
                [*program, *rest], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=True
            )
            print(f"{time.perf_counter() - begun:7.1f} s  {command}", file=sys.stderr, flush=True)
            done[command] = answer.stdout
    return done[commands[-1]]


def answer(block: Block, folder: Path, done: dict[str, str]) -> str | None:
    """What the block should hold; None where recordings are absent."""
    if any("DATA" in command for command in block.commands) and not SHARED.is_dir():
        print(f"  skipped, {SHARED} is absent: {block.commands[-1]}", file=sys.stderr)
        return None
    return FORMS[block.form.removesuffix(SLOW)](run(block.commands, folder, done))


def gone_through(page: Path, chosen: set[str], folder: Path, done: dict[str, str]) -> int:
    """Run the chosen commands of one page, say what differs, write it unless it is only compared; how many differ."""
    text = page.read_text(encoding="utf-8")
    new = renewed(text, lambda block: answer(block, folder, done) if block.commands[-1] in chosen else None)
    pairs = zip(blocks(text), blocks(new), strict=True)
    different = [found for old, renewed_one in pairs if (found := difference(old, renewed_one.written))]
    different += [f"no command above the table {heads}" for heads in without_command(page)]
    for found in different:
        print(f"{page.name}: {found}")
    if not GIVEN.check:
        page.write_text(new, encoding="utf-8")
    return len(different)


def without_command(page: Path) -> list[str]:
    """Heads of the tables that no command stands above, on a page of measured results."""
    tables = {} if page.stem == "README" else commands_of_tables(page.read_text(encoding="utf-8"))
    return [heads for heads, command in tables.items() if not command and page.parent.name == "results"]


def main() -> int:
    """Go through the pages."""
    every, done = GIVEN.pages or pages(), {}
    found = [block for page in every for block in blocks(page.read_text(encoding="utf-8"))]
    quick = [block for block in found if not (GIVEN.draw and block.form.endswith(SLOW))]
    chosen = sorted({block.commands[-1] for block in quick if GIVEN.only in block.commands[-1]})
    if GIVEN.draw:
        seed = random.randrange(10**6) if GIVEN.seed is None else GIVEN.seed
        chosen = random.Random(seed).sample(chosen, min(GIVEN.draw, len(chosen)))
        print(f"{len(chosen)} commands drawn by seed {seed}")
    with tempfile.TemporaryDirectory() as name:
        wrong = sum(gone_through(page, set(chosen), Path(name), done) for page in every)
    once = [command for page in every for command in commands_of_tables(page.read_text(encoding="utf-8")).values()]
    print(
        f"{len(found)} blocks, {len(chosen)} commands run; {len(once) - once.count('')} tables measured once; "
        f"{wrong} differ"
    )
    return int(GIVEN.check and wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
