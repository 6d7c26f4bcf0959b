"""Marker sets as TOML files: those that come along, a laboratory's own, and the one that labels are of."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from gaitdisc.channel import nearest_word, schema_folder
from gaitdisc.errors import ChannelError, ReadError, SchemaError
from gaitdisc.kinematics.marker_set import (
    AXES,
    JOINTS,
    LANDMARKS,
    METHODS,
    NEEDED,
    PARTS,
    PLACEHOLDER,
    SIDED,
    MarkerSet,
    choices,
    on_sides,
)
from gaitdisc.kinematics.pose import FEWEST_POINTS, SEGMENTS
from gaitdisc.regular_file import check_regular
from gaitdisc.toml_text import parsed_toml

LARGEST_BYTES = 2**20


def marker_set(name: str | Path) -> MarkerSet:
    """Marker set that comes along, by its name, or a laboratory's own, by the path of its file."""
    shipped = shipped_marker_sets()
    if isinstance(name, str) and name in shipped:
        return shipped[name]
    if str(name).endswith(".toml"):
        return read_marker_set(Path(name))
    near = nearest_word(str(name), shipped)
    raise SchemaError(
        f"a marker set is one of {', '.join(shipped)}, or a file that ends in .toml",
        f"found {str(name)!r}" + (f", the nearest is {near!r}" if near else ""),
        "Correct the name, or write the file as docs/kinematics.md shows.",
    )


@cache
def shipped_marker_sets() -> dict[str, MarkerSet]:
    """Marker sets that come along, by name."""
    paths = sorted((schema_folder() / "marker_sets").glob("*.toml"))
    return {path.stem: read_marker_set(path) for path in paths}


def read_marker_set(path: Path) -> MarkerSet:
    """Marker set of a TOML file.

    path: file with the tables `[landmarks]`, `[joint_centres]`, `[tracked]`; `[aliases]`, `[axes]` and `joints` may be
        left out
    """
    try:
        check_regular(path, LARGEST_BYTES)
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = "it is no UTF-8 text" if isinstance(error, UnicodeDecodeError) else error.strerror
        raise ReadError("a marker set is read from a file", f"{path.name}: {reason}", "Check the path.") from error
    try:
        table = parsed_toml(text)
    except tomllib.TOMLDecodeError as error:
        raise SchemaError(
            "a marker set is a TOML file", f"{path.name}: {error}", "See docs/kinematics.md for an example."
        ) from error
    return _checked(table, path)


def _checked(table: dict[str, Any], path: Path) -> MarkerSet:
    file = path.name
    _check_words(
        table, ("title", "citation", "aliases", "landmarks", "joint_centres", "axes", "joints", "tracked"), "", file
    )
    parts = {key: _table(table, key, file) for key in ("aliases", "landmarks", "joint_centres", "axes", "tracked")}
    landmarks = {key: _text(value, f"landmarks.{key}", file) for key, value in parts["landmarks"].items()}
    _check_landmarks(landmarks, file)
    methods = {
        joint: tuple(part.strip() for part in _text(value, f"joint_centres.{joint}", file).split("|"))
        for joint, value in parts["joint_centres"].items()
    }
    _check_methods(methods, landmarks, file)
    axes = {key: _text(value, f"axes.{key}", file) for key, value in parts["axes"].items()}
    _check_words(axes, tuple(AXES), "axes.", file)
    for key, value in axes.items():
        _check_words([value], AXES[key], f"axes.{key} = ", file)
    joints = _text(table.get("joints", JOINTS[0]), "joints", file)
    _check_words([joints], JOINTS, "joints = ", file)
    tracked = {key: _texts(value, f"tracked.{key}", file) for key, value in parts["tracked"].items()}
    _check_tracked(tracked, file)
    return MarkerSet(
        path.stem,
        _text(table.get("title", path.stem), "title", file),
        _text(table.get("citation", ""), "citation", file),
        {key: _texts(value, f"aliases.{key}", file) for key, value in parts["aliases"].items()},
        landmarks,
        methods,
        {"shank": "ankle", "foot": "flat", **axes},
        joints,
        tracked,
    )


def _refusal(needed: str, found: str, remedy: str = "See docs/kinematics.md for an example.") -> SchemaError:
    return SchemaError(needed, found, remedy)


def _table(table: dict[str, Any], key: str, file: str) -> dict[str, Any]:
    part = table.get(key, {})
    if not isinstance(part, dict):
        raise _refusal(f"{key} of a marker set is a table", f"{file}: found {part!r}")
    return part


def _text(value: Any, where: str, file: str) -> str:
    if not isinstance(value, str):
        raise _refusal(f"{where} of a marker set is a text", f"{file}: found {value!r}")
    return value


def _texts(value: Any, where: str, file: str) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(item, str) and item for item in value):
        raise _refusal(f"{where} of a marker set is a list of names", f"{file}: found {value!r}")
    return tuple(value)


def _check_words(words: Iterable[str], known: Sequence[str], where: str, file: str) -> None:
    for word in words:
        if word not in known:
            near = nearest_word(word, known)
            hint = f", the nearest is {near!r}" if near else ""
            raise _refusal(f"{where or 'a marker set '}takes {', '.join(known)}", f"{file}: found {word!r}{hint}")


def _check_landmarks(landmarks: Mapping[str, str], file: str) -> None:
    _check_words(landmarks, LANDMARKS, "landmarks.", file)
    absent = [key for key in NEEDED if not choices(landmarks.get(key, ""))]
    if absent:
        raise _refusal(f"[landmarks] of a marker set needs {', '.join(NEEDED)}", f"{file} has no {absent[0]}")
    for key, text in landmarks.items():
        empty = not all(all(choice) for choice in choices(text))
        if empty or (key in SIDED and not PLACEHOLDER.search(text)):
            needed = f"landmarks.{key} names markers" + (" of both sides with {S}, {s} or {side}" * (key in SIDED))
            raise _refusal(needed, f"{file}: found {text!r}", f'Write it as {key} = "{{S}}NAME", for RNAME and LNAME.')


def _check_methods(methods: Mapping[str, tuple[str, ...]], landmarks: Mapping[str, str], file: str) -> None:
    _check_words(methods, tuple(METHODS), "joint_centres.", file)
    for joint, known in METHODS.items():
        if joint not in methods:
            raise _refusal(f"[joint_centres] needs {', '.join(METHODS)}", f"{file} has no {joint}")
        _check_words(methods[joint], known, f"joint_centres.{joint} = ", file)
    for joint, wand in (("knee", "thigh_wand"), ("ankle", "shank_wand")):
        for method, landmark in (("midpoint", f"{joint}_medial"), ("chord", wand)):
            if method in methods[joint] and landmark not in landmarks:
                raise _refusal(
                    f"joint_centres.{joint} = {method!r} needs landmarks.{landmark}", f"{file} does not name it"
                )


def _check_tracked(tracked: Mapping[str, tuple[str, ...]], file: str) -> None:
    _check_words(tracked, PARTS, "tracked.", file)
    for part, above in zip(PARTS, ((), ("hip",), ("knee",), ("ankle",)), strict=True):
        points = on_sides(tracked.get(part, ()), "lr" if part == "pelvis" else "r")
        if len(points) < FEWEST_POINTS:
            raise _refusal(
                f"tracked.{part} needs {FEWEST_POINTS} points or more", f"{file} has {len(points)}: {', '.join(points)}"
            )
        wrong = [point for point in points if point in METHODS and point not in above]
        if wrong:
            raise _refusal(
                f"tracked.{part} may name the joint centre above it ({', '.join(above) or 'none'})",
                f"{file} names {wrong[0]!r}",
            )


def recognised_marker_set(static: Iterable[str], trial: Iterable[str], file: str = "") -> MarkerSet:
    """Marker set that comes along and that the labels are of.

    returns: of those for which the static trial has all landmarks and the trial three points a segment: the one of
        which most markers are there

    >>> legs = [f"{side}{name}" for side in "LR" for name in ("ASI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE")]
    >>> recognised_marker_set(["SACR", *legs], ["SACR", *legs]).name
    'plug_in_gait'
    """
    static, trial = list(static), list(trial)
    fitting, nearest = [], []
    for one in shipped_marker_sets().values():
        there, followed = one.names(static), one.names(trial)
        lacking = list(dict.fromkeys(one.lacking(there) + _untracked(one, set(there) & set(followed))))
        if lacking:
            nearest.append((len(lacking), len(one.markers()), one.name, lacking))
        else:
            found = len(set(there) | set(followed))
            fitting.append(((found, found - len(one.markers())), one))
    if fitting:
        return max(fitting, key=lambda pair: pair[0])[1]
    *_, name, lacking = min(nearest)
    raise ChannelError(
        f"the markers need to be of one of the sets {', '.join(shipped_marker_sets())}",
        f"{file or 'the static trial'} has {_some(static)}; the nearest set is {name}, which lacks {_some(lacking)}",
        "Give the marker set, rename the markers, or write a set of your own as docs/kinematics.md shows.",
    )


def _untracked(one: MarkerSet, there: set[str]) -> list[str]:
    """Markers that follow a segment of which fewer than three points are there."""
    absent = []
    for segment in SEGMENTS:
        names = one.followers(segment)
        if sum(name in there or name in METHODS for name in names) < FEWEST_POINTS:
            absent += [name for name in names if name not in there and name not in METHODS]
    return list(dict.fromkeys(absent))


def _some(names: Sequence[str], most: int = 6) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return (", ".join(names[:most]) or "no markers") + more
