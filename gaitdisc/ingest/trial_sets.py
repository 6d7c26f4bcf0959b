"""Which trials of a participant are taken together, and who can be compared by models: one rule for check and run."""

import itertools
from contextlib import suppress
from dataclasses import dataclass

from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.ingest.study import FUNCTIONAL, STATIC, UNKNOWN, Participant, PlannedTrial, Study
from gaitdisc.regular_file import file_sha256

MOST_KG, MOST_M = 2.0, 0.03  # within a session: clothes and shoes; a shoe's sole, and a tape held twice
ALWAYS = (float("-inf"), float("inf"))  # [s]


@dataclass(frozen=True)
class TrialSet:
    """Walks of one participant in one session under one condition, of which cycles are pooled."""

    session: str  # word of the study; empty where there are no sessions
    condition: str  # word of the study
    trials: tuple[PlannedTrial, ...]

    @property
    def where(self) -> str:
        """Session and condition."""
        return " ".join(word for word in (self.session, self.condition) if word)


def is_calibration(study: Study, planned: PlannedTrial) -> bool:
    """Whether somebody stands in a trial or circles the legs about the hips, unless a way of walking has that word."""
    return planned.condition in {STATIC, FUNCTIONAL} - set(study.conditions.words)


def is_walk(study: Study, planned: PlannedTrial) -> bool:
    """Whether a trial is used as a walk."""
    return planned.condition != UNKNOWN and not is_calibration(study, planned)


def trial_sets(study: Study, participant: Participant) -> tuple[TrialSet, ...]:
    """Walks of a participant by session and condition, in the study's order of both."""
    sets = []
    for session in (None, *study.sessions):
        for word in study.conditions.words:
            trials = tuple(t for t in participant.trials_of(word) if t.session == session and is_walk(study, t))
            if trials:
                sets.append(TrialSet(session or "", word, trials))
    return tuple(sets)


def calibration_trial(study: Study, participant: Participant, session: str, word: str) -> PlannedTrial | None:
    """Trial of the session in which a participant stands (static) or circles the legs (functional), or the only one."""
    trials = [trial for trial in participant.trials if trial.condition == word and is_calibration(study, trial)]
    in_session = [trial for trial in trials if (trial.session or "") == session]
    return in_session[0] if in_session else trials[0] if len(trials) == 1 else None


def why_refused(study: Study, participant: Participant) -> str:
    """Why nothing of a participant is reported; empty where something is.

    Refused is who lacks a compared condition (unless the whole group does), shares a recording, or has two bodies.
    """
    if participant.excluded:
        return f"excluded in the study: {participant.excluded}"
    if mixed := report_shared_recording(study, participant) or differing_body(study, participant):
        return mixed
    device = study.conditions.device
    alike = [person for person in study.participants if person.group and person.group == participant.group]
    without_device = bool(alike) and not any(person.trials_of(device or "") for person in alike)
    if device is not None and not without_device:
        if participant.id in study.one_condition_only():
            return f"{_one_walk_each(study, participant)} Correct the conditions in [[participants.trials]]."
    elif not trial_sets(study, participant):
        words = " or ".join(map(repr, study.conditions.words))
        fault = f"{participant.id} has none (trials of other conditions: {len(participant.trials)})"
        return f"each person must have a trial of {words}; {fault}. Correct the conditions in [[participants.trials]]."
    return ""


def same_recording(study: Study, trial: PlannedTrial, other: PlannedTrial) -> bool:
    """Whether two trials use one stretch of files that have the same bytes."""
    (start, end), (later, last) = trial.crop_s or ALWAYS, other.crop_s or ALWAYS
    if trial.part != other.part or max(start, later) >= min(end, last):
        return False
    for pair in itertools.product(trial.files, other.files):
        first, second = map(study.path_of, pair)
        with suppress(OSError, GaitdiscError):  # reading says why
            if first.stat().st_size == second.stat().st_size and file_sha256(first) == file_sha256(second):
                return True
    return False


def report_shared_recording(study: Study, participant: Participant) -> str:
    """Say that a recording of a participant is also one of another participant, session or condition; or empty."""
    people = [person for person in study.participants if not person.excluded]
    used = [(person, t) for person in people for t in person.trials if t.condition != UNKNOWN and not t.leave_out]
    for planned, (other, trial) in itertools.product((t for person, t in used if person is participant), used):
        alike = other is participant and planned.condition == trial.condition  # counted once, or for two sessions
        if alike and (planned.session == trial.session or not is_walk(study, planned)):
            continue
        if same_recording(study, planned, trial):
            names = f"{participant.trial_name(planned)} and {other.trial_name(trial)}"
            reason = f"{names} are the same recording: their files have the same SHA-256. A recording must belong to "
            return f"{reason}one person, session and condition. Remove one of the two from [[participants.trials]]."
    return ""


def differing_body(study: Study, participant: Participant) -> str:
    """Say which measure differs between files of a session by more than one body does; the study's own go first."""
    stated: dict[tuple[str | None, str], dict[float, str]] = {}
    for trial in (t for t in participant.trials if t.condition != UNKNOWN and not t.leave_out):
        for file in trial.files:
            with suppress(OSError, GaitdiscError):  # reading says why
                body = read_body_measures(study.path_of(file))
                measures = {f"leg length ({side})": length for side, length in body.leg_length_m.items()}
                measures |= {"body mass": None if participant.mass_kg else body.mass_kg}
                measures |= {"stature": None if participant.height_m else body.height_m}
                for name, value in ((name, value) for name, value in measures.items() if value):
                    stated.setdefault((trial.session, name), {})[value] = participant.trial_name(trial)
    for (_, name), values in stated.items():
        low, high = min(values), max(values)
        most, unit = (MOST_KG, "kg") if name == "body mass" else (MOST_M, "m")
        if high - low > most:
            reason = f"{name} is {low:.4g} {unit} in {values[low]} and {high:.4g} {unit} in {values[high]}; files of "
            reason += f"one person and session may differ by at most {most:g} {unit}"
            return f"{reason}. Give each person or session its own files, or correct the value."
    return ""


def not_compared(study: Study, participant: Participant, pooled: bool = False) -> str:
    """Why two walks of a participant, or their pooled trials, cannot be compared by models; empty where they can."""
    if study.conditions.device is None:
        return "the study does not compare a device"
    walks = [trial for trial in participant.trials if is_walk(study, trial)]
    both = study.conditions.both
    counts = [sum(not (pooled and trial.leave_out) for trial in participant.trials_of(word)) for word in both]
    complete = all(counts) if pooled else counts == [1, 1]
    if complete and len({trial.session for trial in walks if trial.condition in both}) == 1:
        return ""
    return _one_walk_each(study, participant)


def _one_walk_each(study: Study, participant: Participant) -> str:
    both = study.conditions.both
    counts = {word: len(participant.trials_of(word)) for word in both}
    counted = ", ".join(f"{count or 'none'} of {word!r}" for word, count in counts.items())
    others = sum(trial.condition not in both for trial in participant.trials)
    unused = f"; trials of other conditions: {others}" if others else ""
    needed = f"a comparison requires one trial of {both[0]!r} and one of {both[1]!r}"
    return f"{needed}; {participant.id} has {counted}{unused}."
