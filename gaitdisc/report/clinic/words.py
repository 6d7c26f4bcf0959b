"""Words of the pages: what stands out, how good it is, and every word in another language, from a table."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from gaitdisc.errors import SchemaError
from gaitdisc.report.clinic.panels import Panel
from gaitdisc.report.cycles_tables import VALUES
from gaitdisc.report.table import Table
from gaitdisc.results.clinical_reference import ClinicalReading, Contrast, DifferingSpan, Noted, Score
from gaitdisc.results.leg_curves import BY_NAME, FEET, VARIABLES
from gaitdisc.whole_file import write_whole
from gaitdisc.words import SIDE_WORDS, counted, number, p_words, unit_text

TEMPLATES = ("person.html.j2", "people.html.j2")
TABLES = (  # headings and cells of tables, and the words between numbers in a sentence of what stands out
    "value", "left", "right", "reference", "asymmetry", "value of", "side", "limits", "people", "cycles", "stands out",
    "curve", "file", "what", "version", "cycle", "to", "state", "person", "condition", "cycles L, R",
    "profile score [deg]", "why", "green", "amber", "red", "not said", "gait profile score", "Time and distance",
    "None of {} values lies beyond the limits of the reference.", "Nothing is said to stand out: {}.",
)  # fmt: skip
HEADER = ("English", "other")
LARGEST_BYTES = 2**20
MOST = 6  # sentences of what stands out
MOST_SPANS = 6


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
    for line, row in enumerate(rows[1:], 2):
        word, said = (*(cell.strip() for cell in row[:2]), "", "")[:2]
        if word and word not in known:
            raise SchemaError(
                "each word is one of the pages",
                f"{path.name}, line {line}: {word[:60]!r} is none",
                "Delete the line.",
            )
        if said and word.count("{}") != said.count("{}"):
            raise SchemaError(
                "a sentence keeps its place for a number, {}",
                f"{path.name}, line {line}: {said[:60]!r}",
                f"Write {{}} as often as in {word!r}.",
            )
        other |= {word: said} if said else {}
    return PageWords(other)


def noted_sentences(noted: Sequence[Noted], say: Callable[[str], str] = str) -> list[str]:
    """One sentence a rule and direction, the farthest first, both legs in one; at most six."""
    together: dict[tuple[str, str], list[Noted]] = {}
    for one in noted:
        together.setdefault((one.rule, one.words), []).append(one)
    return [_noted(sorted(own, key=lambda one: one.side), say) for own in together.values()][:MOST]


def _noted(own: Sequence[Noted], say: Callable[[str], str]) -> str:
    first = own[0]
    unit, limits = unit_text(first.unit), first.limits
    low, high, mean = (number(value, first.digits) for value in (limits.low, limits.high, limits.mean))
    sd = number(limits.sd, max(first.digits, 1))
    each = ", ".join(
        f"{say(SIDE_WORDS[one.side])} {number(one.value, one.digits)} {unit} "
        f"({one.cycles} {say('cycle' if one.cycles == 1 else 'cycles')})"
        for one in own
    )
    words = say(first.words)
    return (
        f"{words[0].upper()}{words[1:]}: {each}; {say('limits')} {low} {say('to')} {high} {unit}, "
        f"{say('reference')} {mean} ± {sd} {unit}, {limits.people} {say('people')}."
    )


def outstanding_sentences(reading: ClinicalReading, say: Callable[[str], str] = str) -> list[str]:
    """What stands out, or why nothing does."""
    if reading.silent:
        return [say("Nothing is said to stand out: {}.").format(reading.silent)]
    found = noted_sentences(reading.noted, say)
    if found:
        return found
    people = max((band.people for band in reading.bands.values()), default=0)
    few = "" if people >= 20 else f" With {people} controls the limits are wide: smaller differences may be there."
    silent = say("None of {} values lies beyond the limits of the reference.").format(len(reading.numbers))
    return [f"{silent}{few}"]


def quality_sentence(reading: ClinicalReading) -> str:
    """What was recorded, and how good it is, in one line."""
    pooled = reading.pooled
    counts = " and ".join(f"{pooled.counted(side)} {SIDE_WORDS[side]}" for side in FEET)
    kinetic = int(pooled.kept["kinetic"].astype(bool).sum())
    plates = f", {kinetic} on a plate" if kinetic else ""
    out = f", {len(pooled.left_out)} left out" if len(pooled.left_out) else ""
    ground = "over ground" if pooled.over_ground else "on a treadmill"
    why = f": {'; '.join(reading.reasons)}" if reading.reasons else ""
    return f"{counts} cycles of {counted(pooled.trials, 'trial')} {ground}{plates}{out}. {reading.light}{why}."


def score_words(score: Score, unit: str = "deg") -> str:
    """Score with the range of single cycles and the reference's own.

    >>> score_words(Score(7.2, 6.5, 8.1, 4, 5.1, 1.0, 20))
    '7.2 deg (4 cycles 6.5 to 8.1; reference 5.1 ± 1.0, 20 people)'
    """
    parts = []
    if score.cycles > 1 and np.isfinite(score.low):
        parts.append(f"{score.cycles} cycles {number(score.low, 1)} to {number(score.high, 1)}")
    if np.isfinite(score.reference_mean):
        own = f"{number(score.reference_mean, 1)} ± {number(score.reference_sd, 1)}"
        parts.append(f"reference {own}, {score.people} people")
    return f"{number(score.value, 1)} {unit}" + (f" ({'; '.join(parts)})" if parts else "")


def score_sentences(reading: ClinicalReading) -> list[str]:
    """Gait profile score and gait deviation index, or why there is none."""
    found = []
    if reading.profile is None:
        found.append(f"No gait profile score: {reading.no_profile}.")
    else:
        each = [f"{SIDE_WORDS[side]} {score_words(score)}" for side, score in reading.profile.legs.items()]
        both = [f"both {score_words(reading.profile.both)}"] if reading.profile.both else []
        found.append(f"Gait profile score: {'; '.join([*both, *each])}.")
    if reading.deviation_index:
        each = [f"{SIDE_WORDS[side]} {number(value, 0)}" for side, value in reading.deviation_index.items()]
        found.append(f"Gait deviation index: {', '.join(each)} (controls 100 ± 10).")
    else:
        found.append(f"No gait deviation index: {reading.no_index}.")
    return found


def contrast_sentences(contrast: Contrast) -> list[str]:
    """Where two sets of cycles differ and by how much; the largest first, and what was not tested."""
    first, second = contrast.first.pooled.where, contrast.second.pooled.where
    found = []
    for side, why in contrast.untested.items():
        found.append(f"{SIDE_WORDS[side].capitalize()}: not tested. {why}")
    spans = sorted((one for one in contrast.spans if one.matters), key=lambda one: -abs(one.difference))
    found += [_span(one, contrast) for one in spans[:MOST_SPANS]]
    small = len(contrast.spans) - len(spans)
    if contrast.tested and not spans:
        sides = " and ".join(SIDE_WORDS[side] for side in contrast.tested)
        found.append(
            f"{sides.capitalize()}: no stretch differs by as much as matters (5 deg) between {first} and {second}."
        )
    if small:
        found.append(f"{counted(small, 'stretch').replace('stretchs', 'stretches')} differ by less than 5 deg.")
    return found


def _span(one: DifferingSpan, contrast: Contrast) -> str:
    variable = BY_NAME[one.variable]
    counts = [reading.legs[one.side].count for reading in (contrast.first, contrast.second)]
    more = "more" if one.difference > 0 else "less"
    amount = f"{number(abs(one.difference), 0)} {variable.unit} {more} ({variable.up})"
    return (
        f"{variable.words.capitalize()}, {SIDE_WORDS[one.side]}: {amount} in"
        f" {contrast.second.pooled.where} than in {contrast.first.pooled.where}, at {one.first} to "
        f"{one.last} % of the cycle; {p_words(one.p)}, {counts[0]} and {counts[1]} cycles."
    )
