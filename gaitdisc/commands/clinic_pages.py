"""Pages of everybody in a run, and the index: each person apart, so that one who fails costs nobody else."""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.errors import GaitdiscError, SchemaError, WriteError
from gaitdisc.own_files import file_sha256
from gaitdisc.whole_file import remove_file, write_whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from gaitdisc.clinic.clinical_reference import ClinicalReference, PersonSession
    from gaitdisc.clinic.laboratory import PageWords
    from gaitdisc.ingest.study import Study
    from gaitdisc.saved.provenance import Refusal
    from gaitdisc.saved.study_run import StudyRun

LABORATORY = "laboratory"  # folder of a run: what the pages were drawn with
REFERENCE = "reference"  # folder of a run, beside its cycles
WORDS = "words.csv"  # of another language, beside them


def keep_reference(place: Path | None, run_folder: Path) -> None:
    """Copy a reference into a run, so that its pages are drawn again without it."""
    from gaitdisc.clinic.clinical_reference import FILE, PUBLISHED, load_reference, save_reference

    if place is None:
        return
    found, own = load_reference(place), run_folder / REFERENCE
    if found.published:
        write_whole(own / PUBLISHED, (place / PUBLISHED if place.is_dir() else place).read_text(encoding="utf-8"))
        remove_file(own / FILE)
    else:
        save_reference(found, own)
        remove_file(own / PUBLISHED)


def load_kept_reference(run_folder: Path) -> ClinicalReference | None:
    """Reference that was copied into a run; None where none was."""
    from gaitdisc.clinic.clinical_reference import FILE, PUBLISHED, load_reference

    folder = run_folder / REFERENCE
    there = (folder / FILE).is_file() or (folder / PUBLISHED).is_file()
    return load_reference(folder) if there else None


def keep_words(language: str, run_folder: Path) -> list[str]:
    """Copy a table of words into a run, or take it away for `en`; gives the words that it lacks."""
    from gaitdisc.clinic.laboratory import read_words, write_words

    if language == "en":
        remove_file(run_folder / WORDS)
        return []
    english = _english()
    words = read_words(Path(language), english)
    write_words(run_folder / WORDS, english, words)
    return [word for word in english if not words.other.get(word)]


def write_english(path: Path) -> Path:
    """Write the table of words that is to be filled in."""
    from gaitdisc.clinic.laboratory import write_words

    return write_words(path, _english())


def _english() -> list[str]:
    from gaitdisc.clinic.laboratory import english_words
    from gaitdisc.clinic.rules import rule_words

    return english_words(rule_words())


def load_kept_words(run_folder: Path) -> PageWords:
    """Words of the pages of a run, English where no others were kept; and what `clinic.toml` says."""
    from gaitdisc.clinic.laboratory import ENGLISH, load_laboratory, read_words

    words = read_words(run_folder / WORDS, _english()) if (run_folder / WORDS).is_file() else ENGLISH
    return replace(words, laboratory=load_laboratory(run_folder))


def say_new_recordings(study: Study) -> None:
    """Say how many recordings beside those of the study it does not name, and of whom; their names stay away.

    Looked at is the folder that all recordings lie in, or, where that is the study's own, the folder of each.
    """
    import typer

    from gaitdisc.ingest.people_table import is_people_table

    people = study.participants
    owners = {study.path_of(file).resolve(): one.id for one in people for t in one.trials for file in t.files}
    folders = {path.parent: who for path, who in owners.items()}
    above = Path(os.path.commonpath(folders)) if len(set(folders.values())) > 1 else Path()
    inside = above.parts[2:] and not study.folder.resolve().is_relative_to(above)
    endings = {path.suffix.lower() for path in owners}
    found: dict[str, int] = {}
    each = above.rglob("*") if inside else (path for one in folders if one.is_dir() for path in one.iterdir())
    for path in each:
        if path.suffix.lower() in endings and path.resolve() not in owners and not is_people_table(path):
            who = next((folders[folder] for folder in path.parents if folder in folders), "")
            beside = f"beside those of {who}" if who else "of somebody new or in a new folder"
            found[beside] = found.get(beside, 0) + 1
    new = ", ".join(f"{count} {beside}" for beside, count in sorted(found.items()))
    if new:
        words = "New recordings are not in the study file: {}. Take them up: gaitdisc watch STUDY --from RECORDINGS."
        typer.echo(words.format(new), err=True)


def page_of_run(run: StudyRun, run_folder: Path) -> Path:
    """Page of a run with pages of its people and their index, drawn where they are not those of this very run."""
    from gaitdisc.clinic.laboratory import Laboratory, load_laboratory
    from gaitdisc.report.saved_page import find_page
    from gaitdisc.saved.kind import find_kind
    from gaitdisc.saved.unit_folder import seal_text

    own, place = load_laboratory(run_folder), run_folder / LABORATORY / "laboratory.json"
    if own == Laboratory():
        remove_file(place)
    else:  # so that pages of another laboratory do not stand
        write_whole(place, seal_text(asdict(own)))

    def drawn() -> Path:
        page = find_kind(run_folder).draw(run, run_folder)
        write_people(run, run_folder)
        return page

    return find_page(run_folder, drawn)


def write_people(
    run: StudyRun, run_folder: Path, pdf: bool = False, progress: Callable[[Path], None] = lambda _: None
) -> Path | None:
    """Write pages of each person and session, and `index.html`; None for a run without cycles."""
    from gaitdisc.processing.pooled_cycles import CYCLES

    if not run.of(CYCLES):
        return None
    from gaitdisc.clinic.person_page import index_rows, write_index
    from gaitdisc.clinic.read_people import cycles_of_people, read_session
    from gaitdisc.processing.kept_parts import hash_content, keep_part, read_part
    from gaitdisc.report.figure import file_names
    from gaitdisc.saved.provenance import Refusal

    pages, people = _Pages(run, run_folder, pdf), cycles_of_people(run)
    report, say = pages.report, pages.say
    names, house = file_names(list(people)), say.laboratory
    shared = repr(replace(say, laboratory=replace(house, affected={}, comments={})))
    files = sorted(path for path in (run_folder / REFERENCE).glob("*") if path.is_file())
    rests_on = (" ".join(map(file_sha256, files)), shared, run.nominal, str(pdf))
    rows: list[dict[str, str]] = []
    failed: list[Refusal] = []
    for title, own in people.items():
        name = names[title]
        said = (repr(words.get(own[0].subject)) for words in (house.affected, house.comments))
        key = hash_content(own, *rests_on, *said)
        kept = read_part(report, f"people-{name}", key)
        if kept:
            rows += kept
            continue
        try:
            person = read_session(title, own, run.nominal, pages.reference)
        except GaitdiscError as error:
            failed.append(Refusal(title, "", str(error)))
            continue
        try:
            written = pages.write(person, name)
            for page in written:
                progress(page)
            drawn = index_rows(person, name, say)
            files = [*written, *(report / "people" / name).glob("*.csv")]
            keep_part(report, f"people-{name}", key, drawn, files)
            rows += drawn
        except WriteError:  # of the disk, not of the person: the page would stand as one that cannot be written
            raise
        except (GaitdiscError, ArithmeticError, LookupError, ValueError, TypeError) as error:
            failed.append(Refusal(title, "", f"the page could not be written: {error}"))
    return write_index(_with_failed(run, failed, run_folder), rows, pages.reference, report, say)


def write_person(
    run: StudyRun, run_folder: Path, person: str, words: tuple[str, ...] = (), pdf: bool = False
) -> list[Path]:
    """Write the pages of one person, a page a session, or one of two sessions or conditions that are named."""
    from gaitdisc.clinic.read_people import before_and_after, cycles_of_people, read_session
    from gaitdisc.report.figure import file_names

    pages = _Pages(run, run_folder, pdf)
    if words:
        both = before_and_after(run, pages.reference, person, words)
        return pages.write(both, file_names([both.title])[both.title])
    people = cycles_of_people(run)
    own = {title: cycles for title, cycles in people.items() if cycles[0].subject == person}
    if not own:
        known = ", ".join(dict.fromkeys(cycles[0].subject for cycles in people.values())) or "nobody"
        raise SchemaError("a page needs a person of the run", f"{person!r}; there are {known}", "Name one of them.")
    names = file_names(list(people))
    found = []
    for title, cycles in own.items():
        found += pages.write(read_session(title, cycles, run.nominal, pages.reference), names[title])
    return found


class _Pages:
    """What all pages of a run's people are written with, and where."""

    def __init__(self, run: StudyRun, run_folder: Path, pdf: bool) -> None:
        self.report, self._provenance, self._pdf = run_folder / "report", run.provenance, pdf
        self.reference, self.say = load_kept_reference(run_folder), load_kept_words(run_folder)

    def write(self, person: PersonSession, name: str) -> list[Path]:
        """Write the page of a person and session as HTML and where wanted as PDF."""
        from gaitdisc.clinic.person_page import write_person_page

        page = write_person_page(person, name, self.reference, self._provenance, self.report, self.say)
        if not (self._pdf or self.say.laboratory.pdf):
            return [page]
        from gaitdisc.clinic.person_pdf import write_person_pdf

        return [page, write_person_pdf(person, self._provenance, page.with_suffix(".pdf"), self.say)]


def _with_failed(run: StudyRun, failed: list[Refusal], run_folder: Path) -> StudyRun:
    """Run with those refused whose pages failed; where the folder lies may name somebody, so that is taken out."""
    places = [str(run_folder.absolute()), *([str(run_folder)] if len(run_folder.parts) > 1 else [])]
    for place in places:
        failed = [replace(one, reason=one.reason.replace(place, "run")) for one in failed]
    return replace(run, refusals=(*run.refusals, *failed))
