"""A first draft of a study from a folder of recordings, with everything said that had to be guessed."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaitdisc.channel import vocabulary
from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.file_names import PSEUDONYM, condition_word, person_word, walk_key
from gaitdisc.ingest.reading import ENDINGS, read_trial
from gaitdisc.ingest.study import ANGLES, OUTPUTS, UNKNOWN, Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.recording import Recording, Trial

if TYPE_CHECKING:
    from gaitdisc.ingest.c3d import C3DReader

CONSTANT_DEG = 1e-6  # range below which an angle does not vary


@dataclass(frozen=True)
class FoundTrial:
    """Files of one walk, found in a folder.

    Parameters
    ----------
    files : tuple of Path
        Relative to the folder that was searched.
    person : str
        Word of the path that tells the person, or empty.
    word, which : str
        Word that tells the condition, and `nominal`, `device` or empty.
    trial : Trial
        As read.
    """

    files: tuple[Path, ...]
    person: str
    word: str
    which: str
    trial: Trial


def found_study(folder: Path | str, home: Path | str | None = None) -> tuple[Study, list[str]]:
    """Draft of a study from a folder of recordings.

    Participants are told by sub-folders or by parts of names such as `S01`, conditions by words such as `natural` and
    `exo`. The angles are those of section 4.2.2 that every trial has and that vary.

    Parameters
    ----------
    folder : Path or str
        Where the recordings lie; sub-folders are searched.
    home : Path or str, optional
        Folder in which the study file will lie; its paths are relative to it. The same folder by default.

    Returns
    -------
    study : Study
        A draft that can be run as it is where both conditions were told.
    notes : list of str
        What was guessed, left out or could not be read.

    Raises
    ------
    ReadError
        If there is no such folder, or no file in it that can be read.

    Examples
    --------
    >>> study, notes = found_study("recordings")  # doctest: +SKIP
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise ReadError(
            f"a folder of recordings is needed, {folder.name} is none", "it is absent or a file", "Name it."
        )
    notes: list[str] = []
    found = _found_trials(folder, notes)
    if not found:
        unread = f"; {notes[0]}" if notes else ""
        raise ReadError(
            f"recordings are needed in {folder.name}: files that end in {', '.join(ENDINGS)}",
            f"none there can be read{unread}",
            "Name the folder that holds them.",
        )
    conditions = _conditions(found, notes)
    home = Path(home) if home is not None else folder
    participants = _participants(found, conditions, Path(os.path.relpath(folder.resolve(), home.resolve())), notes)
    title = f"{conditions.nominal} against {conditions.device}"
    models = _models(found, notes)
    study = Study(title=title, conditions=conditions, models=models, participants=participants).placed(home)
    lacking = study.one_condition_only()
    if lacking:
        notes.append(f"one condition only, so not compared: {', '.join(lacking)}")
    return study, notes


def _found_trials(folder: Path, notes: list[str]) -> list[FoundTrial]:
    from gaitdisc.ingest.c3d import C3DReader

    inside = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    files = sorted(
        path for path in inside if path.suffix.lower() in ENDINGS and not any(p.startswith(".") for p in path.parts)
    )
    found = []
    with C3DReader() as reader:
        for group in _walks(files):
            read, trial = _readable(folder, group, reader, notes)
            if trial is not None:
                word, which = condition_word(group[0])
                found.append(FoundTrial(tuple(read), person_word(group[0]), word, which, trial))
    return sorted(found, key=lambda each: ("nominal", "device", "").index(each.which))


def _readable(
    folder: Path, group: Sequence[Path], reader: C3DReader, notes: list[str]
) -> tuple[list[Path], Trial | None]:
    """The walk and its files, without those that cannot be read or that do not go with the others."""
    try:
        return list(group), read_trial([folder / file for file in group], reader=reader)
    except GaitdiscError:
        read: list[Path] = []
        trial = None
        for file in group:
            try:
                trial = read_trial([folder / each for each in (*read, file)], reader=reader)
                read.append(file)
            except GaitdiscError as error:
                notes.append(f"left out: {file.as_posix()}: {error}")
        return read, trial


def _walks(files: Sequence[Path]) -> list[list[Path]]:
    """Files grouped by walk: one folder and one name but for the words that tell the kind; never two of one kind."""
    groups: dict[tuple[Path, str], list[Path]] = {}
    for file in files:
        groups.setdefault((file.parent, walk_key(file)), []).append(file)
    for parent, key in [place for place in groups if place[1] == ""]:
        others = [place for place in groups if place[0] == parent and place[1]]
        if len(others) == 1:  # `coordinates.sto` beside `grf_walk.mot` and `id_walk.sto`
            groups[others[0]] = sorted(groups.pop((parent, key)) + groups[others[0]])
    return list(groups.values())


def _conditions(found: Sequence[FoundTrial], notes: list[str]) -> Conditions:
    words = {}
    for which, usual in (("nominal", "nominal"), ("device", "exo")):
        there = list(dict.fromkeys(trial.word for trial in found if trial.which == which))
        words[which] = there[0] if there else usual
        if len(there) > 1:
            notes.append(f"{', '.join(there)} are all taken as {words[which]!r}")
        elif not there:
            notes.append(
                f"no file or folder name shows a trial of condition {usual!r}; write it where it says 'unknown'"
            )
    unnamed = [trial.files[0].as_posix() for trial in found if not trial.which]
    if unnamed:
        notes.append(f"condition unknown, listed but not used: {', '.join(unnamed)}")
    return Conditions(**words)


def _participants(
    found: Sequence[FoundTrial], conditions: Conditions, way: Path, notes: list[str]
) -> tuple[Participant, ...]:
    people = sorted({trial.person for trial in found})
    taken = {person for person in people if PSEUDONYM.fullmatch(person)}
    free = (f"P{number:02d}" for number in range(1, 1000) if f"P{number:02d}" not in taken)
    ids = {person: person if person in taken else next(free) for person in people}
    renamed = [new for old, new in ids.items() if old and old != new]
    if renamed:
        notes.append(f"folder names that are no pseudonyms became {', '.join(renamed)}; the paths still hold them")
    kept = [person for person in people if person in taken]
    if kept:
        notes.append(f"taken as pseudonyms as they are: {', '.join(kept)}; change any that shows who a person is")
    if "" in ids:
        notes.append(f"files whose path names no person were put under {ids['']}")
    words = {"nominal": conditions.nominal, "device": conditions.device, "": UNKNOWN}
    return tuple(
        Participant(
            id=ids[person],
            trials=tuple(
                PlannedTrial(condition=words[t.which], files=tuple((way / file).as_posix() for file in t.files))
                for t in found
                if t.person == person
            ),
        )
        for person in people
    )


def _models(found: Sequence[FoundTrial], notes: list[str]) -> Models:
    kinematics = [trial.trial.streams["kinematics"] for trial in found if "kinematics" in trial.trial.streams]
    if not kinematics:
        notes.append("no file holds joint angles: the draft names the usual ones; compute inverse kinematics first")
        return Models()
    varying = [_varying_angles(recording) for recording in kinematics]
    shared = [name for name in varying[0] if all(name in names for names in varying)]
    constant = sorted(set(_angle_names(kinematics[0])) - set(varying[0]))
    if constant:
        notes.append(f"left out because they are constant or copies: {', '.join(constant)}")
    angles = tuple(name for name in ANGLES if name in shared) or tuple(shared)
    absent = [name for name in ANGLES if name not in shared]
    if absent:
        notes.append(f"left out because not every trial has them, varying: {', '.join(absent)}")
    more = [name for name in shared if name not in angles]
    if more:
        notes.append(f"not among the inputs of section 4.2.2, add them to angles if wanted: {', '.join(more)}")
    outputs = tuple(name for name in OUTPUTS if name in angles)
    if not angles:
        notes.append("the trials share no joint angle that varies: the draft names the usual ones")
        return Models()
    emg = _shared_emg(found, notes)
    of_side = tuple(
        name for name in emg if name.split("_")[1][:3] in ("ham", "rf", "vas", "gas", "sol") and name.endswith("_r")
    )
    return Models(angles=angles, emg=emg, outputs=(*(outputs or angles[:1]), *of_side))


def _angle_names(recording: Recording) -> list[str]:
    return [channel.name for channel in recording.channels if channel.quantity == "angle"]


def _varying_angles(recording: Recording) -> list[str]:
    names = []
    for name in _angle_names(recording):
        column = recording[name][np.isfinite(recording[name])]
        if column.size and np.ptp(column) > CONSTANT_DEG and not name.endswith("_beta"):
            names.append(name)
    return names


def _shared_emg(found: Sequence[FoundTrial], notes: list[str]) -> tuple[str, ...]:
    streams = [trial.trial.streams["emg"] for trial in found if "emg" in trial.trial.streams]
    if not streams:
        return ()
    if len(streams) < len(found):
        notes.append(f"EMG in {len(streams)} of {len(found)} trials only, so it is not among the inputs")
        return ()
    known = {channel.name for channel in vocabulary().channels}
    shared = tuple(n for n in streams[0].names if all(n in other.names for other in streams) and n in known)
    notes.append(f"EMG among the inputs: {', '.join(shared) or 'none by a known name; map the labels in [channels]'}")
    return shared
