"""What a laboratory says of its pages and people: `clinic.toml`, and its language as a table of words."""

from __future__ import annotations

import base64
import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitdisc.channel import schema_folder
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import BY_NAME, VARIABLES
from gaitdisc.processing.tables import VALUES
from gaitdisc.report.table import Table
from gaitdisc.toml_text import parse_toml
from gaitdisc.whole_file import write_whole

if TYPE_CHECKING:
    from gaitdisc.clinic.panels import Panel

FILE, TABLE = "clinic.toml", "clinical_axes.csv"
LARGEST_LOGO = 2**19  # [bytes] a page stays one file that can be mailed
LONGEST = 1000  # letters of a comment
PICTURES = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}  # by their first bytes
FORM = (
    f"{FILE} has laboratory, logo, pdf, a table [axes] and tables [people.P07] with affected and comment, and nothing "
    f"else"
)
KINDS: dict[str, type] = {"laboratory": str, "logo": str, "pdf": bool, "axes": dict, "people": dict}
AFFECTED = ("left", "right", "both")
Axes = Mapping[str, tuple[float, float]]


@cache
def clinical_axes() -> Axes:
    """Ends of the axis of every curve, the same on all pages: `data_schema/clinical_axes.csv`.

    >>> clinical_axes()["knee_flexion"]
    (-15.0, 75.0)
    """
    with (schema_folder() / TABLE).open(encoding="utf-8", newline="") as file:
        return {row["variable"]: (float(row["low"]), float(row["high"])) for row in csv.DictReader(file)}


@dataclass(frozen=True)
class Laboratory:
    """Name and logo of a laboratory, its axes, and what it says of its people."""

    name: str = ""
    logo: str = ""  # as a data: address
    pdf: bool = False  # whether a run writes PDF too
    axes: Axes = field(default_factory=clinical_axes)
    affected: Mapping[str, str] = field(default_factory=dict)  # pseudonym -> side
    comments: Mapping[str, str] = field(default_factory=dict)  # pseudonym -> what the laboratory says


def load_laboratory(run_folder: Path) -> Laboratory:
    """Laboratory of a run: its `clinic.toml`, or the one beside the study file above; the package's own without one."""
    path = next((one for one in (run_folder / FILE, run_folder.parent / FILE) if one.is_file()), None)
    if path is None:
        return Laboratory()
    try:
        data = parse_toml(path.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        raise SchemaError(f"{FILE} must be a TOML file", f"it says: {str(error)[:200]}", "Correct the line.") from error
    for key, value in data.items():
        if key not in KINDS or not isinstance(value, KINDS[key]):
            raise _refusal(f"{key} = {str(value)[:60]!r}")
    people = data.get("people", {})
    for person, own in people.items():
        comment = own.get("comment", "") if isinstance(own, dict) and own.keys() <= {"affected", "comment"} else None
        if not isinstance(comment, str) or len(comment) > LONGEST or own.get("affected", "left") not in AFFECTED:
            raise _refusal(f"[people.{person}] {str(own)[:80]}")
    said: dict[str, dict[str, str]] = {
        word: {who: own[word] for who, own in people.items() if word in own} for word in ("affected", "comment")
    }
    axes = {**clinical_axes(), **{name: _ends(name, ends) for name, ends in data.get("axes", {}).items()}}
    logo = _picture(path.parent / data["logo"]) if data.get("logo") else ""
    name = str(data.get("laboratory", ""))
    return Laboratory(name, logo, bool(data.get("pdf", False)), axes, said["affected"], said["comment"])


def _ends(name: str, ends: Any) -> tuple[float, float]:
    numbers = isinstance(ends, list) and len(ends) == 2 and all(isinstance(end, int | float) for end in ends)
    if name not in BY_NAME or not numbers or not ends[0] < ends[1]:
        raise SchemaError(
            f"an axis must be a curve with its two ends, the lower first: one of {', '.join(BY_NAME)}",
            f"{FILE}, [axes]: {name} = {str(ends)[:60]}",
            "Write, for example, knee_flexion = [-15, 75].",
        )
    return float(ends[0]), float(ends[1])


def _picture(path: Path) -> str:
    content = path.read_bytes()[: LARGEST_LOGO + 1] if path.is_file() else b""
    kind = next((kind for start, kind in PICTURES.items() if content.startswith(start)), None)
    if kind is None or len(content) > LARGEST_LOGO:
        raise SchemaError(
            f"a logo must be a PNG or JPEG file in the folder of {FILE}, of at most {LARGEST_LOGO // 1024} KiB",
            f"{path.name} is missing, larger, or of another format",
            "Save it again.",
        )
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _refusal(found: str) -> SchemaError:
    return SchemaError(FORM, f"found {found}", f"Correct it; affected is one of {', '.join(AFFECTED)}.")


TIERS = {
    2: "Beyond what one more healthy person shows (95 % limits of this page)",
    1: "Outside 2 standard deviations of the controls, within those limits",
}
TEMPLATES = Path(__file__).parents[1] / "report" / "templates"
WITH_WORDS = ("person.html.j2", "people.html.j2", "person.typ")
TABLES = (  # headings and cells of tables, and the words between numbers in a sentence of what stands out
    "value", "left", "right", "reference", "asymmetry", "value of", "side", "limits", "people", "cycles", "stands out",
    "curve", "file", "what", "version", "cycle", "to", "state", "person", "condition", "cycles L, R", "Side affected",
    "both", "profile score [deg]", "why",
    "green", "amber", "red", "gait profile score", "Time and distance",
    "None of {} values lies outside 2 standard deviations of the reference.", "No comparison with controls: {}.",
    "A sentence needs {} cycles of a leg; there are {}.",
    "With {} controls the 95 % limits are wide: smaller differences may be there.",
    *TIERS.values(),
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


def english_words(of_rules: Sequence[str]) -> list[str]:
    """Every word that a table may translate, each once: of the pages, and what rules call a value."""
    texts = [(TEMPLATES / name).read_text(encoding="utf-8") for name in WITH_WORDS]
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
    for line, row in enumerate(rows[1:], 2):
        word, said = (*(cell.strip() for cell in row[:2]), "", "")[:2]
        if word and word not in known:
            raise SchemaError(
                "each text must be one of the pages' texts",
                f"{path.name}, line {line}: {word[:60]!r} is not",
                "Delete the line.",
            )
        if said and word.count("{}") != said.count("{}"):
            raise SchemaError(
                "a sentence must keep its place for a number, {}",
                f"{path.name}, line {line}: {said[:60]!r}",
                f"Write {{}} as often as in {word!r}.",
            )
        other |= {word: said} if said else {}
    return PageWords(other)
