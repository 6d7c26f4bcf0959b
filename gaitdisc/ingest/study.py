"""The study: who walked, in which sessions, under which conditions, in which files, and every setting."""

import re
from collections import Counter
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, PrivateAttr, model_validator

from gaitdisc.channel import did_you_mean
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study_settings import (
    Filters,
    HeldOut,
    Kinematics,
    Models,
    Positive,
    Quality,
    StrideRules,
    StudyPart,
    Treadmill,
    Word,
    check_channels,
    check_variables,
    refuse,
)
from gaitdisc.recording.trial import AGE_YEARS, LENGTHS_M, MASS_KG

MEASURES = ("mass_kg", "height_m", "sex", "age_years")  # of a person, in tables of people too
UNKNOWN = "unknown"  # condition of a trial that is listed but not used
STATIC = "static"  # condition of a trial in which the person stands
FUNCTIONAL = "functional"  # condition of a trial in which the legs are circled about the hips
_DATE = re.compile(r"(?<!\d)(?:\d{1,4}[-_./ ]\d{1,2}[-_./ ]\d{1,4}|\d{6}|\d{8}|(?:19|20)\d{2})(?!\d)")

LEFT_OUT_CYCLE = re.compile(r"(l|r)(?:eft|ight)? (\d+(?:\.\d+)?)(?: s)?[,:]?(?: (.+))?")
FileName = Annotated[str, Field(min_length=1)]
Pseudonym = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,16}$")]


class Conditions(StudyPart):
    """The conditions, in the laboratory's own words."""

    nominal: Word = Field(
        description="the reference condition (without the device, or with a passive device), or the only condition"
    )
    device: Word | None = Field(
        default=None, description="the condition with the device, which models compare with the reference"
    )
    others: tuple[Word, ...] = Field(default=(), description="further conditions, whose cycles are pooled")
    unnamed: Word | None = Field(
        default=None,
        description="condition of the trials marked 'unknown', one of the words above; if empty, they are not used",
    )

    @property
    def words(self) -> tuple[str, ...]:
        """Every condition: the reference, the device where there is one, then the others."""
        return (self.nominal, *((self.device,) if self.device else ()), *self.others)

    @property
    def both(self) -> tuple[str, str]:
        """Nominal, then device; a SchemaError where the study has no device."""
        if self.device is None:
            raise SchemaError(
                "a comparison by models must have two conditions in [conditions], nominal and device",
                f"the study has {', '.join(map(repr, self.words))}, but no device",
                "Add device to [conditions], or look at the pooled cycles of `gaitdisc run`.",
            )
        return self.nominal, self.device


class PlannedTrial(StudyPart):
    """One walk: the files that hold it, and what the files do not say."""

    condition: Word = Field(
        description="a word of [conditions], 'static' (standing), 'functional' (circling legs), or 'unknown' (not used)"
    )
    session: Word | None = Field(default=None, description="a word of sessions, never a date")
    files: tuple[FileName, ...] = Field(min_length=1, description="files of this walk, relative to the study file")
    part: Annotated[str, Field(max_length=40)] = Field(
        default="",
        description="trial in a .mat or .npz file with several trials: its number, or the text for * in [channels]",
    )
    speed_m_per_s: Positive | None = Field(default=None, description="walking speed of this trial [m/s]")
    crop_s: tuple[float, float] | None = Field(
        default=None, description="start and end of the part to use, on the file's clock [s]"
    )

    leave_out: str = Field(default="", description="reason why this trial is left out; the pages show this reason")
    leave_out_cycles: tuple[str, ...] = Field(
        default=(), description='cycles that are left out: side, start [s] and reason, such as "left 2.31 stumbled"'
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        for i, cycle in enumerate(self.leave_out_cycles):
            if not LEFT_OUT_CYCLE.fullmatch(cycle):
                remedy = 'Write for example "left 2.31 stumbled"; cycles.csv lists start_s of each cycle.'
                refuse(("leave_out_cycles", i), "give a side and a start [s]", f"found {cycle!r}", remedy)
        if self.crop_s and self.crop_s[0] >= self.crop_s[1]:
            refuse(("crop_s",), "have a start before its end", f"found {list(self.crop_s)}", "Write [start, end] in s.")
        return self


class Participant(StudyPart):
    """A person, known by a pseudonym only."""

    id: Pseudonym = Field(description="pseudonym: letters, digits, _ and -, at most 16")
    excluded: str = Field(
        default="", description="reason why this person is excluded from the statistics; empty otherwise"
    )
    group: Annotated[str, Field(max_length=40)] = Field(
        default="", description="group of this person, such as control; empty without groups"
    )
    mass_kg: Annotated[float, Field(ge=MASS_KG.least, le=MASS_KG.most)] | None = Field(
        default=None, description="body mass [kg], if the C3D files state no mass or a wrong one"
    )
    height_m: Annotated[float, Field(ge=LENGTHS_M["height_m"].least, le=LENGTHS_M["height_m"].most)] | None = Field(
        default=None, description="stature [m], if the C3D files state no stature or a wrong one"
    )
    sex: Literal["", "f", "m"] = Field(
        default="", description="f or m, for the inertia of the segments; if empty, the mean of women and men is used"
    )
    age_years: Annotated[int, Field(ge=AGE_YEARS.least, le=AGE_YEARS.most)] | None = Field(
        default=None, description="age in whole years, to choose controls of similar age; never a date of birth"
    )
    trials: tuple[PlannedTrial, ...] = Field(default=(), description="the walks of this person")

    def trials_of(self, condition: str) -> tuple[PlannedTrial, ...]:
        """Return the trials of one of the study's conditions."""
        return tuple(trial for trial in self.trials if trial.condition == condition)

    def trial_name(self, planned: PlannedTrial) -> str:
        """Name of one trial: pseudonym, session, condition, and a number where there are several.

        >>> walk, again = (PlannedTrial(condition="barefoot", files=(f"{n}.c3d",)) for n in "ab")
        >>> Participant(id="P01", trials=(walk, again)).trial_name(again)
        'P01 barefoot 2'
        """
        alike = [trial for trial in self.trials_of(planned.condition) if trial.session == planned.session]
        number = str(alike.index(planned) + 1) if len(alike) > 1 else ""
        return " ".join(part for part in (self.id, planned.session or "", planned.condition, number) if part)


class Study(StudyPart):
    """A study; frozen, with every default of the dissertation.

    >>> study = Study(conditions=Conditions(nominal="natural", device="exo"), participants=(Participant(id="P01"),))
    >>> study.filters.kinematics_hz, study.models.seed, study.one_condition_only()
    (6.0, 0, ('P01',))
    """

    model_config = ConfigDict(json_schema_extra={"description": "A study file of gaitdisc."})

    title: str = Field(default="", description="title of the study in reports")
    sessions: tuple[Word, ...] = Field(
        default=(), description="sessions in the order of their dates, such as before and after; no dates"
    )
    conditions: Conditions
    treadmill: Treadmill | None = None
    channels: dict[str, str] = Field(
        default_factory=dict,
        description='label in a file = "channel name", "channel name [unit]" or "ignore"; variable of a .mat or '
        '.npz file = "channel name [unit] @ 100 Hz"',
    )
    filters: Filters = Filters()
    kinematics: Kinematics | None = None
    strides: StrideRules = StrideRules()
    models: Models = Models()
    held_out: HeldOut = HeldOut()
    quality: Quality = Quality()
    participants: tuple[Participant, ...] = Field(min_length=1)
    _folder: Path = PrivateAttr(default=Path())

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_conditions(self.conditions)
        check_sessions(self)
        check_participants(self)
        check_channels(self.channels)
        check_variables(self.models, self.channels)
        return self

    @property
    def folder(self) -> Path:
        """Folder of the study file, to which its paths are relative."""
        return self._folder

    def placed(self, folder: Path | str) -> Self:
        """Return the same study with its file in another folder; its paths are taken from there."""
        study = self.model_copy()
        study._folder = Path(folder)
        return study

    def path_of(self, file: str) -> Path:
        """Return where a file of the study lies."""
        return self._folder / file

    @property
    def walking_direction(self) -> str:
        """Direction of walking in the laboratory's axes, as on the treadmill; empty where it is inferred."""
        return self.treadmill.direction if self.treadmill else ""

    @property
    def public_title(self) -> str:
        """Title of pages; without one the conditions, never the name of the folder."""
        conditions = self.conditions
        if self.title:
            return self.title
        return " against ".join(conditions.both) if conditions.device else ", ".join(conditions.words)

    def public_settings(self, include: set[str] | None = None) -> dict[str, Any]:
        """Settings as they may be written: files are counted, labels of the recordings numbered."""
        settings = self.model_dump(mode="json", include=include)
        if settings.get("kinematics", "") is None:
            del settings["kinematics"]
        elif settings.get("kinematics", {}).get("marker_set", "").endswith(".toml"):
            settings["kinematics"]["marker_set"] = "a file of the laboratory"
        for participant in settings.get("participants", ()):
            for measured in MEASURES:  # of the person, and no setting
                del participant[measured]
            for trial in participant["trials"]:
                trial["files"] = len(trial["files"])
        if "channels" in settings:
            settings["channels"] = {f"label {k}": name for k, name in enumerate(settings["channels"].values(), 1)}
        return settings

    def with_unnamed(self) -> Self:
        """Return the same study in which trials of condition 'unknown' have the one that `unnamed` says."""
        word = self.conditions.unnamed
        if word is None:
            return self
        named, people = {"condition": word}, []
        for participant in self.participants:
            trials = (t.model_copy(update=named) if t.condition == UNKNOWN else t for t in participant.trials)
            people.append(participant.model_copy(update={"trials": tuple(trials)}))
        return self.model_copy(update={"participants": tuple(people)}).placed(self.folder)

    def participant(self, subject: str) -> Participant:
        """Return a participant."""
        person = next((p for p in self.participants if p.id == subject), None)
        if person is None:
            ids = ", ".join(p.id for p in self.participants)
            raise SchemaError("the participant must be in the study", f"{subject!r} is not", f"Use one of: {ids}.")
        return person

    def one_condition_only(self) -> tuple[str, ...]:
        """Pseudonyms of those who lack a trial of one of the two conditions; none where no device is compared."""
        if self.conditions.device is None:
            return ()
        both = self.conditions.both
        return tuple(p.id for p in self.participants if not all(p.trials_of(word) for word in both))


def check_conditions(conditions: Conditions) -> None:
    """Refuse conditions of which two share a word, and a word for unnamed trials that is no condition."""
    words = conditions.words
    if len(set(words)) < len(words) or UNKNOWN in words:
        fault = f"found {' and '.join(map(repr, words))}"
        refuse(("conditions",), f"be different words, none of them {UNKNOWN!r}", fault, "Name each condition once.")
    if conditions.unnamed is not None and conditions.unnamed not in words:
        fault = f"found {conditions.unnamed!r}"
        refuse(("conditions", "unnamed"), f"be one of {', '.join(map(repr, words))}", fault, "Use one of these words.")


def check_sessions(study: Study) -> None:
    """Refuse sessions that are dates or stand twice, and trials of a session that the study does not list."""
    for i, word in enumerate(study.sessions):
        if _DATE.search(word):
            remedy = 'Write words in the order of the dates, such as sessions = ["before", "after"].'
            refuse(("sessions", i), "not be a date, because a date can identify a person", f"found {word!r}", remedy)
        if study.sessions.index(word) != i:
            refuse(("sessions", i), "differ from the others", f"{word!r} occurs twice", "Remove one of the two.")
    for i, participant in enumerate(study.participants):
        for j, trial in enumerate(participant.trials):
            if trial.session is not None and trial.session not in study.sessions:
                remedy = did_you_mean(trial.session, study.sessions, f"Add it: sessions = [{trial.session!r}].")
                listed = ", ".join(map(repr, study.sessions)) or "none"
                place = ("participants", i, "trials", j, "session")
                refuse(place, f"be a session that the study lists ({listed})", f"found {trial.session!r}", remedy)


def check_participants(study: Study) -> None:
    """Refuse conditions that no trial can have, pseudonyms that occur twice, and names that no file can have."""
    words = study.conditions.words
    known = (*words, UNKNOWN, STATIC, FUNCTIONAL)
    ids = Counter(person.id.lower() for person in study.participants)
    for i, participant in enumerate(study.participants):
        if ids[participant.id.lower()] > 1:
            fault = f"{participant.id!r} occurs {ids[participant.id.lower()]} times"
            place = ("participants", i, "id")
            refuse(place, "be used for one person only", fault, "List all trials of a person together.")
        for j, trial in enumerate(participant.trials):
            if trial.condition not in known:
                remedy = did_you_mean(trial.condition, known, f"Use one of these words, or {UNKNOWN!r}.")
                place = ("participants", i, "trials", j, "condition")
                refuse(place, f"be {' or '.join(map(repr, words))}", f"found {trial.condition!r}", remedy)
            for k, file in enumerate(trial.files):
                if "\0" in file:
                    place = ("participants", i, "trials", j, "files", k)
                    refuse(place, "be a name without a NUL character", f"found {file!r}", "Correct the name.")
