"""Pages of everybody in a run, and the index: each person apart, so that one who fails costs nobody else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.errors import GaitdiscError, SchemaError, WriteError
from gaitdisc.whole_file import remove_file, write_whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from gaitdisc.report.clinic.values import PageWords
    from gaitdisc.results.clinical_reference import ClinicalReference, PersonSession
    from gaitdisc.results.provenance import Provenance
    from gaitdisc.results.study_run import StudyRun

REFERENCE = "reference"  # folder of a run, beside its cycles
WORDS = "words.csv"  # of another language, beside them


def keep_reference(place: Path | None, run_folder: Path) -> None:
    """Copy a reference into a run, so that its pages are drawn again without it."""
    from gaitdisc.results.clinical_reference import FILE, PUBLISHED, load_reference, save_reference

    if place is None:
        return
    found, own = load_reference(place), run_folder / REFERENCE
    if found.published:
        write_whole(own / PUBLISHED, (place / PUBLISHED if place.is_dir() else place).read_text(encoding="utf-8"))
        remove_file(own / FILE)
    else:
        save_reference(found, own)
        remove_file(own / PUBLISHED)


def kept_reference(run_folder: Path) -> ClinicalReference | None:
    """Reference that was copied into a run; None where none was."""
    from gaitdisc.results.clinical_reference import FILE, PUBLISHED, load_reference

    folder = run_folder / REFERENCE
    there = (folder / FILE).is_file() or (folder / PUBLISHED).is_file()
    return load_reference(folder) if there else None


def keep_words(language: str, run_folder: Path) -> list[str]:
    """Copy a table of words into a run, or take it away for `en`; gives the words that it lacks."""
    from gaitdisc.report.clinic.values import read_words, write_words

    if language == "en":
        remove_file(run_folder / WORDS)
        return []
    english = _english()
    words = read_words(Path(language), english)
    write_words(run_folder / WORDS, english, words)
    return [word for word in english if not words.other.get(word)]


def write_english(path: Path) -> Path:
    """Write the table of words that is to be filled in."""
    from gaitdisc.report.clinic.values import write_words

    return write_words(path, _english())


def _english() -> list[str]:
    from gaitdisc.clinic.rules import rule_words
    from gaitdisc.report.clinic.values import english_words

    return english_words(rule_words())


def kept_words(run_folder: Path) -> PageWords:
    """Words of the pages of a run: English where no others were kept."""
    from gaitdisc.report.clinic.values import ENGLISH, read_words

    return read_words(run_folder / WORDS, _english()) if (run_folder / WORDS).is_file() else ENGLISH


def page_of_run(run: StudyRun, run_folder: Path) -> Path:
    """Page of a run with pages of its people and their index, drawn where they are not those of this very run."""
    from gaitdisc.report.saved_page import page_of
    from gaitdisc.results.kind import find_kind

    def drawn() -> Path:
        page = find_kind(run_folder).draw(run, run_folder)
        write_people(run, run_folder)
        return page

    return page_of(run_folder, drawn)


def write_people(
    run: StudyRun, run_folder: Path, pdf: bool = False, progress: Callable[[Path], None] = lambda _: None
) -> Path | None:
    """Write pages of each person and session, and `index.html`; None for a run without cycles."""
    from gaitdisc.results.pooled_cycles import CYCLES

    if not run.of(CYCLES):
        return None
    from gaitdisc.batch.read_people import people_of, sessions_of
    from gaitdisc.report.clinic.person_page import page_names, write_index

    report, reference, people = run_folder / "report", kept_reference(run_folder), people_of(run)
    say = kept_words(run_folder)
    names = dict(zip(people, page_names(people), strict=True))
    written, failed = [], []
    for title, person in sessions_of(run, reference):
        if isinstance(person, GaitdiscError):
            failed.append((title, str(person)))
            continue
        try:
            for page in _pages(person, names[title], reference, run.provenance, report, say, pdf):
                progress(page)
            written.append((person, names[title]))
        except WriteError:  # of the disk, not of the person: the page would stand as one that cannot be written
            raise
        except (GaitdiscError, ArithmeticError, LookupError, ValueError, TypeError) as error:
            failed.append((title, f"the page could not be written: {error}"))
    return write_index(_with_failed(run, failed, run_folder), written, reference, report, say)


def write_before_after(run: StudyRun, run_folder: Path, person: str, words: tuple[str, str]) -> Path:
    """Write the page of a person before and after."""
    from gaitdisc.batch.read_people import before_and_after, readings_of
    from gaitdisc.clinic.reading import contrast_of
    from gaitdisc.report.clinic.person_page import PersonSession, page_names, write_person_page

    reference = kept_reference(run_folder)
    before, after = before_and_after(readings_of(run, reference), person, words)
    title = f"{person} {words[0]} {words[1]}"
    page = PersonSession(title, (after, before), (contrast_of(before, after),))
    name = page_names([title])[0]
    return write_person_page(page, name, reference, run.provenance, run_folder / "report", kept_words(run_folder))


def write_person(run: StudyRun, run_folder: Path, person: str, pdf: bool = False) -> list[Path]:
    """Write the pages of one person, a page a session, as HTML and where wanted as PDF."""
    from gaitdisc.batch.read_people import people_of, sessions_of
    from gaitdisc.report.clinic.person_page import page_names
    from gaitdisc.results.pooled_cycles import CYCLES

    own = run.with_units(CYCLES, tuple(one for one in run.of(CYCLES) if one.subject == person))
    if not own.of(CYCLES):
        people = ", ".join(dict.fromkeys(one.subject for one in run.of(CYCLES))) or "nobody"
        raise SchemaError("a page needs a person of the run", f"{person!r}; there are {people}", "Name one of them.")
    everybody = people_of(run)
    names = dict(zip(everybody, page_names(everybody), strict=True))
    reference, say, found = kept_reference(run_folder), kept_words(run_folder), []
    for title, one in sessions_of(own, reference):
        if isinstance(one, GaitdiscError):
            raise one
        found += _pages(one, names[title], reference, run.provenance, run_folder / "report", say, pdf)
    return found


def _pages(
    person: PersonSession,
    name: str,
    reference: ClinicalReference | None,
    provenance: Provenance,
    report: Path,
    say: PageWords,
    pdf: bool,
) -> list[Path]:
    """Write the page of a person and session into a report, in these words, as HTML and where wanted as PDF."""
    from gaitdisc.report.clinic.person_page import write_person_page

    page = write_person_page(person, name, reference, provenance, report, say)
    if not pdf:
        return [page]
    from gaitdisc.report.clinic.person_pdf import write_person_pdf

    return [page, write_person_pdf(person, provenance, page.with_suffix(".pdf"), say)]


def _with_failed(run: StudyRun, failed: list[tuple[str, str]], run_folder: Path) -> StudyRun:
    """Run with those refused whose pages failed; where the folder lies may name somebody, so that is taken out."""
    from gaitdisc.results.provenance import Refusal

    places = [str(run_folder.absolute()), *([str(run_folder)] if len(run_folder.parts) > 1 else [])]
    refusals = []
    for title, reason in failed:
        for place in places:
            reason = reason.replace(place, "run")  # noqa: PLW2901
        refusals.append(Refusal(title, "", reason))
    return replace(run, refusals=(*run.refusals, *refusals))
