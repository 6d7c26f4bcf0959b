"""The faults that are planted into recordings of a person, and the words with which a check or a page must name each.

The number in front of a kind is its row in the table of issue 27. A person whose recordings lack the stream that a kind
changes is skipped. `markers` are the angles of kinds that change markers, so that the page is computed from these.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from c3d_in_place import InPlace, edited

SHORT_S, ZERO_S, FROZEN_S, LATE_S, STANDS_S, EASES_S = 0.5, 0.15, 0.3, 0.1, 1.5, 0.8
STEP_N = 200.0  # a plate that changes by this has seen a step
WEIGHED = 0.15  # the static trial stands on the plates where it weighs the body to within this
MUSCLES = {"rf": "Rect|RF", "ham": "(Med )?Hams?", "gas": r"R?Gas\w*", "ta": "Tib Ant|TA"}


class NotHereError(Exception):
    """What a kind of fault needs and a person's recordings lack."""


@dataclass(frozen=True)
class Recorded:
    """A person's files in a folder of their own: folder/<who>/<walk or static>/<file>."""

    folder: Path
    who: str
    other: Path = Path()  # the same of somebody else
    live_emg: tuple[str, ...] = ()  # channels that the page of the person without faults draws

    def files(self, kind: str = "*") -> list[Path]:
        """Recordings of a kind, or all."""
        return sorted((self.folder / self.who / kind).glob("*.c3d") if kind != "*" else self.folder.rglob("*.c3d"))

    @property
    def walk(self) -> Path:
        """The first walk."""
        return self.files("walk")[0]

    @property
    def static(self) -> Path:
        """The static trial."""
        if not self.files("static"):
            raise NotHereError("no static trial")
        return self.files("static")[0]


Plant = Callable[[Recorded], None]


@dataclass(frozen=True)
class Kind:
    """A kind of fault."""

    name: str
    plant: Plant
    words: str  # what a new warning or refusal has to say, as a pattern
    angles: str = "file"
    notes: bool = False  # a note is enough
    cycles: str = ""  # and the kept cycles have to be as many as without the fault, or at least as many: == or >=
    people: int = 0  # or the study has so many people
    needs: str = ""  # of the page without faults: kinematics, kinetics


def opened(paths: Iterable[Path]) -> Iterator[InPlace]:
    """Each file, written before the next."""
    for path in paths:
        with edited(path) as file:
            yield file


def exchange(first: str, second: str, kind: str = "walk", seconds: float = 0.0) -> Plant:
    """Exchange two markers' labels, throughout or for some seconds in the middle."""

    def plant(person: Recorded) -> None:
        with edited(person.static if kind == "static" else person.walk) as file:
            centre, half = 0.5 * len(file.points), 0.5 * seconds * file.points_rate
            rows = slice(max(round(centre - half), 0), round(centre + half)) if seconds else slice(None)
            a, b = column(file, first), column(file, second)
            file.points[rows, [a, b]] = file.points[rows, [b, a]]

    return plant


def column(file: InPlace, label: str) -> int:
    """Column of a point."""
    try:
        return file.point(label)
    except LookupError as error:
        raise NotHereError(str(error)) from None


def points(label: str, factor: float = 1.0, plus: float = 0.0, kinds: str = "walk", axes: slice = slice(0, 3)) -> Plant:
    """Multiply or shift an output of the file's own model."""

    def plant(person: Recorded) -> None:
        for file in opened(person.files(kinds)):
            with suppress(NotHereError) if "static" in str(file.path) else nullcontext():
                place = column(file, label)
                seen = file.points[:, place, 3] >= 0
                file.points[seen, place, axes] = factor * file.points[seen, place, axes] + plus

    return plant


def stuck(label: str, seconds: float, zero: bool) -> Plant:
    """Zeros, or the last value, for a while in which the point moves most."""

    def plant(person: Recorded) -> None:
        with edited(person.walk) as file:
            place, width = column(file, label), round(seconds * file.points_rate)
            path = file.points[:, place, :3].astype(float)
            third = len(path) // 3
            moved = np.abs(np.diff(path, axis=0)).sum(axis=1)
            span = np.convolve(moved, np.ones(width), "valid")[third : 2 * third]
            start = third + int(np.argmax(span))
            file.points[start : start + width, place, :3] = 0.0 if zero else file.points[start, place, :3]

    return plant


def measures(name: str, factor: float, of_all: bool = False) -> Plant:
    """Another body mass, leg length in the first walk; or in all files, with what Plug-in Gait divides by it."""

    def plant(person: Recorded) -> None:
        states = {path for path in person.files() if InPlace(path).numbers(f"PROCESSING:{name}").size}
        if of_all:
            file = InPlace(person.static)
            mass = file.numbers("PROCESSING:BODYMASS")
            down = [np.median(file.newtons(one[2:3])) for one in file.plate_channels()] if file.analog.size else []
            if not mass.size or abs(abs(sum(down)) / (9.81 * float(mass.flat[0])) - 1) > WEIGHED:
                raise NotHereError("the static trial does not stand on the plates")
        if states <= {person.walk} or not (of_all or person.walk in states):
            raise NotHereError(f"no {name} in the first walk and in another file")
        for file in opened(person.files() if of_all else [person.walk]):
            file.numbers(f"PROCESSING:{name}")[...] *= factor
            per_kg = [k for k, label in enumerate(file.labels) if re.search("Moment|Power|Force|GRF", label)]
            if of_all:
                file.points[:, per_kg, :3] /= factor

    return plant


def loaded(person: Recorded) -> list[int]:
    """Plates of the first walk, the one that carried most first."""
    loads = InPlace(person.walk).loads()
    if len(loads) < 2 or max(loads) < STEP_N:
        raise NotHereError("no plate recorded a step")
    return list(np.argsort(loads)[::-1])


def gain(person: Recorded) -> None:
    """One plate's gain is 1.3 times too large, in all files."""
    plate = loaded(person)[0]
    for file in opened(person.files()):
        if file.plate_channels() and file.analog.size:
            channels = file.plate_channels()[plate]
            offset = file.numbers("ANALOG:OFFSET").astype(float)[channels]
            file.analog[..., channels] = 1.3 * (file.analog[..., channels] - offset) + offset


def plates_exchanged(person: Recorded) -> None:
    """What two plates measured is exchanged, in all files."""
    first, second = loaded(person)[:2]
    for file in opened(person.files()):
        if (listed := file.plate_channels()) and file.analog.size:
            swap_channels(file, np.r_[listed[first], listed[second]], np.r_[listed[second], listed[first]])


def swap_channels(file: InPlace, to: np.ndarray, source: np.ndarray) -> None:
    """Give analog channels what others measured, in their own scale."""
    measured = file.newtons(source)
    scale = file.numbers("ANALOG:SCALE").astype(float)[to] * float(file.numbers("ANALOG:GEN_SCALE").flat[0])
    stored = measured / scale + file.numbers("ANALOG:OFFSET").astype(float)[to]
    file.analog[..., to] = stored.reshape(*file.analog.shape[:2], len(to))


def emg_column(file: InPlace, muscle: str, side: str) -> int:
    """Analog column of a muscle of a leg."""
    for at, label in enumerate(file.words("ANALOG:LABELS")):
        if re.fullmatch(rf"(Voltage\.)?{side}[ _]?({MUSCLES[muscle]})", label):
            return at
    raise NotHereError(f"no EMG {muscle} {side}")


def emg_sides(person: Recorded) -> None:
    """Electrodes of left and right are exchanged, in all walks."""
    if len(person.live_emg) < 2:
        raise NotHereError("fewer than two live electrodes")
    for file in opened(person.files("walk")):
        left, right = (np.array([emg_column(file, muscle, side) for muscle in MUSCLES]) for side in "LR")
        swap_channels(file, np.r_[left, right], np.r_[right, left])


def electrode(person: Recorded, dead: bool) -> None:
    """One live electrode is dead, or clipped, in all walks."""
    live = [name for name in person.live_emg if re.fullmatch(rf"emg_({'|'.join(MUSCLES)})_[lr]", name)]
    if not live:
        raise NotHereError("no live electrode that the labels name")
    _, muscle, side = live[0].split("_")
    for file in opened(person.files("walk")):
        at = emg_column(file, muscle, side.upper())
        mean = file.analog[..., at].mean()
        apart = file.analog[..., at] - mean
        limit = np.abs(apart).max()
        file.analog[..., at] = mean + (1e-3 * apart if dead else np.clip(30 * apart, -limit, limit))


def late_events(person: Recorded) -> None:
    """Events are 0.1 s late, in all walks."""
    loaded(person)
    for file in opened(person.files("walk")):
        times = file.numbers("EVENT:TIMES")
        if times.size < 4:
            raise NotHereError("no events")
        times[1] += LATE_S


def standing(person: Recorded, after: bool) -> None:
    """The walk begins or ends with standing: time runs, then all movement eases in from rest or out to it."""
    with edited(person.walk) as file:
        rate, count = file.points_rate, len(file.points)
        still, eases = round(STANDS_S * rate), 2 * round(0.5 * EASES_S * rate)
        sway = 0.15 * (1 - np.cos(2 * np.pi * np.arange(still) / still))
        extra = np.r_[sway, np.arange(eases + 1) ** 2 / (2 * eases)]
        frames = np.r_[extra, np.arange(eases // 2 + 1, count)]
        taken = np.r_[np.random.default_rng(27).integers(0, 5, still), np.rint(frames[still:])].astype(int)
        if after:
            frames, taken = count - 1 - frames[::-1], count - 1 - taken[::-1]
        file.resampled(frames, taken)
        times, first = file.numbers("EVENT:TIMES"), file.header("<H", 4) - 1
        known = slice(0, -still) if after else slice(still, None)
        if times.size:
            places = np.interp(times[1] * rate - first, frames[known], np.arange(len(frames))[known])
            times[1] = (places + first) / rate


def group_folders(person: Recorded) -> None:
    """Somebody of the controls and somebody of the patients have one name."""
    own, theirs = person.folder / person.who, person.other
    shutil.move(own, person.folder / "controls" / "Smith")
    shutil.copytree(theirs, person.folder / "patients" / "Smith", ignore=shutil.ignore_patterns("SOURCE.txt"))


def recording_again(*parts: str) -> Plant:
    """Copy the first walk to another place."""

    def plant(person: Recorded) -> None:
        target = person.folder.joinpath(*(part.format(who=person.who, file=person.walk.stem) for part in parts))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(person.walk, target)

    return plant


SAME = r"counted once|samples are identical|same (recording|file|trial|data)|identical|equal|twice|duplicate|copies"
FOOT, PLATE = r"[LR](ANK|HEE|TOE)\b|foot|ankle", r"plate|force|newton|weigh"
moved = partial(Kind, angles="markers", needs="kinematics")
KINDS = (
    moved("1 static ankle and heel", exchange("LANK", "LHEE", "static"), FOOT),
    moved("1 static heel and toe", exchange("RHEE", "RTOE", "static"), FOOT),
    moved("1 walk ankle and toe", exchange("RANK", "RTOE"), FOOT),
    moved("1 walk heel and toe 0.5 s", exchange("RHEE", "RTOE", "walk", SHORT_S), FOOT),
    moved("1 walk thigh and knee", exchange("LTHI", "LKNE"), r"L(THI|KNE)|thigh|knee"),
    moved("1 walk knees", exchange("LKNE", "RKNE"), r"[LR]KNE|thigh|knee|left and right"),
    moved("1 walk ankles 0.5 s", exchange("LANK", "RANK", "walk", SHORT_S), FOOT + "|shank|left and right"),
    moved("1 walk front spines", exchange("LASI", "RASI"), "[LR]ASI|pelvis|left and right"),
    Kind("2 one name in two groups", group_folders, r"group|same name|mass|two people", people=2),
    Kind("2 mass of one trial +10 %", measures("BODYMASS", 1.1), r"mass|kg"),
    Kind("2 leg length of one trial +5 %", measures("LLEGLENGTH", 1.05), r"leg length|leg is|legs? .*(mm|cm| m)\b"),
    Kind("5 mass 8 % off", measures("BODYMASS", 1.08, True), r"mass|weigh|kg"),
    Kind("5 gain of a plate 1.3", gain, PLATE, needs="kinetics"),
    Kind("5 gain of a plate 1.3, markers", gain, PLATE, "markers", needs="kinetics"),
    Kind("5 plates exchanged", plates_exchanged, PLATE, needs="kinetics"),
    Kind("5 plates exchanged, markers", plates_exchanged, PLATE, "markers", needs="kinetics"),
    Kind("6 twice", recording_again("{who}", "walk", "{file}_b.c3d"), SAME, notes=True, cycles="=="),
    Kind("6 two people", recording_again("Somebody", "walk", "{file}_b.c3d"), SAME),
    Kind("6 two conditions", recording_again("{who}", "exo", "{file}_b.c3d"), SAME),
    Kind("7 events 0.1 s late", late_events, r"event|contact"),
    Kind("8 knee in radians", points("LKneeAngles", np.pi / 180, kinds="*"), r"knee|radian", needs="kinematics"),
    Kind("8 ankle moment / 1000", points("RAnkleMoment", 1e-3), r"ankle|moment|power", needs="kinetics"),
    Kind("8 hip sign", points("LHipAngles", -1.0, kinds="*", axes=slice(0, 1)), "hip", needs="kinematics"),
    Kind("8 left knee +20 deg", points("LKneeAngles", plus=20.0, axes=slice(0, 1)), "knee", needs="kinematics"),
    Kind("8 EMG sides", emg_sides, r"emg|electrode|muscle"),
    moved("9 zeros, marker", stuck("LKNE", ZERO_S, True), r"LKNE|zero places|knee|shank", notes=True),
    Kind("9 zeros, angle", stuck("LKneeAngles", ZERO_S, True), r"knee", needs="kinematics"),
    moved("9 frozen marker", stuck("LTOE", FROZEN_S, False), FOOT),
    Kind("10 dead electrode", lambda person: electrode(person, True), r"dead|flat|unplugged"),
    Kind("10 clipped electrode", lambda person: electrode(person, False), r"clip|satur|unplugged|range"),
    Kind("11 heels 0.5 s", exchange("LHEE", "RHEE", "walk", SHORT_S), r"[LR]HEE|heel|foot|left and right", cycles=">="),
    Kind("11 standing before", lambda p: standing(p, False), r"stand|still|not walking", notes=True),
    Kind("11 standing after", lambda p: standing(p, True), r"stand|still|not walking", notes=True),
)
