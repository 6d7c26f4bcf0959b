"""A marker set: which marker lies on which landmark, and which markers follow which segment.

Those that come along and a laboratory's own are TOML files; a trial's set is given, or recognised by its labels.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from gaitdisc.channel import fold_label, hint_nearest, list_names, schema_folder
from gaitdisc.errors import ChannelError, ReadError, SchemaError
from gaitdisc.kinematics.pose import FEWEST_POINTS, PARTS, SEGMENTS
from gaitdisc.regular_file import check_regular
from gaitdisc.toml_text import parse_toml

SIDED = (
    "asis",
    "thigh_wand",
    "knee_lateral",
    "knee_medial",
    "shank_wand",
    "ankle_lateral",
    "ankle_medial",
    "heel",
    "toe",
)
LANDMARKS = (*SIDED, "sacrum")
NEEDED = ("asis", "sacrum", "knee_lateral", "ankle_lateral", "heel", "toe")
METHODS = {"hip": ("harrington", "davis"), "knee": ("midpoint", "chord"), "ankle": ("midpoint", "chord")}
AXES = {"shank": ("ankle", "knee"), "foot": ("flat", "as placed")}
JOINTS = ("free", "held", "planar")
PLACEHOLDER = re.compile(r"\{(S|s|side)\}")
LARGEST_BYTES = 2**20
TABLES = {  # of the file: what each of its keys holds
    "aliases": "list of names",
    "landmarks": "text",
    "joint_centres": "text",
    "axes": "text",
    "tracked": "list of names",
}
EXAMPLE = "See docs/kinematics.md for an example."


@dataclass(frozen=True)
class MarkerSet:
    """Markers of one laboratory's convention.

    >>> marker_set("plug_in_gait").tracked["thigh"]
    ('hip', '{S}THI', '{S}KNE')
    """

    name: str  # name of its file without the ending
    title: str  # what it is
    citation: str  # where it is described
    # name in this set -> other names of the same marker. `{S}` stands for R and L
    aliases: Mapping[str, tuple[str, ...]]
    # landmark -> markers: `A + B` is the midpoint, `A | B` is A or, where that is absent, B
    landmarks: Mapping[str, str]
    # `hip`, `knee`, `ankle` -> methods, the first that there are markers and measures for is taken
    joint_centres: Mapping[str, tuple[str, ...]]
    # `shank`: whose medial-lateral axis it takes; `foot`: `flat` on the floor, or `as placed` from heel to toe
    axes: Mapping[str, str]
    # `free`: each segment is laid over its own points; `held`: all at once, with the joints held together; `planar`:
    # the same, and everything moves in the plane of walking, as a planar model's body does
    joints: str
    # `pelvis`, `thigh`, `shank`, `foot` -> markers that follow the segment; `hip`, `knee`, `ankle` are the joint
    # centres that the segment above carries
    tracked: Mapping[str, tuple[str, ...]]

    def with_joints(self, joints: str) -> MarkerSet:
        """Return the same set with its joints free, held, or moving in a plane."""
        if joints not in JOINTS:
            raise SchemaError(f"joints must be one of {', '.join(JOINTS)}", _find(joints, JOINTS), "Use one of these.")
        return replace(self, joints=joints)

    def with_hip(self, method: str) -> MarkerSet:
        """Return the same set with another hip joint centre."""
        if method not in METHODS["hip"]:
            needed = f"the method for the hip joint centre must be one of {', '.join(METHODS['hip'])}"
            raise SchemaError(needed, _find(method, METHODS["hip"]), "Use one of these.")
        return replace(self, joint_centres={**self.joint_centres, "hip": (method,)})

    def names(self, labels: Iterable[str]) -> dict[str, str]:
        """Set's name -> label; case, blanks, punctuation do not count, the set's own name comes before an alias.

        >>> marker_set("helen_hayes").names(["R.ASIS", "RKNEE"])
        {'RASI': 'R.ASIS', 'RKNE': 'RKNEE'}
        """
        by_fold: dict[str, str] = {}
        for label in labels:
            by_fold.setdefault(fold_label(label), label)
        others: dict[str, list[str]] = {}
        for key, several in self.aliases.items():
            for side in "lr":
                others.setdefault(name_sided(key, side), []).extend(name_sided(alias, side) for alias in several)
        by_name = {}
        for name in self.markers():
            spellings = (name, *others.get(name, ()))
            label = next((by_fold[f] for f in map(fold_label, spellings) if f in by_fold), None)
            if label is not None:
                by_name[name] = label
        return by_name

    def markers(self) -> tuple[str, ...]:
        """Every marker that landmarks or segments name, both sides, in order."""
        return tuple(dict.fromkeys(marker for pair in self._pairs() for marker in pair))

    def _pairs(self) -> list[tuple[str, str]]:
        named = [marker for text in self.landmarks.values() for choice in choices(text) for marker in choice]
        named += [marker for several in self.tracked.values() for marker in several if marker not in METHODS]
        return list(dict.fromkeys((name_sided(marker, "l"), name_sided(marker, "r")) for marker in named))

    def list_sided_pairs(self, names: Iterable[str]) -> list[tuple[str, str]]:
        """Left marker and right marker of each pair that is there, in the names of this set."""
        there = set(names)
        return [pair for pair in self._pairs() if pair[0] != pair[1] and there.issuperset(pair)]

    def followers(self, segment: str) -> tuple[str, ...]:
        """Points that follow a segment: markers by the names of this set, `hip`, `knee`, `ankle` for a joint centre.

        >>> marker_set("plug_in_gait").followers("shank_r")
        ('knee', 'RTIB', 'RANK')
        """
        part, _, side = segment.partition("_")
        return on_sides(self.tracked[part], side or "lr")

    def landmark(self, key: str, side: str, names: Iterable[str]) -> tuple[str, ...]:
        """Markers whose midpoint is a landmark: the first choice that is among these names, empty where none is.

        >>> marker_set("plug_in_gait").landmark("sacrum", "l", ["LPSI", "RPSI"])
        ('LPSI', 'RPSI')
        """
        there = set(names)
        for choice in choices(self.landmarks.get(key, "")):
            markers = tuple(name_sided(marker, side) for marker in choice)
            if there.issuperset(markers):
                return markers
        return ()

    def lacking(self, names: Iterable[str]) -> list[str]:
        """Markers of a static trial that are not among these names; of several choices the first is named."""
        there = set(names)
        absent = []
        for key in self.list_needed_landmarks(there):
            for side in "lr":
                if not self.landmark(key, side, there):
                    first = (name_sided(marker, side) for marker in choices(self.landmarks[key])[0])
                    absent += [marker for marker in first if marker not in there]
        return list(dict.fromkeys(absent))

    def list_needed_landmarks(self, names: Iterable[str]) -> list[str]:
        """Landmarks without which no frame can be built from markers of these names."""
        there = set(names)
        needed: list[str] = list(NEEDED)
        for joint, wand in (("knee", "thigh_wand"), ("ankle", "shank_wand")):
            methods = self.joint_centres[joint]
            medial = all(self.landmark(f"{joint}_medial", side, there) for side in "lr")
            by_midpoint = "midpoint" in methods and (medial or "chord" not in methods)
            needed.append(f"{joint}_medial" if by_midpoint else wand)
        return needed


def name_sided(name: str, side: str) -> str:
    """Name of a marker on one side, from one with or without `{S}` (R, L), `{s}` (r, l) or `{side}` (right, left).

    >>> name_sided("{S}ASI", "l"), name_sided("knee_{s}", "r"), name_sided("{side} knee", "r")
    ('LASI', 'knee_r', 'right knee')
    """
    words = {"S": side.upper(), "s": side, "side": {"l": "left", "r": "right"}[side]}
    return PLACEHOLDER.sub(lambda match: words[match[1]], name)


def on_sides(points: Iterable[str], sides: str) -> tuple[str, ...]:
    """Names of points on one side or on both, each once.

    >>> on_sides(["{S}ASI", "SACR"], "lr")
    ('LASI', 'RASI', 'SACR')
    """
    return tuple(dict.fromkeys(name_sided(point, side) for point in points for side in sides))


def choices(text: str) -> list[tuple[str, ...]]:
    """Markers of each choice of a landmark.

    >>> choices("SACR | LPSI + RPSI"), choices("")
    ([('SACR',), ('LPSI', 'RPSI')], [])
    """
    return [tuple(part.strip() for part in choice.split("+")) for choice in text.split("|")] if text.strip() else []


def marker_set(name: str | Path) -> MarkerSet:
    """Marker set that comes along, by its name, or a laboratory's own, by the path of its file."""
    shipped = read_marker_sets()
    if isinstance(name, str) and name in shipped:
        return shipped[name]
    if str(name).endswith(".toml"):
        return read_marker_set(Path(name))
    raise SchemaError(
        f"a marker set must be one of {', '.join(shipped)}, or a file that ends in .toml",
        _find(str(name), tuple(shipped)),
        "Correct the name, or write the file as docs/kinematics.md shows.",
    )


@cache
def read_marker_sets() -> dict[str, MarkerSet]:
    """Marker sets that come along, by name."""
    paths = sorted((schema_folder() / "marker_sets").glob("*.toml"))
    return {path.stem: read_marker_set(path) for path in paths}


def read_marker_set(path: Path) -> MarkerSet:
    """Marker set of a TOML file: `[landmarks]`, `[joint_centres]`, `[tracked]`; `[aliases]`, `[axes]`, `joints`."""
    try:
        check_regular(path, LARGEST_BYTES)
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = "it is not UTF-8 text" if isinstance(error, UnicodeDecodeError) else error.strerror
        raise ReadError("a marker set must be a file", f"{path.name}: {reason}", "Check the path.") from error
    try:
        table = parse_toml(text)
    except tomllib.TOMLDecodeError as error:
        raise SchemaError("a marker set must be a TOML file", f"{path.name}: {error}", EXAMPLE) from error
    return _check_text(table, path)


def _check_text(table: dict[str, Any], path: Path) -> MarkerSet:
    file, usual = path.name, {"title": path.stem, "citation": "", "joints": JOINTS[0]}
    known = ("title", "citation", "aliases", "landmarks", "joint_centres", "axes", "joints", "tracked")
    _check_words(table, known, "a key of a marker set", file)
    words = {key: _of_kind("text", table.get(key, text), key, file) for key, text in usual.items()}
    _check_words([words["joints"]], JOINTS, "joints", file)
    tables: dict[str, dict[str, Any]] = {}
    for part, kind in TABLES.items():
        rows = _of_kind("table", table.get(part, {}), part, file)
        tables[part] = {key: _of_kind(kind, value, f"{part}.{key}", file) for key, value in rows.items()}
    for part, keys in (("landmarks", LANDMARKS), ("joint_centres", METHODS), ("axes", AXES), ("tracked", PARTS)):
        _check_words(tables[part], tuple(keys), f"a key of [{part}]", file)
    for key, value in tables["axes"].items():
        _check_words([value], AXES[key], f"axes.{key}", file)
    methods = {key: tuple(name.strip() for name in text.split("|")) for key, text in tables["joint_centres"].items()}
    _check_landmarks(tables["landmarks"], file)
    _check_methods(methods, tables["landmarks"], file)
    _check_tracked(tables["tracked"], file)
    axes = {"shank": "ankle", "foot": "flat", **tables["axes"]}
    aliases, tracked = ({key: tuple(names) for key, names in tables[part].items()} for part in ("aliases", "tracked"))
    return MarkerSet(
        path.stem,
        aliases=aliases,
        landmarks=tables["landmarks"],
        joint_centres=methods,
        axes=axes,
        tracked=tracked,
        **words,
    )


def _of_kind(kind: str, value: Any, where: str, file: str) -> Any:
    """Value of the file, if it is a table, a text or a list of names."""
    sound = isinstance(value, {"table": dict, "text": str, "list of names": list}[kind])
    if not sound or (isinstance(value, list) and not all(isinstance(item, str) and item for item in value)):
        raise SchemaError(f"{where} of a marker set must be a {kind}", f"{file}: found {value!r}", EXAMPLE)
    return value


def _find(word: str, known: Sequence[str]) -> str:
    return f"found {word!r}" + hint_nearest(word, known)


def _check_words(words: Iterable[str], known: Sequence[str], where: str, file: str) -> None:
    for word in words:
        if word not in known:
            needed = f"{where} must be one of {', '.join(known)}"
            raise SchemaError(needed, f"{file}: {_find(word, known)}", EXAMPLE)


def _check_landmarks(landmarks: Mapping[str, str], file: str) -> None:
    absent = [key for key in NEEDED if not choices(landmarks.get(key, ""))]
    if absent:
        needed = f"[landmarks] of a marker set must have {', '.join(NEEDED)}"
        raise SchemaError(needed, f"{file} has no {absent[0]}", EXAMPLE)
    for key, text in landmarks.items():
        empty = not all(all(choice) for choice in choices(text))
        if empty or (key in SIDED and not PLACEHOLDER.search(text)):
            needed = f"landmarks.{key} must name markers" + (" of both sides with {S}, {s} or {side}" * (key in SIDED))
            mend = f'Write for example {key} = "{{S}}NAME", for RNAME and LNAME.'
            raise SchemaError(needed, f"{file}: found {text!r}", mend)


def _check_methods(methods: Mapping[str, tuple[str, ...]], landmarks: Mapping[str, str], file: str) -> None:
    for joint, known in METHODS.items():
        if joint not in methods:
            raise SchemaError(f"[joint_centres] must have {', '.join(METHODS)}", f"{file} has no {joint}", EXAMPLE)
        _check_words(methods[joint], known, f"joint_centres.{joint}", file)
    for joint, wand in (("knee", "thigh_wand"), ("ankle", "shank_wand")):
        for method, landmark in (("midpoint", f"{joint}_medial"), ("chord", wand)):
            if method in methods[joint] and landmark not in landmarks:
                needed = f"joint_centres.{joint} = {method!r} must have landmarks.{landmark}"
                raise SchemaError(needed, f"{file} has no such landmark", EXAMPLE)


def _check_tracked(tracked: Mapping[str, Iterable[str]], file: str) -> None:
    for part, above in zip(PARTS, ((), ("hip",), ("knee",), ("ankle",)), strict=True):
        points = on_sides(tracked.get(part, ()), "lr" if part == "pelvis" else "r")
        if len(points) < FEWEST_POINTS:
            needed = f"tracked.{part} must have at least {FEWEST_POINTS} points"
            raise SchemaError(needed, f"{file} has {len(points)}: {', '.join(points)}", EXAMPLE)
        wrong = [point for point in points if point in METHODS and point not in above]
        if wrong:
            needed = f"tracked.{part} may name only the joint centre above it ({', '.join(above) or 'none'})"
            raise SchemaError(needed, f"{file} names {wrong[0]!r}", EXAMPLE)


def recognise_marker_set(static: Iterable[str], trial: Iterable[str], file: str = "") -> MarkerSet:
    """Bundled set of which most markers are there, with all landmarks standing and three points a segment walking.

    >>> legs = [f"{side}{name}" for side in "LR" for name in ("ASI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE")]
    >>> recognise_marker_set(["SACR", *legs], ["SACR", *legs]).name
    'plug_in_gait'
    """
    static, trial = list(static), list(trial)
    fitting, nearest = [], []
    for candidate in read_marker_sets().values():
        there, followed = candidate.names(static), candidate.names(trial)
        lacking, both = candidate.lacking(there), set(there) & set(followed)
        for followers in map(candidate.followers, SEGMENTS):
            absent = [name for name in followers if name not in both and name not in METHODS]
            lacking += absent if len(followers) - len(absent) < FEWEST_POINTS else []
        lacking = list(dict.fromkeys(lacking))
        if lacking:
            nearest.append((len(lacking), len(candidate.markers()), candidate.name, lacking))
        else:
            count = len(set(there) | set(followed))
            fitting.append(((count, count - len(candidate.markers())), candidate))
    if fitting:
        return max(fitting, key=lambda pair: pair[0])[1]
    *_, name, lacking = min(nearest)
    raise ChannelError(
        f"the markers must belong to one of the sets {', '.join(read_marker_sets())}",
        f"{file or 'the static trial'} has {list_names(static, none='no markers')}; the nearest set is {name}, which "
        f"also needs {list_names(lacking)}",
        "Name the marker set, rename the markers, or write your own set as docs/kinematics.md shows.",
    )
