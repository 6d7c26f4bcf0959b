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
from gaitdisc.report.clinic.laboratory import Laboratory
from gaitdisc.report.clinic.panels import Panel, ticks
from gaitdisc.report.cycles_tables import VALUES, mean_cell
from gaitdisc.report.panels import SIDES
from gaitdisc.report.table import Table, words_table
from gaitdisc.results.clinical_reference import (
    FEW,
    SCORE_LEAST,
    ClinicalReading,
    Contrast,
    DifferingSpan,
    Noted,
    PersonSession,
    Profile,
    Score,
)
from gaitdisc.results.leg_curves import BY_NAME, FEET, PROFILE, VARIABLES
from gaitdisc.whole_file import write_whole
from gaitdisc.words import NONE, SIDE_WORDS, counted, number, p_words, unit_text

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 330, 205, 110, 322, 2, 190
TEMPLATES = ("person.html.j2", "people.html.j2")
TABLES = (  # headings and cells of tables, and the words between numbers in a sentence of what stands out
    "value", "left", "right", "reference", "asymmetry", "value of", "side", "limits", "people", "cycles", "stands out",
    "curve", "file", "what", "version", "cycle", "to", "state", "person", "condition", "cycles L, R", "Side affected",
    "both", "profile score [deg]", "why",
    "green", "amber", "red", "gait profile score", "Time and distance",
    "None of {} values lies outside 2 standard deviations of the reference.", "Nothing is said to stand out: {}.",
    "A sentence needs {} cycles of a leg; there are {}.",
    "With {} controls the 95 % limits are wide: smaller differences may be there.",
    "Beyond what one more healthy person shows (95 % limits of this page)",
    "Outside 2 standard deviations of the controls, within those limits",
)  # fmt: skip
HEADER = ("English", "other")
LARGEST_BYTES = 2**20
MOST = 6  # sentences of a tier
MANY = 20  # controls from whom on limits lie within four standard deviations (docs/clinic.md)
MOST_SPANS = 6


def values_table(reading: ClinicalReading) -> Table:
    """Spatiotemporal values of both legs, of the reference, and their asymmetry."""
    rows, records = [], []
    for value, (words, unit, digits) in VALUES.items():
        each = {side: leg.values[value] for side, leg in reading.legs.items() if value in leg.values}
        if not each:
            continue
        means = {side: float(own.mean()) for side, own in each.items()}
        spreads = {side: float(own.std(ddof=1)) if len(own) >= FEW else np.nan for side, own in each.items()}
        left, right = (means[side] if len(each.get(side, ())) >= FEW else np.nan for side in FEET)
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
    caption = (
        f"Mean ± standard deviation (cycles), of {FEW} cycles or more; {known}; asymmetry: left less right over their "
        f"mean."
    )
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
            str(one.cycles), f"{MARKS[one.tier]} {one.words}".strip(),
        ))  # fmt: skip
        records.append({
            "rule": one.rule, "words": one.words, "side": one.side, "value": one.value, "unit": one.unit,
            "low": limits.low, "high": limits.high, "reference_mean": limits.mean, "reference_sd": limits.sd,
            "people": limits.people, "cycles": one.cycles, "tier": one.tier,
        })  # fmt: skip
    caption = (
        f"All values that the rules look at, n = {len(rows)}; {len(reading.noted)} stand out: □ outside 2 standard "
        f"deviations, ■ beyond the limits, within which all values of one more healthy person lie with probability "
        f"0.95. Reference: at this person's speed where it follows the speed."
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


def change_table(contrast: Contrast) -> Table:
    """Values of both legs in the first and the second of two, and the profile scores."""
    pair = (contrast.first, contrast.second)
    columns = ("value", *(f"{SIDE_WORDS[side]}, {one.pooled.where}" for side in FEET for one in pair))
    rows = []
    for value, (words, unit, digits) in VALUES.items():
        each = [one.legs[side].values.get(value) if side in one.legs else None for side in FEET for one in pair]
        if any(own is not None for own in each):
            spreads = [own.std(ddof=1) if own is not None and len(own) >= FEW else np.nan for own in each]
            cells = [
                mean_cell(float(own.mean()), float(spread), len(own), digits) if own is not None else NONE
                for own, spread in zip(each, spreads, strict=True)
            ]
            rows.append((f"{words} [{unit}]", *cells))
    scores = [one.profile.legs.get(side) if one.profile else None for side in FEET for one in pair]
    if any(scores):
        rows.append(("gait profile score [deg]", *(number(one.value, 1) if one else NONE for one in scores)))
    caption = (
        f"Mean ± standard deviation (cycles). A profile score that changes by {SCORE_LEAST:g} deg or more matters."
    )
    numbers = pd.DataFrame(rows, columns=pd.Index(columns))
    return Table("changes", caption, columns, tuple(rows), numbers)


def profile_rows(profile: Profile) -> list[tuple[str, dict[str, Score]]]:
    """Scores of both legs, curve by curve, the profile scores last."""
    rows = [
        (BY_NAME[n].words, {s: profile.variables[n, s] for s in FEET if (n, s) in profile.variables}) for n in PROFILE
    ]
    return [*rows, ("gait profile score", dict(profile.legs))]


def profile_svg(profile: Profile, say: Callable[[str], str] = str) -> str:
    """Bars of a profile; left above right, the reference's mean and spread behind."""
    rows = profile_rows(profile)
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


TIERS = {
    2: "Beyond what one more healthy person shows (95 % limits of this page)",
    1: "Outside 2 standard deviations of the controls, within those limits",
}
MARKS = {2: "■", 1: "□", 0: NONE}


def noted_sentences(noted: Sequence[Noted], tier: int, say: Callable[[str], str] = str) -> list[str]:
    """One sentence for all that says one thing, both legs in one, at its highest tier; at most six, farthest first."""
    together: dict[str, list[Noted]] = {}
    for one in noted:
        together.setdefault(one.group or one.rule, []).append(one)
    return [_noted(own, say) for own in together.values() if own[0].tier == tier][:MOST]


def _noted(own: Sequence[Noted], say: Callable[[str], str]) -> str:
    """Value of the farthest rule beside its limits; what else says the same after it."""
    by_rule: dict[str, list[Noted]] = {}
    for one in own:
        by_rule.setdefault(one.words, []).append(one)
    first, limits = own[0], own[0].limits
    unit, (low, high) = unit_text(first.unit), (limits.low, limits.high) if first.tier == 2 else limits.band
    low, high, mean = (number(value, first.digits) for value in (low, high, limits.mean))
    sd, word = number(limits.sd, max(first.digits, 1)), say("limits") if first.tier == 2 else "2 sd:"
    parts = [f"{say(words)}: {_each(each, first.tier, say)}" for words, each in by_rule.items()]
    text = (
        f"{parts[0]}; {word} {low} {say('to')} {high} {unit}, "
        f"{say('reference')} {mean} ± {sd} {unit}, {limits.people} {say('people')}"
    )
    more = "".join(f"; {part}" for part in parts[1:])
    return f"{text[0].upper()}{text[1:]}{more}."


def _each(own: Sequence[Noted], tier: int, say: Callable[[str], str]) -> str:
    found = []
    for one in sorted(own, key=lambda one: one.side):
        cycles = f"{one.cycles} {say('cycle' if one.cycles == 1 else 'cycles')}"
        less = f", {MARKS[one.tier]}" if one.tier < tier else ""
        value = f"{number(one.value, one.digits)} {unit_text(one.unit)} ({cycles}{less})"
        found.append(f"{say(SIDE_WORDS[one.side])} {value}".strip())
    return ", ".join(found)


def outstanding_sentences(reading: ClinicalReading, say: Callable[[str], str] = str) -> dict[str, list[str]]:
    """What stands out by its tier, and after it what could not be said, or why nothing is."""
    if reading.silent:
        return {"": [say("Nothing is said to stand out: {}.").format(reading.silent)]}
    tiers = {f"{MARKS[tier]} {say(words)}": noted_sentences(reading.noted, tier, say) for tier, words in TIERS.items()}
    found = {words: sentences for words, sentences in tiers.items() if sentences}
    rest = []
    if not found:
        rest.append(
            say("None of {} values lies outside 2 standard deviations of the reference.").format(len(reading.numbers))
        )
    few = [f"{leg.count} {say(SIDE_WORDS[side])}" for side, leg in reading.legs.items() if leg.count < FEW]
    if few:
        rest.append(say("A sentence needs {} cycles of a leg; there are {}.").format(FEW, ", ".join(few)))
    people = max((band.people for band in reading.bands.values()), default=0)
    if people < MANY:
        rest.append(say("With {} controls the 95 % limits are wide: smaller differences may be there.").format(people))
    return {**found, **({"": rest} if rest else {})}


def laboratory_sentences(person: PersonSession, say: PageWords = ENGLISH) -> list[str]:
    """Side affected and comment, as the laboratory says them of the person."""
    subject, house = person.readings[0].pooled.subject, say.laboratory
    affected, comment = house.affected.get(subject), house.comments.get(subject, "").strip()
    return [*([f"{say('Side affected')}: {say(affected)}."] if affected else []), *([comment] if comment else [])]


def quality_sentence(reading: ClinicalReading) -> str:
    """What was recorded, and how good it is, in one line."""
    pooled = reading.pooled
    counts = " and ".join(f"{pooled.counted(side)} {SIDE_WORDS[side]}" for side in FEET)
    kinetic = int(pooled.kept["kinetic"].astype(bool).sum())
    plates = f", {kinetic} on a plate" if kinetic else ""
    out = f", {len(pooled.left_out)} left out" if len(pooled.left_out) else ""
    gone = len({refusal.condition for refusal in pooled.refusals})
    out += f", {counted(gone, 'trial')} left out" if gone else ""
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
    """Gait profile score and gait deviation index and what they mean, or why there is none."""
    found = []
    if reading.profile is None:
        found.append(f"No gait profile score: {reading.no_profile}.")
    else:
        each = [f"{SIDE_WORDS[side]} {score_words(score)}" for side, score in reading.profile.legs.items()]
        both = reading.profile.both
        means = f" {_meaning(both)}" if both and np.isfinite(both.reference_sd) else ""
        found.append(
            f"Gait profile score: {'; '.join([*([f'both {score_words(both)}'] if both else []), *each])}.{means}"
        )
    if reading.deviation_index:
        each = [f"{SIDE_WORDS[side]} {number(value, 0)}" for side, value in reading.deviation_index.items()]
        far = max(0.0, (100 - min(reading.deviation_index.values())) / 10)
        found.append(
            f"Gait deviation index: {', '.join(each)} (controls 100 ± 10). The lower leg lies "
            f"{number(far, 1)} standard deviations of the controls below their mean."
        )
    else:
        found.append(f"No gait deviation index: {reading.no_index}.")
    return found


def _meaning(score: Score) -> str:
    more = score.value - score.reference_mean
    word = "more" if more >= 0 else "less"
    return (
        f"All curves together lie {number(score.value, 1)} deg (root mean square) from the controls' mean, "
        f"{number(abs(more), 1)} deg {word} than a control's do; differences from {SCORE_LEAST:g} deg on matter "
        f"(Baker 2012)."
    )


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
