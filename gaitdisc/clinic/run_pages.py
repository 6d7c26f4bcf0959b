"""Pages of a run: its own, those of its people, each apart, so that one who fails costs nobody else, and the index."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from importlib.util import find_spec
from pathlib import Path

from gaitdisc.clinic.clinical_reference import (
    FILE,
    PUBLISHED,
    ClinicalReference,
    PersonSession,
    load_reference,
    save_reference,
)
from gaitdisc.clinic.laboratory import Laboratory, load_laboratory
from gaitdisc.clinic.page_words import ENGLISH, english_words, read_words, write_words
from gaitdisc.clinic.person_page import NO_PDF, index_rows, write_index, write_person_page
from gaitdisc.clinic.reading import contrast, read_beside
from gaitdisc.errors import LOG, GaitdiscError, SchemaError, WriteError
from gaitdisc.own_files import file_sha256
from gaitdisc.processing.kept_parts import hash_content, keep_part, read_part
from gaitdisc.processing.pooled_cycles import CYCLES, PooledCycles
from gaitdisc.report.figure import file_names
from gaitdisc.report.saved_page import find_page
from gaitdisc.saved.kind import find_kind
from gaitdisc.saved.provenance import Refusal
from gaitdisc.saved.study_run import StudyRun
from gaitdisc.saved.unit_folder import seal_text
from gaitdisc.whole_file import remove_file, write_whole

REFERENCE = "reference"  # folder of a run, beside its cycles
WORDS = "words.csv"  # of another language, beside them
LABORATORY = "laboratory/laboratory.json"  # of a run: what its pages were drawn with


def keep_reference(place: Path | None, run_folder: Path) -> None:
    """Copy a reference into a run, so that its pages are drawn again without it."""
    if place is None:
        return
    folder = run_folder / REFERENCE
    source = place / FILE if place.is_dir() else place
    if (folder / FILE).is_file() and source.is_file() and file_sha256(source) == file_sha256(folder / FILE):
        return
    reference = load_reference(place)
    if reference.published:
        write_whole(folder / PUBLISHED, (place / PUBLISHED if place.is_dir() else place).read_text(encoding="utf-8"))
        remove_file(folder / FILE)
    else:
        save_reference(reference, folder)
        remove_file(folder / PUBLISHED)


def load_kept_reference(run_folder: Path) -> ClinicalReference | None:
    """Reference that was copied into a run; None where none was."""
    folder = run_folder / REFERENCE
    there = (folder / FILE).is_file() or (folder / PUBLISHED).is_file()
    return load_reference(folder) if there else None


def keep_words(language: str, run_folder: Path) -> list[str]:
    """Copy a table of words into a run, or take it away for `en`; gives the words that it lacks."""
    if language == "en":
        remove_file(run_folder / WORDS)
        return []
    words = read_words(Path(language))
    write_words(run_folder / WORDS, words)
    return [word for word in english_words() if not words.other.get(word)]


def page_of_run(run: StudyRun, run_folder: Path) -> Path:
    """Page of a run with pages of its people and their index, drawn where they are not those of this very run."""
    laboratory = load_laboratory(run_folder)
    if laboratory == Laboratory():
        remove_file(run_folder / LABORATORY)
    else:  # so that pages of another laboratory do not stand
        write_whole(run_folder / LABORATORY, seal_text(asdict(laboratory)))

    def draw() -> Path:
        page = find_kind(run_folder).draw(run, run_folder)
        write_people(run, run_folder)
        return page

    return find_page(run_folder, draw)


def write_people(
    run: StudyRun, run_folder: Path, pdf: bool = False, progress: Callable[[Path], None] = lambda _: None
) -> Path | None:
    """Write pages of each person and session, and `index.html`; None for a run without cycles."""
    if not run.of(CYCLES):
        return None
    pages, people = _Pages(run, run_folder, pdf), cycles_of_people(run)
    report, say = pages.report, pages.say
    names, house = file_names(list(people)), say.laboratory
    shared = repr(replace(say, laboratory=replace(house, affected={}, comments={})))
    files = sorted(path for path in (run_folder / REFERENCE).glob("*") if path.is_file())
    rests_on = (" ".join(map(file_sha256, files)), shared, run.nominal, str(pages.pdf))
    rows: list[dict[str, str]] = []
    failed: list[Refusal] = []
    for title, cycles in people.items():
        name = names[title]
        remarks = (repr(words.get(cycles[0].subject)) for words in (house.affected, house.comments))
        key = hash_content(cycles, *rests_on, *remarks)
        cached_rows = read_part(report, f"people-{name}", key)
        if cached_rows:
            rows += cached_rows
            continue
        try:
            person = read_session(title, cycles, run.nominal, pages.reference)
        except GaitdiscError as error:
            failed.append(Refusal(title, "", str(error)))
            continue
        try:
            written = pages.write(person, name)
            for page in written:
                progress(page)
            drawn = index_rows(person, name, say)
            files = [*written, *(report / "people" / name).glob("[!.]*.csv")]  # none that another process writes
            keep_part(report, f"people-{name}", key, drawn, files)
            rows += drawn
        except WriteError:  # of the disk, not of the person: the page would stand as one that cannot be written
            raise
        except (GaitdiscError, ArithmeticError, LookupError, ValueError, TypeError) as error:
            failed.append(Refusal(title, "", f"the page could not be written: {error}"))
    # where the folder lies may name somebody
    for place in [str(run_folder.absolute()), *([str(run_folder)] if len(run_folder.parts) > 1 else [])]:
        failed = [replace(refusal, reason=refusal.reason.replace(place, "run")) for refusal in failed]
    run = replace(run, refusals=(*run.refusals, *failed))
    return write_index(run, rows, pages.reference, report, say)


def write_person(
    run: StudyRun, run_folder: Path, person: str, words: tuple[str, ...] = (), pdf: bool = False
) -> list[Path]:
    """Write the pages of one person, a page a session, or one of two sessions or conditions that are named."""
    pages = _Pages(run, run_folder, pdf)
    if words:
        both = before_and_after(run, pages.reference, person, words)
        return pages.write(both, file_names([both.title])[both.title])
    people = cycles_of_people(run)
    sessions = {title: cycles for title, cycles in people.items() if cycles[0].subject == person}
    if not sessions:
        known = ", ".join(dict.fromkeys(cycles[0].subject for cycles in people.values())) or "nobody"
        raise SchemaError("the person must be in the run", f"{person!r} is not", f"Name one of: {known}.")
    names = file_names(list(people))
    paths = []
    for title, cycles in sessions.items():
        paths += pages.write(read_session(title, cycles, run.nominal, pages.reference), names[title])
    return paths


def cycles_of_people(run: StudyRun) -> dict[str, list[PooledCycles]]:
    """Cycles of every person and session by its title, in the order of the study."""
    people: dict[str, list[PooledCycles]] = {}
    for pooled in run.of(CYCLES):
        people.setdefault(f"{pooled.subject} {pooled.session}".strip(), []).append(pooled)
    return people


def read_session(
    title: str, cycles: Sequence[PooledCycles], nominal: str, reference: ClinicalReference | None
) -> PersonSession:
    """A session read: kept before refused, then the study's first condition, which each other one is compared with."""
    ordered = sorted(cycles, key=lambda pooled: (not len(pooled.kept), pooled.condition != nominal))
    main, *others = readings = tuple(read_beside(pooled, reference) for pooled in ordered)
    contrasts = tuple(contrast(main, other) for other in others if main.legs and other.legs)
    return PersonSession(title, readings, contrasts)


def before_and_after(
    run: StudyRun, reference: ClinicalReference | None, person: str, words: Sequence[str]
) -> PersonSession:
    """A person after and before, by the words of two sessions or conditions, of one condition or of one session."""
    cycles = [pooled for pooled in run.of(CYCLES) if pooled.subject == person]
    ordered = sorted(cycles, key=lambda pooled: pooled.condition != run.nominal)
    walks = [walk for walk in (read_beside(pooled, reference) for pooled in ordered) if walk.legs]
    if not walks:
        people = ", ".join(dict.fromkeys(pooled.subject for pooled in run.of(CYCLES)))
        raise SchemaError(
            "the person must have kept cycles in the run", f"{person!r} has none", f"Choose one of: {people}."
        )
    first, second = ([walk for walk in walks if word in (walk.pooled.session, walk.pooled.condition)] for word in words)
    pairs = [
        (a, b)
        for a, b in itertools.product(first, second)
        if (a.pooled.condition == b.pooled.condition) != (a.pooled.session == b.pooled.session)
    ]
    if not pairs:
        there = ", ".join(walk.pooled.where for walk in walks)
        raise SchemaError(
            f"{person} must have kept cycles of {words[0]!r} and {words[1]!r} in one condition or in one session",
            f"found {there}",
            "Name two of these sessions, or two of these conditions.",
        )
    before, after = pairs[0]
    return PersonSession(" ".join((person, *words)), (after, before), (contrast(before, after),))


class _Pages:
    """What all pages of a run's people are written with, and where."""

    def __init__(self, run: StudyRun, run_folder: Path, pdf: bool) -> None:
        self.report, self._provenance = run_folder / "report", run.provenance
        words = read_words(run_folder / WORDS) if (run_folder / WORDS).is_file() else ENGLISH
        self.reference = load_kept_reference(run_folder)
        self.say = replace(words, laboratory=load_laboratory(run_folder))
        self.pdf = pdf or self.say.laboratory.pdf
        if self.pdf and find_spec("typst") is None:
            if pdf:
                raise SchemaError(*NO_PDF)
            LOG.warning(f"Pages are written without PDF: {NO_PDF[0]}. {NO_PDF[2]}")
            self.pdf = False

    def write(self, person: PersonSession, name: str) -> list[Path]:
        """Write the page of a person and session as HTML and where wanted as PDF."""
        return write_person_page(person, name, self.reference, self._provenance, self.report, self.say, pdf=self.pdf)
