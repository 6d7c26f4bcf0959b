"""Index of a week: who is there, refused first, what is amber and why, scores, and a link to each page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gaitdisc.report.clinic.words import ENGLISH, PageWords, noted_sentences
from gaitdisc.report.page import page_text
from gaitdisc.report.table import save_tables, words_table
from gaitdisc.results.clinical_reading import ClinicalReading, PersonSession
from gaitdisc.results.clinical_reference import ClinicalReference
from gaitdisc.results.study_run import StudyRun
from gaitdisc.whole_file import write_whole
from gaitdisc.words import NONE, counted, number

RANKS = {"red": 0, "amber": 1, "green": 2}
COLUMNS = ("light", "person", "condition", "cycles", "score", "noted", "why")
HEADINGS = ("state", "person", "condition", "cycles L, R", "profile score [deg]", "stands out", "why")


def write_index(
    run: StudyRun,
    sessions: Sequence[tuple[PersonSession, str]],
    reference: ClinicalReference | None,
    folder: Path,
    say: PageWords = ENGLISH,
) -> Path:
    """Write `index.html`: one row a person, session and condition, those without a result first.

    sessions sequence of (PersonSession, str): with the name of each one's page, empty where none could be written
    """
    rows = [_row(reading, one, name, say) for one, name in sessions for reading in one.readings]
    known = {reading.pooled.subject for one, _ in sessions for reading in one.readings}
    whole = [refusal for refusal in run.refusals if refusal.participant not in known]
    for refusal in whole:
        who = {"light": "red", "subject": refusal.participant, "person": refusal.participant, "page": ""}
        own = {"condition": refusal.condition or NONE, "why": refusal.reason}
        rows.append({**who, **own, **dict.fromkeys(("cycles", "score", "noted"), NONE)})
    rows.sort(key=lambda row: RANKS[row["light"]])
    cells = [tuple(row[key] for key in COLUMNS) for row in rows]
    table = words_table("people", "People of the run.", HEADINGS, cells)
    save_tables([table], folder)
    lights = {light: sum(row["light"] == light for row in rows) for light in RANKS}
    shown = {
        "say": say,
        "title": run.title,
        "created": run.provenance.created[:10],
        "rows": rows,
        "headings": HEADINGS,
        "whole": (folder / "report.html").is_file(),
        "lights": lights,
        "reference": _reference_words(reference),
        "people": counted(len({row["subject"] for row in rows}), "person").replace("persons", "people"),
    }
    return write_whole(folder / "index.html", page_text("people", shown))


def _row(reading: ClinicalReading, person: PersonSession, name: str, say: PageWords) -> dict[str, str]:
    pooled = reading.pooled
    score = reading.profile.both if reading.profile else None
    sentences = noted_sentences(reading.noted, say)
    first = f"{len(reading.noted)}: {sentences[0].partition(';')[0]}" if sentences else NONE
    return {
        "light": reading.light,
        "subject": pooled.subject,
        "person": person.title,
        "condition": pooled.condition,
        "cycles": f"{pooled.counted('l')}, {pooled.counted('r')}",
        "score": number(score.value, 1) if score else NONE,
        "noted": first if not reading.silent else say("not said"),
        "why": "; ".join(reading.reasons) or NONE,
        "page": f"people/{name}.html" if name else "",
    }


def _reference_words(reference: ClinicalReference | None) -> str:
    if reference is None:
        return "No reference: no bands, no scores, and nothing is said to stand out."
    if reference.published:
        return f"Published reference: {reference.title}."
    counts = ", ".join(f"{word} {reference.people(word)}" for word in reference.legs)
    return f"Reference of the laboratory's own controls: {counts}; saved {reference.created[:10]}."
