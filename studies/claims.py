"""Tables of docs/results.md, docs/chapter3.md and items.md: claims whose numbers are taken from studies/results.

    python studies/claims.py SUBJECT

`claims.toml` beside this file holds the rows of each subject. `at` names the pages and headings of a row. In its other
columns `{ROW @ COLUMN}` stands for the cell of a table there (several cells name one row: `SINDy & estimated`), and
`"words"` for words that stand there; a number without either, or not on the pages, is an error. .5 is printed as 0.5.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from command_line import argument, command_line

GIVEN = command_line(__name__, __doc__, argument("subject", "a subject of claims.toml"))

from markdown_table import markdown_table

CLAIMS, RESULTS = Path(__file__).with_name("claims.toml"), Path(__file__).with_name("results")
TAKEN = re.compile(r"\{([^{}@]+) @ ([^{}]+)\}|\"([^\"]+)\"")
NUMBER = re.compile(r"\d+(?:[.,]\d+)*|(?<!\w)\.\d+")
BARE_POINT, RANGE = re.compile(r"(?<![\w.])\.(?=\d)"), re.compile(r"(?<=\d)-(?=[\d.])")


def read_section(place: str) -> str:
    """The text below a heading that begins with the words behind the page's name."""
    page, _, heading = place.partition(": ")
    parts = re.split(r"^(?=#+ )", (RESULTS / page).read_text(encoding="utf-8"), flags=re.MULTILINE)
    [section] = [part for part in parts if part.lstrip("# ").startswith(heading)]
    return section.replace("**", "")


def find_cell(text: str, row: str, column: str) -> str:
    """The one cell of the tables in a text with this row and column."""
    head, found = [], set()
    for line in text.splitlines():
        cells = [part.strip() for part in line.strip("|").split("|")] if line.startswith("|") else []
        head = head if head and cells else cells
        if cells and column in head and set(row.split(" & ")) <= set(cells):
            found.add(cells[head.index(column)])
    if len(found) != 1:
        raise ValueError(f"{row} @ {column}: {len(found)} cells in place of one: {sorted(found)}")
    return found.pop()


def fill(words: str, text: str, free: bool) -> str:
    """The words of one column with their numbers; `free` ones may have numbers that stand anywhere in the text."""

    def take(taken: re.Match[str]) -> str:
        if taken[3] is None:
            return find_cell(text, taken[1], taken[2])
        if taken[3] not in " ".join(text.split()):
            raise ValueError(f"{taken[3]!r} stands on no page of its row")
        return taken[3]

    loose = set(NUMBER.findall(TAKEN.sub("", words))) - (set(NUMBER.findall(text)) if free else set())
    if loose:
        raise ValueError(f"{words!r}: numbers without a source: {sorted(loose)}")
    return RANGE.sub(" to ", BARE_POINT.sub("0.", TAKEN.sub(take, words))).replace(" +- ", " ± ")


def write_table(subject: str) -> str:
    """The table of a subject. The page of the numbers stands in the last column, or below if all rows have the same."""
    rows, claims = [], tomllib.loads(CLAIMS.read_text(encoding="utf-8"))[subject]
    columns = [name for name in claims[0] if name != "at"]
    for claim in claims:
        text = "\n".join(read_section(place) for place in claim["at"])
        files = ", ".join(dict.fromkeys(place.partition(".md: ")[0] for place in claim["at"]))
        kept = {"item": claim.get("item"), "command": f"`{claim.get('command')}`"}
        words = [kept[name] if name in kept else fill(claim[name], text, name == columns[0]) for name in columns]
        rows.append([*words, files])
    if len({row[-1] for row in rows}) > 1:
        return markdown_table(" | ".join([*columns, "page"]), rows)
    return markdown_table(" | ".join(columns), [row[:-1] for row in rows]) + f"\n\nTables: `{rows[0][-1]}.md`."


if __name__ == "__main__":
    print(write_table(GIVEN.subject))
