"""Words of the pages, in another language where a laboratory has filled in a table of them."""

import csv
import io
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from gaitdisc.clinic.laboratory import Laboratory
from gaitdisc.clinic.rules import SCORE, SCORE_WORDS, rules
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import VARIABLES
from gaitdisc.processing.tables import VALUES
from gaitdisc.report.curve_panels import TEMPLATES, Panel
from gaitdisc.report.table import Table
from gaitdisc.whole_file import write_whole

TIERS = {
    2: "Outside the prediction limits for a healthy person (95 % over all values on this page)",
    1: "Outside 2 standard deviations of the controls, but within the prediction limits",
}
NEAREST = {
    "age": "those nearest in age",
    "speed": "those nearest in walking speed",
    "age and speed": "those nearest in age and walking speed",
}
WITH_WORDS = ("person.html.j2", "people.html.j2", "person.typ")
TABLES = (  # headings and cells of tables, and the words between numbers in a sentence of what stands out
    "value", "left", "right", "reference", "asymmetry", "value of", "side", "limits", "people", "cycles", "stands out",
    "curve", "file", "what", "version", "cycle", "to", "more than", "less than", "apart from",
    "neither leg stands out by itself",
    "state", "person", "condition", "session", "cycles L, R", "Side affected", "both", "profile score [deg]", "why",
    "green", "amber", "red", "gait profile score", "Time and distance",
    "None of {} values lies outside 2 standard deviations of the reference.", "No comparison with controls: {}.",
    "A leg must have {} cycles to be reported; there are {}.",
    "With few controls ({}) the 95 % limits are wide: differences may be missed.",
    *TIERS.values(), *NEAREST.values(),
)  # fmt: skip
HEADER = ("English", "other")
LARGEST_BYTES = 2**20


@dataclass(frozen=True)
class PageWords:
    """Words of a page, each in the other language where the table has it, and what its laboratory says.

    >>> say = PageWords({"knee flexion": "Knieflexion", "step length": "Schrittlänge"})
    >>> say("knee flexion"), say("step length [m]"), say("cadence")
    ('Knieflexion', 'Schrittlänge [m]', 'cadence')
    """

    other: Mapping[str, str] = field(default_factory=dict)
    laboratory: Laboratory = field(default_factory=Laboratory)

    def __call__(self, text: str) -> str:
        """Word in the other language, English where the table lacks it; a unit in brackets stays."""
        word, bracket, unit = text.partition(" [")
        return self.other.get(text) or self.other.get(word, word) + bracket + unit

    def panel(self, panel: Panel) -> Panel:
        """Panel with its title and sign words, on the axis of its curve."""
        axis = self.laboratory.axes.get(panel.name, panel.axis)
        return replace(panel, title=self(panel.title), up=self(panel.up), down=self(panel.down), axis=axis)

    def table(self, table: Table) -> Table:
        """Table with its headings and words; its numbers and its CSV stay."""
        rows = tuple(tuple(map(self, row)) for row in table.rows)
        return replace(table, columns=tuple(map(self, table.columns)), rows=rows)


ENGLISH = PageWords()


@cache
def english_words() -> list[str]:
    """Every word that a table may translate, each once: of the pages, and what rules call a value."""
    texts = [(TEMPLATES / name).read_text(encoding="utf-8") for name in WITH_WORDS]
    phrases = [word for text in texts for word in re.findall(r'say\("([^"]+)"\)', text)]
    phrases += [word for variable in VARIABLES for word in (variable.words, variable.up, variable.down)]
    phrases += [words for words, _, _ in VALUES.values()]
    phrases += [word for rule in rules() for word in (rule.name, rule.less, rule.more)]
    return [word for word in dict.fromkeys((*phrases, SCORE, SCORE_WORDS, *TABLES)) if word]


def write_words(path: Path, words: PageWords = ENGLISH) -> Path:
    """Write the table that is to be filled in: English, and an empty column beside."""
    text, rows = io.StringIO(), ((word, words.other.get(word, "")) for word in english_words())
    csv.writer(text, lineterminator="\n").writerows([HEADER, *rows])
    return write_whole(path, text.getvalue())


def read_words(path: Path) -> PageWords:
    """Read a table of words; what is no word of the pages is refused with its line."""
    form = "a table of translated words must be a CSV file with the columns English and other"
    try:
        text = path.read_bytes()[: LARGEST_BYTES + 1].decode("utf-8-sig")
        rows = list(csv.reader(io.StringIO(text), delimiter=";" if text.partition("\n")[0].count(";") else ","))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SchemaError(form, f"{path.name}: {error}", "Save it as CSV in UTF-8.") from error
    if not rows or len(text) > LARGEST_BYTES or [cell.strip() for cell in rows[0][:2]] != list(HEADER):
        first = ", ".join(rows[0][:4]) if rows else "nothing"
        raise SchemaError(
            form, f"{path.name} begins with {first}", "Write a new table: gaitdisc report CLINIC --language NEW.csv."
        )
    known, other = set(english_words()), {}
    for line, row in enumerate(rows[1:], 2):
        word, translation = (*(cell.strip() for cell in row[:2]), "", "")[:2]
        if word and word not in known:
            raise SchemaError(
                "each English text of the table must occur on the pages",
                f"{path.name}, line {line}: {word[:60]!r} does not",
                "Delete the line.",
            )
        if translation and word.count("{}") != translation.count("{}"):
            raise SchemaError(
                "a translation must contain {}, the place of a number, as often as the English text",
                f"{path.name}, line {line}: {translation[:60]!r}",
                f"Write {{}} as often as in {word!r}.",
            )
        other |= {word: translation} if translation else {}
    return PageWords(other)
