"""The study: who walked, in which sessions, under which conditions, in which files, and every setting."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, model_validator

from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study_rules import (
    check_channels,
    check_conditions,
    check_participants,
    check_sessions,
    check_variables,
    refuse,
)

UNKNOWN = "unknown"  # condition of a trial that is listed but not used
STATIC = "static"  # condition of a trial in which the person stands
FUNCTIONAL = "functional"  # condition of a trial in which the legs are circled about the hips
ANGLES = tuple(
    f"{angle}_{side}"
    for side in "rl"
    for angle in ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
)
OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")

Positive = Annotated[float, Field(gt=0)]
Word = Annotated[str, Field(min_length=1, max_length=40)]
FileName = Annotated[str, Field(min_length=1)]
Pseudonym = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,16}$")]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class Conditions(_Part):
    """The conditions, in the laboratory's own words."""

    nominal: Word = Field(
        description="the reference condition, without the device or with it passive; or the only condition"
    )
    device: Word | None = Field(
        default=None, description="the condition with the device, which models compare with the reference"
    )
    others: tuple[Word, ...] = Field(default=(), description="further conditions, whose cycles are pooled")
    unnamed: Word | None = Field(
        default=None,
        description="condition of all trials marked 'unknown'; one of the words above. Without it they are not used",
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
                "a comparison by models needs two conditions in [conditions], nominal and device",
                f"the study has {', '.join(map(repr, self.words))}, but no device",
                "Add device, or look at the pooled cycles of `gaitdisc run`.",
            )
        return self.nominal, self.device


class PlannedTrial(_Part):
    """One walk: the files that hold it, and what the files do not say."""

    condition: Word = Field(
        description="a word of [conditions], 'static' (standing), 'functional' (circling legs), or 'unknown' (not used)"
    )
    session: Word | None = Field(default=None, description="a word of sessions, never a date")
    files: tuple[FileName, ...] = Field(min_length=1, description="files of this walk, relative to the study file")
    part: Annotated[str, Field(max_length=40)] = Field(
        default="",
        description="trial in a .mat or .npz file with several: its number, or what * stands for in [channels]",
    )
    speed_m_per_s: Positive | None = Field(default=None, description="walking speed of this trial [m/s]")
    crop_s: tuple[float, float] | None = Field(
        default=None, description="start and end of the part to use, on the file's clock [s]"
    )

    @model_validator(mode="after")
    def _check(self) -> PlannedTrial:
        if self.crop_s and self.crop_s[0] >= self.crop_s[1]:
            refuse(("crop_s",), "have a start before its end", f"found {list(self.crop_s)}", "Write [start, end] in s.")
        return self


class Participant(_Part):
    """A person, known by a pseudonym only."""

    id: Pseudonym = Field(description="pseudonym: letters, digits, _ and -, at most 16")
    excluded: str = Field(
        default="", description="reason why this person is excluded from the statistics; empty otherwise"
    )
    group: Annotated[str, Field(max_length=40)] = Field(
        default="", description="group of this person, such as control; empty if there are none"
    )
    mass_kg: Annotated[float, Field(ge=5, le=300)] | None = Field(
        default=None, description="body mass [kg], if the C3D files state none or a wrong one"
    )
    height_m: Annotated[float, Field(ge=0.4, le=2.5)] | None = Field(
        default=None, description="stature [m], if the C3D files state none or a wrong one"
    )
    sex: Literal["", "f", "m"] = Field(
        default="", description="f or m, for the inertia of the segments; if empty, the mean of both"
    )
    age_years: Annotated[int, Field(ge=1, le=120)] | None = Field(
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


class Treadmill(_Part):
    """The belt, where strides are found from markers."""

    speed_m_per_s: Annotated[float, Field(ge=0)] = Field(description="belt speed [m/s]")
    direction: Literal["+x", "-x", "+y", "-y", "+z", "-z"] = Field(
        default="+x", description="direction of walking, in the laboratory's axes"
    )


class Filters(_Part):
    """Filters; the defaults are those of section 4.2.1."""

    kinematics_hz: Positive = Field(default=6.0, description="low-pass of the joint angles [Hz]")
    emg_highpass_hz: Positive = Field(default=40.0, description="high-pass of the EMG before it is rectified [Hz]")
    emg_lowpass_hz: Positive = Field(default=10.0, description="low-pass of the rectified EMG [Hz]")
    order: Literal[2, 4, 6, 8] = Field(
        default=4, description="order of one pass of the Butterworth filters, which run forwards and backwards"
    )
    gap_s: Annotated[float, Field(ge=0)] = Field(default=0.1, description="longest gap that is filled [s]")


class Kinematics(_Part):
    """Where joint angles come from."""

    angles: Literal["file", "markers"] | None = Field(
        default=None,
        description="file: as in the file; markers: computed; by default as in the file, if it has any",
    )
    marker_set: str = Field(
        default="",
        description="plug_in_gait, oxford_foot, helen_hayes, rajagopal, gait2354, or a .toml file; default: by labels",
    )
    hip: Literal["davis", "harrington"] | None = Field(
        default=None, description="hip joint centre: davis or harrington; by default as in the marker set"
    )
    joints: Literal["free", "held", "planar"] | None = Field(
        default=None, description="free, held or planar; by default as in the marker set"
    )


class StrideRules(_Part):
    """How strides are cut."""

    detector: Literal["auto", "force", "markers", "angles", "events"] = Field(
        default="auto", description="detector of initial contact: auto, force, markers, angles or events"
    )
    side: Literal["r", "l"] = Field(default="r", description="the foot whose contacts begin the strides")
    min_s: Positive = Field(default=0.4, description="shortest stride [s]")
    max_s: Positive = Field(default=2.5, description="longest stride [s]")
    ground: Literal["auto", "treadmill", "overground"] = Field(
        default="auto", description="where people walk: auto (by the path of the pelvis), treadmill or overground"
    )

    @model_validator(mode="after")
    def _check(self) -> StrideRules:
        if self.min_s >= self.max_s:
            found = f"min_s is {self.min_s:g}, max_s {self.max_s:g}"
            refuse(("min_s",), "be shorter than max_s", found, "Exchange or widen them.")
        return self


class Models(_Part):
    """What the models see and predict; the defaults are those of section 4.2.2."""

    angles: tuple[Word, ...] = Field(default=ANGLES, min_length=1, description="joint angles among the inputs")
    emg: tuple[Word, ...] = Field(default=(), description="EMG among the inputs")
    outputs: tuple[Word, ...] = Field(
        default=OUTPUTS, min_length=1, description="variables whose second derivative is predicted"
    )
    seed: Annotated[int, Field(ge=0, lt=2**32)] = Field(default=0, description="seed of all random numbers")


class HeldOut(_Part):
    """The last part of each trial, which no model sees: 30 of 240 s in section 4.2.2."""

    share: Annotated[float, Field(gt=0, lt=1)] | None = Field(
        default=0.125, description="fraction of the trial, its last part"
    )
    seconds: Positive | None = Field(default=None, description="or its length [s]; write one of the two")

    @model_validator(mode="after")
    def _check(self) -> HeldOut:
        both = self.seconds is not None and self.share is not None and "share" in self.model_fields_set
        if both or (self.seconds is None and self.share is None):
            refuse(("seconds",), "replace 'share'", "both are there" if both else "none is", "Write one.")
        return self

    def length_s(self, duration_s: float) -> float:
        """Return the length of the held-out part of a trial that lasts `duration_s` [s]."""
        return self.seconds if self.seconds is not None else (self.share or 0.0) * duration_s


class Quality(_Part):
    """What a trial must have to be used."""

    min_strides: Annotated[int, Field(ge=1)] = Field(
        default=10, description="fewest complete strides of a walk on a treadmill, or of one that models are fitted to"
    )
    min_cycles: Annotated[int, Field(ge=1)] = Field(
        default=1, description="fewest cycles over ground, pooled over the trials of a person, session and condition"
    )
    late_change: Literal["refuse", "report"] = Field(
        default="refuse", description="how to treat a trial whose gait changes late: refuse or report"
    )


class Study(_Part):
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
        description='label in a file = "channel name" or "channel name [unit]"; variable of a .mat or .npz file = '
        '"channel name [unit] @ 100 Hz"',
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
    def _check(self) -> Study:
        check_conditions(self.conditions, UNKNOWN)
        check_sessions(self)
        check_participants(self, (UNKNOWN, STATIC, FUNCTIONAL))
        check_channels(self.channels)
        check_variables(self.models, self.channels)
        return self

    @property
    def folder(self) -> Path:
        """Folder of the study file, to which its paths are relative."""
        return self._folder

    def placed(self, folder: Path | str) -> Study:
        """Return the same study with its file in another folder; its paths are taken from there."""
        study = self.model_copy()
        study._folder = Path(folder)
        return study

    def path_of(self, file: str) -> Path:
        """Return where a file of the study lies."""
        return self._folder / file

    def with_unnamed(self) -> Study:
        """Return the same study in which trials of condition 'unknown' have the one that `unnamed` says."""
        word = self.conditions.unnamed
        if word is None:
            return self
        named, people = {"condition": word}, []
        for one in self.participants:
            trials = (trial.model_copy(update=named) if trial.condition == UNKNOWN else trial for trial in one.trials)
            people.append(one.model_copy(update={"trials": tuple(trials)}))
        return self.model_copy(update={"participants": tuple(people)}).placed(self.folder)

    def participant(self, subject: str) -> Participant:
        """Return a participant."""
        found = next((each for each in self.participants if each.id == subject), None)
        if found is None:
            ids = ", ".join(each.id for each in self.participants)
            raise SchemaError("the participant must be in the study", f"{subject!r} is not", f"Use one of: {ids}.")
        return found

    def complete(self) -> tuple[Participant, ...]:
        """Participants who are not excluded, with trials of both conditions where a device is compared."""
        lacking = set(self.one_condition_only())
        return tuple(each for each in self.participants if each.id not in lacking and not each.excluded)

    def one_condition_only(self) -> tuple[str, ...]:
        """Pseudonyms of those who lack a trial of one of the two conditions; none where no device is compared."""
        if self.conditions.device is None:
            return ()
        both = self.conditions.both
        return tuple(each.id for each in self.participants if not all(each.trials_of(word) for word in both))

    def missing_files(self) -> tuple[str, ...]:
        """Files that the study names and that are not there, as written in it."""
        named = [file for each in self.participants for trial in each.trials for file in trial.files]
        if self.kinematics and self.kinematics.marker_set.endswith(".toml"):
            named.append(self.kinematics.marker_set)
        return tuple(file for file in dict.fromkeys(named) if not self.path_of(file).is_file())

    def check_files(self) -> None:
        """Refuse a study whose files are not all there."""
        missing = self.missing_files()
        if missing:
            raise SchemaError(
                "all files of the study must exist, relative to the study file",
                f"{len(missing)} missing: {', '.join(missing)}",
                "Correct the names in [[participants.trials]], or copy the files there.",
            )
