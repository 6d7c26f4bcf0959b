"""What a study sets: filters, strides, models; its channels and variables, whose names and units must fit together."""

import difflib
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, NoReturn, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from gaitdisc.channel import hint_nearest, vocabulary
from gaitdisc.ingest.columns import IGNORE, split_unit
from gaitdisc.units import list_units, offset_words, parse_unit

ANGLES = tuple(
    f"{angle}_{side}"
    for side in "rl"
    for angle in ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
)
OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")
MISSPELT = 0.85  # likeness to a known name above which another name is taken for a slip

Positive = Annotated[float, Field(gt=0)]
Word = Annotated[str, Field(min_length=1, max_length=40)]


class StudyPart(BaseModel):
    """A table of the study file: no other keys, no other types, never changed."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


def refuse(place: Sequence[str | int], needed: str, found: str, remedy: str) -> NoReturn:
    """Refuse from within validation; place: keys and places in lists, from the part that is being checked."""
    words = {"place": tuple(place), "needed": needed, "found": found, "remedy": remedy}
    raise PydanticCustomError("gaitdisc", "{needed}; {found}. {remedy}", words)


class Treadmill(StudyPart):
    """The belt, where strides are found from markers."""

    speed_m_per_s: Annotated[float, Field(ge=0)] = Field(description="belt speed [m/s]")
    direction: Literal["+x", "-x", "+y", "-y", "+z", "-z"] = Field(
        default="+x", description="direction of walking, in the laboratory's axes"
    )


class Filters(StudyPart):
    """Filters; the defaults are those of section 4.2.1."""

    kinematics_hz: Positive = Field(default=6.0, description="low-pass of the joint angles [Hz]")
    emg_highpass_hz: Positive = Field(default=40.0, description="high-pass of the EMG before it is rectified [Hz]")
    emg_lowpass_hz: Positive = Field(default=10.0, description="low-pass of the rectified EMG [Hz]")
    order: Literal[2, 4, 6, 8] = Field(
        default=4, description="order of one pass of the Butterworth filters, which run forwards and backwards"
    )
    gap_s: Annotated[float, Field(ge=0)] = Field(default=0.1, description="longest gap that is filled [s]")


class Kinematics(StudyPart):
    """Where joint angles come from."""

    angles: Literal["file", "markers"] | None = Field(
        default=None,
        description="file: angles of the file; markers: from its markers; default: file if it has angles, else markers",
    )
    marker_set: str = Field(
        default="",
        description="plug_in_gait, oxford_foot, helen_hayes, rajagopal, gait2354 or a .toml file; empty: from labels",
    )
    hip: Literal["davis", "harrington"] | None = Field(
        default=None, description="hip joint centre: davis or harrington; by default that of the marker set"
    )
    joints: Literal["free", "held", "planar"] | None = Field(
        default=None, description="joints: free, held (at joint centres) or planar; by default those of the marker set"
    )


class StrideRules(StudyPart):
    """How strides are cut."""

    detector: Literal["auto", "force", "markers", "angles", "events"] = Field(
        default="auto", description="detector of initial contact: auto, force, markers, angles or events"
    )
    side: Literal["r", "l"] = Field(default="r", description="the foot whose contacts begin the strides")
    min_s: Positive = Field(default=0.4, description="shortest stride [s]")
    max_s: Positive = Field(default=2.5, description="longest stride [s]")
    ground: Literal["auto", "treadmill", "overground"] = Field(
        default="auto", description="where people walk: auto (from the path of the pelvis), treadmill or overground"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.min_s >= self.max_s:
            fault = f"min_s is {self.min_s:g}, max_s {self.max_s:g}"
            refuse(("min_s",), "be shorter than max_s", fault, "Exchange the two numbers, or widen the range.")
        return self


class Models(StudyPart):
    """What the models see and predict; the defaults are those of section 4.2.2."""

    angles: tuple[Word, ...] = Field(default=ANGLES, min_length=1, description="joint angles among the inputs")
    emg: tuple[Word, ...] = Field(default=(), description="EMG among the inputs")
    outputs: tuple[Word, ...] = Field(
        default=OUTPUTS, min_length=1, description="variables whose second derivative is predicted"
    )
    seed: Annotated[int, Field(ge=0, lt=2**32)] = Field(default=0, description="seed of all random numbers")


class HeldOut(StudyPart):
    """The last part of each trial, which no model sees: 30 of 240 s in section 4.2.2."""

    share: Annotated[float, Field(gt=0, lt=1)] | None = Field(
        default=0.125, description="held-out fraction of the trial, its last part"
    )
    seconds: Positive | None = Field(default=None, description="held-out length [s], instead of share")

    @model_validator(mode="after")
    def _check(self) -> Self:
        both = self.seconds is not None and self.share is not None and "share" in self.model_fields_set
        if both or (self.seconds is None and self.share is None):
            fault = f"{'both are' if both else 'neither is'} given"
            refuse(("seconds",), "be given instead of 'share'", fault, "Give either seconds or share.")
        return self


class Quality(StudyPart):
    """What a trial must have to be used."""

    min_strides: Annotated[int, Field(ge=1)] = Field(
        default=10, description="fewest complete strides of a treadmill walk, and of a walk that models are fitted to"
    )
    min_cycles: Annotated[int, Field(ge=1)] = Field(
        default=1, description="fewest cycles over ground, pooled over the trials of a person, session and condition"
    )
    late_change: Literal["refuse", "report"] = Field(
        default="refuse", description="how to treat a trial whose gait changes towards its end: refuse or report"
    )


def check_channels(channels: Mapping[str, str]) -> None:
    """Refuse a map (label -> `name` or `name [unit]`) with an unknown unit, a misspelt name, or a name twice."""
    owners: dict[str, str] = {}
    for label, entry in channels.items():
        name, unit = split_unit(entry)
        place = ("channels", label)
        if name == IGNORE:
            continue
        if not name:
            refuse(place, "be the name of a channel", f"found {entry!r}", 'Write for example "emg_sol_r [V]".')
        if unit is not None and parse_unit(unit) is None:
            fault = f"found {unit!r}" + (offset_words(unit) or hint_nearest(unit, list_units()))
            refuse(place, "be in the list of units", fault, f"Use one of: {', '.join(list_units())}.")
        if unit is None:
            _check_spelling(place, name)
        if name in owners:
            fault = f"{owners[name]!r} and {label!r} both name {name!r}"
            refuse(place, "name a channel that no other label names", fault, "Use two names, or remove one label.")
        owners[name] = label


def check_variables(models: Models, channels: Mapping[str, str]) -> None:
    """Refuse misspelt or doubled variables, outputs not among inputs; names of the study's channels are known too."""
    mapped = {split_unit(entry)[0] for entry in channels.values()}
    inputs = (*models.angles, *models.emg)
    for key in ("angles", "emg", "outputs"):
        names: tuple[str, ...] = getattr(models, key)
        for i, name in enumerate(names):
            if names.count(name) > 1:
                refuse(("models", key), "list each name once", f"{name!r} occurs twice", "Remove one of them.")
            if key == "outputs" and name not in inputs:
                fault = f"{name!r} is not{hint_nearest(name, inputs)}"
                remedy = "Add it to angles or emg, or remove it from outputs."
                refuse(("models", key), "be among the inputs (angles and emg)", fault, remedy)
            if name not in mapped:
                _check_spelling(("models", key, i), name)
    both = sorted(set(models.angles) & set(models.emg))
    if both:
        refuse(("models", "emg"), "not repeat a channel of angles", f"{both[0]!r} is in both", "Remove it from emg.")


def _check_spelling(place: Sequence[str | int], name: str) -> None:
    """Refuse a name that is nearly one of the vocabulary; other names are the laboratory's own."""
    known = vocabulary().by_name
    if name in known or f"{name}_r" in known:
        return
    near = difflib.get_close_matches(name, known, n=1, cutoff=MISSPELT)
    if near:
        remedy = f'Did you mean {near[0]!r}? A channel of your own must have its unit in [channels]: "{name} [V]".'
        refuse(place, "be a channel name", f"found {name!r}", remedy)
