"""Sentences of a person's page: what stands out, scores, quality, before and after."""

from collections.abc import Callable, Sequence

import numpy as np

from gaitdisc.clinic.clinical_reference import (
    FEW,
    SCORE_LEAST,
    ClinicalReading,
    Contrast,
    DifferingSpan,
    Noted,
    PersonSession,
    Score,
)
from gaitdisc.clinic.page_words import ENGLISH, NEAREST, TIERS, PageWords
from gaitdisc.clinic.values import MARKS
from gaitdisc.processing.leg_curves import BY_NAME, FEET
from gaitdisc.processing.pooled_cycles import PooledCycles
from gaitdisc.words import SIDE_WORDS, counted, number, p_words, unit_text

MOST = 6  # sentences of a tier
MANY = 20  # controls from whom on limits lie within four standard deviations (docs/clinic.md)
MOST_SPANS = 6


def write_noted(noted: Sequence[Noted], tier: int, say: Callable[[str], str] = str) -> list[str]:
    """One sentence for all that says one thing, both legs in one, at its highest tier; at most six, farthest first."""
    together: dict[str, list[Noted]] = {}
    for note in sorted(noted, key=lambda note: (-note.tier, bool(note.other))):  # a leg's own value before a difference
        together.setdefault(note.group or note.rule, []).append(note)
    return [_write_note(notes, say) for notes in together.values() if notes[0].tier == tier][:MOST]


def _write_note(notes: Sequence[Noted], say: Callable[[str], str]) -> str:
    """Value of the farthest rule beside its limits; what else says the same after it."""
    by_rule: dict[tuple[str, bool], list[Noted]] = {}
    for note in notes:
        by_rule.setdefault((note.words, bool(note.other)), []).append(note)
    first, limits = notes[0], notes[0].limits
    unit, (low, high) = unit_text(first.unit), (limits.low, limits.high) if first.tier == 2 else limits.band
    low, high, mean = (number(value, first.digits) for value in (low, high, limits.mean))
    sd, word = number(limits.sd, max(first.digits, 1)), say("limits") if first.tier == 2 else "2 sd:"
    texts, last = [], ""
    for (words, _), rule_notes in by_rule.items():
        texts.append(("" if words == last else f"{say(words)}: ") + _each(rule_notes, first.tier, say))
        last = words
    text = (
        f"{texts[0]}; {word} {low} {say('to')} {high} {unit}, "
        f"{say('reference')} {mean} ± {sd} {unit}, {limits.people} {say('people')}"
    )
    more = "".join(f"; {text}" for text in texts[1:])
    return f"{text[0].upper()}{text[1:]}{more}."


def _each(notes: Sequence[Noted], tier: int, say: Callable[[str], str]) -> str:
    texts = []
    for note in sorted(notes, key=lambda note: note.side):
        cycles = f"{note.cycles} {say('cycle' if note.cycles == 1 else 'cycles')}"
        less = f", {MARKS[note.tier]}" if note.tier < tier else ""
        value = f"{number(abs(note.value) if note.other else note.value, note.digits)} {unit_text(note.unit)}"
        if note.other:  # words of a rule say which way
            way = "apart from" if note.words != note.rule else "more than" if note.value > 0 else "less than"
            value += f" {say(way)} {say(SIDE_WORDS[note.other])}"
            cycles += f"; {say('neither leg stands out by itself')}" if note.words == note.rule else ""
        texts.append(f"{say(SIDE_WORDS[note.side])} {value} ({cycles}{less})".strip())
    return ", ".join(texts)


def outstanding_sentences(reading: ClinicalReading, say: Callable[[str], str] = str) -> dict[str, list[str]]:
    """What stands out by its tier, and after it what could not be said, or why nothing is."""
    if reading.silent:
        return {"": [say("No comparison with controls: {}.").format(reading.silent)]}
    tiers = {f"{MARKS[tier]} {say(words)}": write_noted(reading.noted, tier, say) for tier, words in TIERS.items()}
    tier_sentences = {words: sentences for words, sentences in tiers.items() if sentences}
    rest = []
    enough = sum(note.cycles >= FEW for note in reading.numbers)
    if enough and not tier_sentences:
        rest.append(say("None of {} values lies outside 2 standard deviations of the reference.").format(enough))
    few = [f"{leg.count} {say(SIDE_WORDS[side])}" for side, leg in reading.legs.items() if leg.count < FEW]
    if few:
        rest.append(say("A leg must have {} cycles to be reported; there are {}.").format(FEW, ", ".join(few)))
    people = max((band.people for band in reading.bands.values()), default=0)
    if people < MANY:
        which = f"{people}, {say(NEAREST[reading.nearest])}" if reading.nearest else people
        rest.append(say("With few controls ({}) the 95 % limits are wide: differences may be missed.").format(which))
    return {**tier_sentences, **({"": rest} if rest else {})}


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
    why = f" Why {reading.light}: {'; '.join(reading.reasons)}." if reading.reasons and reading.legs else ""
    what = f"{counts} cycles of {counted(pooled.trials, 'trial')} {ground}" if pooled.trials else "no trial was kept"
    return f"{what}{plates}{out}.{why}"


def score_words(score: Score) -> str:
    """Score with the range of single cycles and the reference's own.

    >>> score_words(Score(7.2, 6.5, 8.1, 4, 5.1, 1.0, 20))
    '7.2 deg (4 cycles 6.5 to 8.1; reference 5.1 ± 1.0, 20 people)'
    """
    details = []
    if score.cycles > 1 and np.isfinite(score.low):
        details.append(f"{score.cycles} cycles {number(score.low, 1)} to {number(score.high, 1)}")
    if np.isfinite(score.reference_mean):
        reference = f"{number(score.reference_mean, 1)} ± {number(score.reference_sd, 1)}"
        details.append(f"reference {reference}, {score.people} people")
    return f"{number(score.value, 1)} deg" + (f" ({'; '.join(details)})" if details else "")


def score_sentences(reading: ClinicalReading) -> list[str]:
    """Gait profile score and gait deviation index and what they mean, or why there is none."""
    sentences = []
    if reading.profile is None:
        sentences.append(f"No gait profile score: {reading.no_profile}.")
    else:
        scores = [f"{SIDE_WORDS[side]} {score_words(score)}" for side, score in reading.profile.legs.items()]
        both = reading.profile.both
        means = f" {_meaning(both)}" if both and np.isfinite(both.reference_sd) else ""
        sentences.append(
            f"Gait profile score: {'; '.join([*([f'both {score_words(both)}'] if both else []), *scores])}.{means}"
        )
    if reading.deviation_index:
        scores = [f"{SIDE_WORDS[side]} {number(value, 0)}" for side, value in reading.deviation_index.items()]
        far = max(0.0, (100 - min(reading.deviation_index.values())) / 10)
        sentences.append(
            f"Gait deviation index: {', '.join(scores)} (controls 100 ± 10). The lowest value lies {number(far, 1)} "
            "standard deviations of the controls below their mean."
        )
    else:
        sentences.append(f"No gait deviation index: {reading.no_index}.")
    return sentences


def _meaning(score: Score) -> str:
    more = score.value - score.reference_mean
    word = "more" if more >= 0 else "less"
    return (
        f"All curves together lie {number(score.value, 1)} deg (root mean square) from the controls' mean, "
        f"{number(abs(more), 1)} deg {word} than those of a typical control; differences of {SCORE_LEAST:g} deg or "
        "more matter (Baker 2012)."
    )


def name_walk(pooled: PooledCycles, say: Callable[[str], str] = str) -> str:
    """Session and condition, named as such where there are sessions."""
    if not pooled.session:
        return pooled.condition
    return f"{say('session')} {pooled.session}, {say('condition')} {pooled.condition}"


def contrast_heading(contrast: Contrast, say: Callable[[str], str] = str) -> str:
    """Both sessions and their condition, or both conditions and their session."""
    first, second = contrast.first.pooled, contrast.second.pooled
    shared = f", {say('condition')} {second.condition}" if first.condition == second.condition else ""
    shared += f", {say('session')} {second.session}" if first.session == second.session and second.session else ""
    return " and ".join(contrast.names) + shared


def contrast_sentences(contrast: Contrast) -> list[str]:
    """Where two sets of cycles differ and by how much; the largest first, and what was not tested."""
    first, second = contrast.names
    sentences = [f"{SIDE_WORDS[side].capitalize()}: not tested; {why}" for side, why in contrast.untested.items()]
    spans = sorted((span for span in contrast.spans if span.matters), key=lambda span: -abs(span.difference))
    sentences += [_span(span, contrast) for span in spans[:MOST_SPANS]]
    small = len(contrast.spans) - len(spans)
    if contrast.tested and not spans:
        sides = " and ".join(SIDE_WORDS[side] for side in contrast.tested)
        sentences.append(
            f"{sides.capitalize()}: no part of the cycle differs by 5 deg or more between ‘{first}’ and ‘{second}’."
        )
    if small:
        sentences.append(f"In {counted(small, 'part')} of the cycle the walks differ, but by less than 5 deg.")
    return sentences


def _span(span: DifferingSpan, contrast: Contrast) -> str:
    variable = BY_NAME[span.variable]
    counts = [reading.legs[span.side].count for reading in (contrast.first, contrast.second)]
    more = "more" if span.difference > 0 else "less"
    amount = f"{number(abs(span.difference), 0)} {variable.unit} {more} ({variable.up})"
    return (
        f"{variable.words.capitalize()}, {SIDE_WORDS[span.side]}: {amount} in"
        f" ‘{contrast.names[1]}’ than in ‘{contrast.names[0]}’, at {span.first} to "
        f"{span.last} % of the cycle; {p_words(span.p)}, {counts[0]} and {counts[1]} cycles."
    )
