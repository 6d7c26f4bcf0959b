"""Values and scores of a person beside the reference, as tables and bars, and their words in another language."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from html import escape
from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.errors import SchemaError
from gaitdisc.report.clinic.panels import Panel, ticks
from gaitdisc.report.cycles_tables import VALUES, mean_cell
from gaitdisc.report.panels import SIDES
from gaitdisc.report.table import Table, words_table
from gaitdisc.results.clinical_reference import ClinicalReading, Contrast, DifferingSpan, Noted, Profile, Score
from gaitdisc.results.leg_curves import BY_NAME, FEET, PROFILE, VARIABLES
from gaitdisc.whole_file import write_whole
from gaitdisc.words import NONE, SIDE_WORDS, counted, number, p_words, unit_text

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 240, 365, 104, 232, 6, 346
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


def values_table(reading: ClinicalReading) -> Table:
    """Spatiotemporal values of both legs, of the reference, and their asymmetry."""
    rows, records = [], []
    for value, (words, unit, digits) in VALUES.items():
        each = {side: leg.values[value] for side, leg in reading.legs.items() if value in leg.values}
        if not each:
            continue
        means = {side: float(own.mean()) for side, own in each.items()}
        spreads = {side: float(own.std(ddof=1)) if len(own) > 1 else np.nan for side, own in each.items()}
        left, right = (means.get(side, np.nan) for side in FEET)
        uneven = 100 * (left - right) / ((left + right) / 2) if left * right > 0 else None
        limits = reading.spatiotemporal.get(value)
        cells = [mean_cell(means[s], spreads[s], len(each[s]), digits) if s in each else NONE for s in FEET]
        own = f"{number(limits.mean, digits)} ± {limits.sd:.{digits}f}" if limits else NONE
        rows.append((f"{words} [{unit}]", *cells, own, NONE if uneven is None else f"{number(uneven, 0)} %"))
        record = {"value": value, "unit": unit, "asymmetry_percent": uneven}
        for side, mean in means.items():
            record |= {f"mean_{side}": mean, f"sd_{side}": spreads[side], f"n_{side}": len(each[side])}
        if limits:
            record |= {"reference_mean": limits.mean, "reference_sd": limits.sd, "reference_people": limits.people}
        records.append(record)
    people = max((one.people for one in reading.spatiotemporal.values()), default=0)
    known = f"reference mean ± standard deviation over legs, {people} people" if people else "no reference"
    caption = f"Mean ± standard deviation (cycles); {known}; asymmetry: left less right over their mean."
    columns = ("value", "left", "right", "reference", "asymmetry")
    return Table("spatiotemporal", caption, columns, tuple(rows), pd.DataFrame(records))


def numbers_table(reading: ClinicalReading) -> Table:
    """Every value that a rule looks at beside its limits, those that stand out first."""
    rows, records = [], []
    for one in reading.numbers:
        unit, limits = unit_text(one.unit), one.limits
        rows.append((
            one.rule, SIDE_WORDS[one.side], f"{number(one.value, one.digits)} {unit}",
            f"{number(limits.low, one.digits)} to {number(limits.high, one.digits)}",
            f"{number(limits.mean, one.digits)} ± {number(limits.sd, max(one.digits, 1))}", str(limits.people),
            str(one.cycles), one.words or NONE,
        ))  # fmt: skip
        records.append({
            "rule": one.rule, "words": one.words, "side": one.side, "value": one.value, "unit": one.unit,
            "low": limits.low, "high": limits.high, "reference_mean": limits.mean, "reference_sd": limits.sd,
            "people": limits.people, "cycles": one.cycles,
        })  # fmt: skip
    caption = (
        f"All values that the rules look at, n = {len(rows)}; {len(reading.noted)} stand out. Limits: within them all "
        f"values of one more healthy person lie, with probability .95."
    )
    columns = ("value of", "side", "value", "limits", "reference", "people", "cycles", "stands out")
    return Table("outstanding", caption, columns, tuple(rows), pd.DataFrame(records))


def profile_table(reading: ClinicalReading) -> Table | None:
    """Movement analysis profile: variable scores of both legs beside the reference's own."""
    profile = reading.profile
    if profile is None:
        return None
    rows, records = [], []
    for name in PROFILE:
        scores = {side: profile.variables[name, side] for side in FEET if (name, side) in profile.variables}
        some = next(iter(scores.values()))
        own = f"{number(some.reference_mean, 1)} ± {number(some.reference_sd, 1)}"
        cells = [number(scores[side].value, 1) if side in scores else NONE for side in FEET]
        rows.append((BY_NAME[name].words, *cells, own if np.isfinite(some.reference_mean) else NONE))
        for side, score in scores.items():
            records.append({"variable": name, "side": side, "score_deg": score.value, "low": score.low,
                            "high": score.high, "cycles": score.cycles, "reference_mean": score.reference_mean,
                            "reference_sd": score.reference_sd, "people": score.people})  # fmt: skip
    caption = "Movement analysis profile: root mean square difference to the reference's mean curve [deg] (Baker 2009)."
    return Table("profile", caption, ("curve", "left", "right", "reference"), tuple(rows), pd.DataFrame(records))


def files_table(readings: list[ClinicalReading]) -> Table:
    """Files by hash."""
    files = {name: sha for reading in readings for name, sha in reading.pooled.files.items()}
    rows = list(files.items())
    return words_table("files", f"Files, n = {len(rows)}.", ("file", "SHA-256"), rows)


def profile_svg(profile: Profile, say: Callable[[str], str] = str) -> str:
    """Bars of a profile; left above right, the reference's mean and spread behind."""
    rows: list[tuple[str, dict[str, Score]]] = [
        (BY_NAME[n].words, {s: profile.variables[n, s] for s in FEET if (n, s) in profile.variables}) for n in PROFILE
    ]
    rows.append(("gait profile score", dict(profile.legs)))
    shown = [score for _, scores in rows for score in scores.values()]
    ends = [(score.value, score.reference_mean + score.reference_sd) for score in shown]
    top = 1.08 * max(1e-6, *(end for both in ends for end in both if np.isfinite(end)))
    height = (BOTTOM - TOP) / len(rows)

    def x(value: float) -> float:
        return LEFT + value / top * (RIGHT - LEFT)

    alt = "; ".join(
        f"{say(words)} {', '.join(f'{say(SIDE_WORDS[s])} {number(one.value, 1)}' for s, one in scores.items())}"
        for words, scores in rows
    )
    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="Scores [deg]: {escape(alt, quote=True)}">']
    for place in ticks(0.0, top):
        parts.append(f'<path class="zero" d="M{x(place):.1f} {TOP}V{BOTTOM}"/>')
        parts.append(f'<text x="{x(place):.1f}" y="{BOTTOM + 12}" text-anchor="middle">{number(place, 0)}</text>')
    for k, (words, scores) in enumerate(rows):
        at = TOP + k * height
        parts.append(
            f'<text x="{LEFT - 4}" y="{at + height / 2 + 3:.1f}" text-anchor="end">{escape(say(words))}</text>'
        )
        parts += _bars(scores, at, height, x)
    return "".join([*parts, "</svg>"])


def _bars(scores: dict[str, Score], at: float, height: float, x) -> list[str]:
    parts: list[str] = []
    if not scores:
        return parts
    some = next(iter(scores.values()))
    if np.isfinite(some.reference_mean):
        low, high = max(0.0, some.reference_mean - some.reference_sd), some.reference_mean + some.reference_sd
        parts.append(
            f'<rect class="band" x="{x(low):.1f}" y="{at + 2:.1f}" width="{x(high) - x(low):.1f}" '
            f'height="{height - 4:.1f}"/>'
            f'<path class="axis" d="M{x(some.reference_mean):.1f} {at + 2:.1f}v{height - 4:.1f}"/>'
        )
    for k, side in enumerate(side for side in FEET if side in scores):
        thick = (height - 8) / 2
        y = at + 4 + k * thick
        parts.append(
            f'<rect x="{LEFT}" y="{y:.1f}" width="{x(scores[side].value) - LEFT:.1f}" height="{thick - 1.5:.1f}" '
            f'fill="{SIDES[side].colour}" fill-opacity="{1.0 if side == "l" else 0.55}" stroke="{SIDES[side].colour}"/>'
        )
    return parts


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
