"""Words of a person's page and the index in another language: sign words, headings, what stands out; from a table."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from gaitdisc.errors import SchemaError
from gaitdisc.report.clinic.panel import Panel
from gaitdisc.report.cycles_tables import VALUES
from gaitdisc.report.table import Table
from gaitdisc.results.clinical_variables import VARIABLES
from gaitdisc.whole_file import write_whole

TEMPLATES = ("person.html.j2", "people.html.j2")
TABLES = (  # headings and cells of tables, and the words between numbers in a sentence of what stands out
    "value", "left", "right", "reference", "asymmetry", "value of", "side", "limits", "people", "cycles", "stands out",
    "curve", "file", "what", "version", "cycle", "to", "state", "person", "condition", "cycles L, R",
    "profile score [deg]", "why", "green", "amber", "red", "not said", "gait profile score", "Time and distance",
    "None of {} values lies beyond the limits of the reference.", "Nothing is said to stand out: {}.",
)  # fmt: skip
HEADER = ("English", "other")
LARGEST_BYTES = 2**20


@dataclass(frozen=True)
class PageWords:
    """Words of a page, each in the other language where the table has it.

    >>> say = PageWords({"knee flexion": "Knieflexion", "step length": "Schrittlänge"})
    >>> say("knee flexion"), say("step length [m]"), say("cadence")
    ('Knieflexion', 'Schrittlänge [m]', 'cadence')
    """

    other: Mapping[str, str] = field(default_factory=dict)

    def __call__(self, text: str) -> str:
        """Word in the other language, English where the table lacks it; a unit in brackets stays."""
        word, bracket, unit = text.partition(" [")
        return self.other.get(text) or self.other.get(word, word) + bracket + unit

    def panel(self, panel: Panel) -> Panel:
        """Panel with its title and sign words."""
        return replace(panel, title=self(panel.title), up=self(panel.up), down=self(panel.down))

    def table(self, table: Table) -> Table:
        """Table with its headings and words; its numbers and its CSV stay."""
        rows = tuple(tuple(map(self, row)) for row in table.rows)
        return replace(table, columns=tuple(map(self, table.columns)), rows=rows)


ENGLISH = PageWords()


def english_words(of_rules: Sequence[str]) -> list[str]:
    """Every word that a table may translate, each once: of the pages, and what rules call a value."""
    folder = Path(__file__).parents[1] / "templates"
    texts = [(folder / name).read_text(encoding="utf-8") for name in TEMPLATES]
    found = [word for text in texts for word in re.findall(r'say\("([^"]+)"\)', text)]
    found += [word for one in VARIABLES for word in (one.words, one.up, one.down)]
    found += [words for words, _, _ in VALUES.values()]
    return [word for word in dict.fromkeys((*found, *of_rules, *TABLES)) if word]


def write_words(path: Path, english: Sequence[str], words: PageWords = ENGLISH) -> Path:
    """Write the table that is to be filled in: English, and an empty column beside."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([HEADER, *((word, words.other.get(word, "")) for word in english)])
    return write_whole(path, text.getvalue())


def read_words(path: Path, english: Sequence[str]) -> PageWords:
    """Read a table of words; what is no word of the pages is refused with its line."""
    form = "words of a language are a CSV with the columns English and other"
    try:
        text = path.read_bytes()[: LARGEST_BYTES + 1].decode("utf-8-sig")
        rows = list(csv.reader(io.StringIO(text), delimiter=";" if text.partition("\n")[0].count(";") else ","))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SchemaError(form, f"{path.name}: {error}", "Save it as CSV in UTF-8.") from error
    if not rows or len(text) > LARGEST_BYTES or [cell.strip() for cell in rows[0][:2]] != list(HEADER):
        first = ", ".join(rows[0][:4]) if rows else "nothing"
        raise SchemaError(
            form, f"{path.name} begins with {first}", "gaitdisc report CLINIC --language NEW.csv writes one."
        )
    known, other = set(english), {}
    for number, row in enumerate(rows[1:], 2):
        word, said = (*(cell.strip() for cell in row[:2]), "", "")[:2]
        if word and word not in known:
            raise SchemaError(
                "each word is one of the pages",
                f"{path.name}, line {number}: {word[:60]!r} is none",
                "Delete the line.",
            )
        if said and word.count("{}") != said.count("{}"):
            raise SchemaError(
                "a sentence keeps its place for a number, {}",
                f"{path.name}, line {number}: {said[:60]!r}",
                f"Write {{}} as often as in {word!r}.",
            )
        other |= {word: said} if said else {}
    return PageWords(other)
