"""A first draft of a study from a folder of recordings, with everything said that had to be guessed."""

import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gaitdisc.channel import vocabulary
from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.c3d import C3DReader, glance_at_c3d
from gaitdisc.ingest.people_table import (
    PLAIN,
    PSEUDONYM,
    WORDS,
    Measured,
    condition_word,
    group_word,
    is_people_table,
    kind_of_trial,
    person_key,
    person_word,
    read_people,
    session_word,
    walk_key,
    walk_place,
    walk_word,
)
from gaitdisc.ingest.reading import ENDINGS, read_trial
from gaitdisc.ingest.study import FUNCTIONAL, STATIC, UNKNOWN, Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_settings import ANGLES, OUTPUTS, Models
from gaitdisc.own_files import KINDS, LIST
from gaitdisc.recording import Recording, Trial

OURS = ("", ".toml", ".toml-held")  # endings of no recording: none, a study file's and its lock's
CONSTANT_DEG = 1e-6  # range below which an angle does not vary
STILL_M, STILL_DEG = 0.05, 8.0  # who stands sways by some centimetres


@dataclass(frozen=True)
class FoundTrial:
    """Files of one walk, found in a folder."""

    files: tuple[Path, ...]  # relative to the folder that was searched
    person: str  # word of the path that names the person, or empty
    group: str  # words of the path that name the person's group, or empty
    session: str  # what the session is put in order by, or empty
    word: str  # what names the condition
    which: str  # `nominal`, `device`, `static`, `functional`, `other` (no walk) or empty
    angles: tuple[str, ...] | None  # joint angles; None where the files hold no such stream, as of the next two
    varying: tuple[str, ...] | None
    emg: tuple[str, ...] | None

    @property
    def walked(self) -> bool:
        """Whether it is taken as a walk."""
        return self.which not in (STATIC, FUNCTIONAL, "other")


Who = tuple[str, str]  # group and word of a person: controls/Smith and patients/Smith are two
Stamp = tuple[tuple[str, int, int], ...]  # name, size and time of the files of one walk
Looked = dict[Stamp, tuple["FoundTrial | None", list[str]]]  # what was read of it, and what was said


def draft_study(
    folder: Path | str,
    home: Path | str | None = None,
    files: Sequence[Path] | None = None,
    looked: Looked | None = None,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> tuple[Study, list[str]]:
    """Draft of a study from a folder of recordings.

    Participants are known by sub-folders or by parts of names such as `S01`, sessions by words such as `pre` and `post`
    or by dates, conditions by words such as `natural` and `exo`, or `straight` and `turn`, or by sub-folders of a
    person; a static trial by its name, or because nobody moves in it. Files of one stem are one trial. The angles are
    those of section 4.2.2 that every walk has and that vary.

    home: folder in which the study file will lie; its paths are relative to it. The same folder by default
    files: only these, relative to the folder
    looked: what was read before of files that are as they were; is added to
    progress: called with the number of the trial that is read, and of all
    returns study: a draft that can be run as it is; trials whose condition no name shows are 'unknown' and not used
    returns notes: what was guessed, left out or could not be read
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise ReadError(f"{folder.name} must be a folder", "it does not exist, or is a file", "Correct the path.")
    notes: list[str] = []
    if files is None:
        files = recording_files(folder)
        endings = Counter(path.suffix.lower() for path in list_files(folder))
        unread = [f"{count} {ending}" for ending, count in sorted(endings.items()) if ending not in (*ENDINGS, *OURS)]
        _note(notes, "files not read because of their ending: ", unread)
    tables = [path for path in files if is_people_table(path)]
    measured = read_people(folder, tables, notes)
    others = [path for path in files if path not in tables]
    trials = _read_drafts(folder, others, notes, {} if looked is None else looked, progress)
    if not trials:
        left_out = f"; {notes[-1].removesuffix('.')}" if notes else ""
        raise ReadError(
            f"{folder.name} must contain recordings (files that end in {', '.join(ENDINGS)})",
            f"none of its files can be read{left_out}",
            "Name the folder that contains the recordings.",
        )
    groups: dict[str, set[str]] = {}
    for trial in trials:
        groups.setdefault(trial.person, set()).update({trial.group} - {""})
    alone = {person: next(iter(named)) for person, named in groups.items() if len(named) == 1}
    trials = [replace(trial, group=trial.group or alone.get(trial.person, "")) for trial in trials]  # the only one
    conditions, called = name_conditions(trials, notes)
    sessions = _sessions(trials)
    home = Path(home) if home is not None else folder
    way = Path(os.path.relpath(folder.resolve(), home.resolve()))
    people = _people(trials, notes)
    bodies = _bodies(people, measured, tables, notes)
    participants = tuple(
        Participant(
            id=pseudonym,
            group=who[0],
            **vars(bodies[who]),
            trials=tuple(
                PlannedTrial(
                    condition=called[trial.word],
                    session=sessions.get((who, trial.session)),
                    files=tuple((way / file).as_posix() for file in trial.files),
                )
                for trial in trials
                if (trial.group, trial.person) == who
            ),
        )
        for who, pseudonym in people.items()
    )
    words = tuple(dict.fromkeys(sessions.values()))
    title = " against ".join(conditions.words) if conditions.device else ", ".join(conditions.words)
    walks = [trial for trial in trials if trial.walked] or trials
    study = Study(
        title=title, sessions=words, conditions=conditions, models=_models(walks, notes), participants=participants
    ).placed(home)
    _note(notes, "channels of one condition only, which are not compared: ", study.one_condition_only())
    return study, notes


def _note(notes: list[str], before: str, names: Iterable[str], after: str = "") -> None:
    """Add a note about names, if there are any."""
    listed = ", ".join(names)
    if listed:
        notes.append(f"{before}{listed}{after}")


def recording_files(folder: Path) -> list[Path]:
    """Files of a folder that a recording may be, relative to it."""
    return sorted(path for path in list_files(folder) if path.suffix.lower() in ENDINGS)


def list_files(folder: Path) -> Iterator[Path]:
    """List files of a folder, relative to it, that are not hidden and not in a run of a study."""
    paths = list(folder.rglob("*"))
    runs = {path.parent for path in paths if path.name == LIST and (path.parent / KINDS[0]).is_file()} - {folder}
    for path in paths:
        inside = path.relative_to(folder)
        if path.is_file() and runs.isdisjoint(path.parents) and not any(p.startswith(".") for p in inside.parts):
            yield inside


def _bodies(
    people: Mapping[Who, str], measured: Mapping[str, Measured], tables: Sequence[Path], notes: list[str]
) -> dict[Who, Measured]:
    """Mass, sex, stature and age of each person, and what no table has or has too many of."""
    named = Counter(person_key(word) for _, word in people)
    keys = {who: person_key(who[1]) for who in people}
    files = ", ".join(table.as_posix() for table in tables)
    absent = [people[who] for who, key in keys.items() if measured and (key not in measured or named[key] > 1)]
    _note(notes, f"not in {files}: ", absent)
    bodies = {who: measured.get(key, Measured()) if named[key] == 1 else Measured() for who, key in keys.items()}
    counts = {
        what: sum(bool(getattr(body, name)) for body in bodies.values())
        for name, what in (("mass_kg", "body mass"), ("sex", "sex"), ("height_m", "stature"), ("age_years", "age"))
    }
    stated = [f"{what} {count} of {len(bodies)}" for what, count in counts.items() if count]
    _note(notes, "", stated, f" people from {files}")
    return bodies


def _read_drafts(
    folder: Path,
    files: Sequence[Path],
    notes: list[str],
    looked: Looked,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> list[FoundTrial]:
    """Every walk, read one after the other; what a draft needs of it is kept, its samples are not."""
    drafts, groups = [], _walks(files)
    with C3DReader() as reader:
        for number, group in enumerate(groups, 1):
            progress(number, len(groups))
            stamp = tuple((file.as_posix(), *read_stamp(folder / file)) for file in group)
            if stamp not in looked:
                added: list[str] = []
                read, trial = _readable(folder, group, reader, added)
                looked[stamp] = (_describe_trial(tuple(read), trial) if trial is not None else None, added)
            described, added = looked[stamp]
            drafts += [described] if described is not None else []
            notes += added
    for kind, words in (
        (STATIC, f"standing trials, assigned the condition {STATIC!r}: "),
        (FUNCTIONAL, f"trials of circling legs, according to the file names, assigned the condition {FUNCTIONAL!r}: "),
    ):
        _note(notes, words, (draft.files[0].as_posix() for draft in drafts if draft.which == kind))
    order = ("nominal", "device", "", STATIC, FUNCTIONAL, "other")
    return sorted(drafts, key=lambda draft: order.index(draft.which))


def read_stamp(path: Path) -> tuple[int, int]:
    """Size and time of a file; zero of one that is not there."""
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_size, status.st_mtime_ns


def _describe_trial(files: tuple[Path, ...], trial: Trial) -> FoundTrial:
    word, which = condition_word(files[0])
    kind = kind_of_trial(files[0]) or (STATIC if not which and stands(trial) else "")
    if kind:
        word, which = kind, kind
    elif not which:
        word = walk_word(files[0])
    kinematics, emg = trial.streams.get("kinematics"), trial.streams.get("emg")
    angles = kinematics and tuple(channel.name for channel in kinematics.channels if channel.quantity == "angle")
    return FoundTrial(
        files,
        person=person_word(files[0]),
        group=group_word(files[0]),
        session=session_word(files[0])[1],
        word=word,
        which=which,
        angles=angles,
        varying=kinematics and tuple(name for name in angles or () if _varies(kinematics, name)),
        emg=emg and emg.names,
    )


def stands(trial: Trial) -> bool:
    """Whether half of the markers, or else hips and knees, stay still (5 cm); contacts of both feet show a walk."""
    if {event.side for event in trial.events if event.label == "initial contact"} >= {"l", "r"}:
        return False
    if "markers" in trial.streams:
        markers, limit = trial.stream("markers"), STILL_M
    elif "kinematics" in trial.streams:
        legs = trial.stream("kinematics").selected_by(lambda c: c.name.startswith(("hip_flexion", "knee_angle")))
        markers, limit = legs, STILL_DEG
    else:
        return False
    seen = np.isfinite(markers.values).any(axis=0) & np.any(np.nan_to_num(markers.values), axis=0)
    ranges: dict[str, float] = {}
    for name, column in zip(np.array(markers.names)[seen], markers.values.T[seen], strict=True):
        marker = name.rpartition(".")[0] or name  # a marker moves as far as along the axis on which it moves farthest
        ranges[marker] = max(ranges.get(marker, 0.0), float(np.nanmax(column) - np.nanmin(column)))
    return bool(ranges) and float(np.median([*ranges.values()])) < limit


def _readable(
    folder: Path, group: Sequence[Path], reader: C3DReader, notes: list[str]
) -> tuple[list[Path], Trial | None]:
    """The walk and its files, without those that cannot be read or that do not go with the others."""
    try:
        if [file.suffix.lower() for file in group] == [".c3d"]:
            return list(group), glance_at_c3d(folder / group[0])
        return list(group), read_trial([folder / file for file in group], reader=reader)
    except GaitdiscError:
        read: list[Path] = []
        trial = None
        for file in group:
            try:
                trial = read_trial([folder / path for path in (*read, file)], reader=reader)
                read.append(file)
            except GaitdiscError as error:
                notes.append(f"left out: {file.as_posix()}: {error}")
        return read, trial


def _walks(files: Sequence[Path]) -> list[list[Path]]:
    """Files grouped by walk: one folder and one name but for the words that name the kind."""
    groups: dict[tuple[Path, str], list[Path]] = {}
    for file in files:
        groups.setdefault((Path(*walk_place(file)), walk_key(file)), []).append(file)
    for parent, key in [place for place in groups if place[1] == ""]:
        others = [place for place in groups if place[0] == parent and place[1]]
        if len(others) == 1:  # `coordinates.sto` beside `grf_walk.mot` and `id_walk.sto`
            groups[others[0]] = sorted(groups.pop((parent, key)) + groups[others[0]])
    return list(groups.values())


def name_conditions(trials: Sequence[FoundTrial], notes: list[str]) -> tuple[Conditions, dict[str, str]]:
    """Conditions of a draft, and the condition of each word that was found."""
    walks = [trial for trial in trials if trial.walked]
    recognised: dict[str, str] = {}
    for which in ("nominal", "device"):
        there = list(dict.fromkeys(trial.word for trial in walks if trial.which == which))
        recognised |= {which: there[0]} if there else {}
        if len(there) > 1:
            notes.append(f"the conditions {', '.join(there)} are all read as {recognised[which]!r}")
    counts = Counter(trial.word for trial in walks if not trial.which and trial.word)
    others = sorted(counts, key=lambda word: (-counts[word], word))
    if not recognised and set(others) <= {PLAIN}:
        others = [PLAIN]
        notes.append(f"no file or folder name shows a condition, so every walk is set to {PLAIN!r}")
    words = list(dict.fromkeys([*recognised.values(), *others]))
    _note(
        notes,
        "conditions named after folders: ",
        (word for word in others if word not in (*WORDS["way of walking"], PLAIN)),
        ". They are shown on every page; change any that identifies a person",
    )
    device = recognised.get("device") if len(words) > 1 else None
    reference = next(word for word in words if word != device)
    rest = tuple(word for word in words if word not in (reference, device))
    called = {trial.word: recognised.get(trial.which, trial.word) for trial in walks}
    called[""] = PLAIN if others == [PLAIN] else UNKNOWN
    called |= {STATIC: STATIC, FUNCTIONAL: FUNCTIONAL, "other": UNKNOWN}
    _note(
        notes,
        "trials of unknown condition, which are listed but not used: ",
        (trial.files[0].as_posix() for trial in trials if called[trial.word] == UNKNOWN),
        f'. To set the condition of all of them, write in [conditions]: unnamed = "{reference}"',
    )
    return Conditions(nominal=reference, device=device, others=rest), called


def _sessions(trials: Sequence[FoundTrial]) -> dict[tuple[Who, str], str]:
    """Session of each person and place in order; a date becomes its number, since dates show who a person is."""
    words = {trial.session: session_word(trial.files[0])[0] for trial in trials if trial.session}
    if not words:
        return {}
    sessions: dict[tuple[Who, str], str] = {}
    for who in {(trial.group, trial.person) for trial in trials}:
        orders = sorted({trial.session for trial in trials if (trial.group, trial.person) == who and trial.session})
        dated = [order for order in orders if not words[order]]
        sessions |= {(who, order): words[order] or f"session {dated.index(order) + 1}" for order in orders}
    order = {word: place for (_, place), word in sessions.items()}
    return dict(sorted(sessions.items(), key=lambda item: (item[1].startswith("session"), order[item[1]])))


def _people(trials: Sequence[FoundTrial], notes: list[str]) -> dict[Who, str]:
    """Group and word of each person -> pseudonym."""
    people = sorted({(trial.group, trial.person) for trial in trials}, key=lambda who: (who[1], who[0]))
    named = Counter(word.lower() for _, word in people)
    taken = {word for _, word in people if PSEUDONYM.fullmatch(word) and named[word.lower()] == 1}
    free = (f"P{number:02d}" for number in range(1, 10_000) if f"P{number:02d}" not in taken)
    ids = {who: who[1] if who[1] in taken else next(free) for who in people}
    renamed = [new for (_, old), new in ids.items() if old and old != new]
    _note(notes, "folder names that are not pseudonyms were replaced by ", renamed, "; paths still contain them")
    twice = [f"{new} ({group or 'no group'})" for (group, old), new in ids.items() if named[old.lower()] > 1]
    _note(notes, "names that occur in several groups, taken as different people: ", twice)
    unchanged = [word for _, word in people if word in taken]
    _note(notes, "names used unchanged as pseudonyms: ", unchanged, "; change any that identifies a person")
    nobody = [new for (_, old), new in ids.items() if not old]
    _note(notes, "files whose path names no person were assigned to ", nobody)
    return ids


def _models(trials: Sequence[FoundTrial], notes: list[str]) -> Models:
    varying = [trial.varying for trial in trials if trial.varying is not None]
    if not varying:
        notes.append("no file contains joint angles; the draft names the usual angles, which are computed from markers")
        return Models()
    first = next(trial.angles for trial in trials if trial.angles is not None)
    shared = [name for name in varying[0] if all(name in names for names in varying)]
    _note(notes, "angles excluded because they are constant or copies: ", sorted(set(first) - set(varying[0])))
    angles = tuple(name for name in ANGLES if name in shared) or tuple(shared)
    absent = [name for name in ANGLES if name not in shared]
    _note(notes, "varying angles excluded because some trials do not have them: ", absent)
    more = [name for name in shared if name not in angles]
    named = [name for name in more if name in vocabulary().by_name]
    others = [f"{len(more) - len(named)} from the files"] if len(more) > len(named) else []
    _note(notes, "angles that the response models do not use (add them to [models] if needed): ", [*named, *others])
    if not angles:
        notes.append("the trials share no joint angle that varies; the draft names the usual angles")
        return Models()
    outputs = tuple(name for name in OUTPUTS if name in angles) or angles[:1]
    emg = _find_shared_emg(trials, notes)
    of_side = tuple(
        name for name in emg if name.split("_")[1][:3] in ("ham", "rf", "vas", "gas", "sol") and name.endswith("_r")
    )
    return Models(angles=angles, emg=emg, outputs=(*outputs, *of_side))


def _varies(recording: Recording, name: str) -> bool:
    column = recording[name][np.isfinite(recording[name])]
    return bool(column.size and np.ptp(column) > CONSTANT_DEG and not name.endswith("_beta"))


def _find_shared_emg(trials: Sequence[FoundTrial], notes: list[str]) -> tuple[str, ...]:
    streams = [trial.emg for trial in trials if trial.emg is not None]
    if not streams:
        return ()
    if len(streams) < len(trials):
        notes.append(f"EMG is not among the inputs; trials with EMG: {len(streams)} of {len(trials)}")
        return ()
    known = vocabulary().by_name
    shared = tuple(n for n in streams[0] if all(n in other for other in streams) and n in known)
    notes.append(f"EMG among the inputs: {', '.join(shared) or 'none with a known name; map the labels in [channels]'}")
    return shared
