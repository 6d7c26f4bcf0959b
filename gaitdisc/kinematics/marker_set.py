"""A marker set: which marker lies on which landmark, and which markers follow which segment."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from gaitdisc.channel import folded_label, nearest_word
from gaitdisc.errors import SchemaError

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
METHODS = {
    "hip": ("harrington", "davis"),
    "knee": ("midpoint", "chord"),
    "ankle": ("midpoint", "chord"),
}
AXES = {"shank": ("ankle", "knee"), "foot": ("flat", "as placed")}
JOINTS = ("free", "held", "planar")
PARTS = ("pelvis", "thigh", "shank", "foot")
PLACEHOLDER = re.compile(r"\{(S|s|side)\}")


@dataclass(frozen=True)
class MarkerSet:
    """Markers of one laboratory's convention.

    >>> from gaitdisc.kinematics.marker_set_file import marker_set
    >>> marker_set("plug_in_gait").tracked["thigh"]
    ('hip', '{S}THI', '{S}KNE')
    """

    name: str  # name of its file without the ending
    title: str  # what it is and where it is described
    citation: str  # what it is and where it is described
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
            near = nearest_word(joints, JOINTS)
            found = f"found {joints!r}" + (f", the nearest is {near!r}" if near else "")
            raise SchemaError(f"joints are {', '.join(JOINTS)}", found, "Correct the word.")
        return replace(self, joints=joints)

    def with_hip(self, method: str) -> MarkerSet:
        """Return the same set with another hip joint centre."""
        if method not in METHODS["hip"]:
            near = nearest_word(method, METHODS["hip"])
            found = f"found {method!r}" + (f", the nearest is {near!r}" if near else "")
            raise SchemaError(f"hip joint centres are {', '.join(METHODS['hip'])}", found, "Correct the word.")
        return replace(self, joint_centres={**self.joint_centres, "hip": (method,)})

    def names(self, labels: Iterable[str]) -> dict[str, str]:
        """Names in this set of the labels of a recording: set's name -> label.

        labels: markers as the file has them. Case, blanks and punctuation do not count; a label that is the set's own
            name comes before one that is an alias

        >>> from gaitdisc.kinematics.marker_set_file import marker_set
        >>> marker_set("helen_hayes").names(["R.ASIS", "RKNEE"])
        {'RASI': 'R.ASIS', 'RKNE': 'RKNEE'}
        """
        by_fold: dict[str, str] = {}
        for label in labels:
            by_fold.setdefault(folded_label(label), label)
        others: dict[str, list[str]] = {}
        for key, side, alias in self._alias_list():
            others.setdefault(sided(key, side), []).append(sided(alias, side))
        found = {}
        for name in self.markers():
            own = (name, *others.get(name, ()))
            label = next((by_fold[f] for f in map(folded_label, own) if f in by_fold), None)
            if label is not None:
                found[name] = label
        return found

    def _alias_list(self) -> list[tuple[str, str, str]]:
        return [(key, side, alias) for key, several in self.aliases.items() for alias in several for side in "lr"]

    def markers(self) -> tuple[str, ...]:
        """Every marker that landmarks or segments name, both sides, in order."""
        named = [marker for text in self.landmarks.values() for choice in choices(text) for marker in choice]
        named += [marker for several in self.tracked.values() for marker in several if marker not in METHODS]
        return tuple(dict.fromkeys(sided(marker, side) for marker in named for side in "lr"))

    def sided_pairs(self, names: Iterable[str]) -> list[tuple[str, str]]:
        """Left marker and right marker of each pair that is there, in the names of this set."""
        there = set(names)
        named = [marker for text in self.landmarks.values() for choice in choices(text) for marker in choice]
        named += [marker for several in self.tracked.values() for marker in several]
        pairs = dict.fromkeys((sided(marker, "l"), sided(marker, "r")) for marker in named)
        return [(left, right) for left, right in pairs if left != right and there.issuperset((left, right))]

    def followers(self, segment: str) -> tuple[str, ...]:
        """Points that follow a segment: markers by the names of this set, `hip`, `knee`, `ankle` for a joint centre.

        >>> from gaitdisc.kinematics.marker_set_file import marker_set
        >>> marker_set("plug_in_gait").followers("shank_r")
        ('knee', 'RTIB', 'RANK')
        """
        part, _, side = segment.partition("_")
        return on_sides(self.tracked[part], side or "lr")

    def landmark(self, key: str, side: str, names: Iterable[str]) -> tuple[str, ...]:
        """Markers of a landmark, of which it is the midpoint: the first choice that is there, empty where none is.

        names: markers that are there, in the names of this set

        >>> from gaitdisc.kinematics.marker_set_file import marker_set
        >>> marker_set("plug_in_gait").landmark("sacrum", "l", ["LPSI", "RPSI"])
        ('LPSI', 'RPSI')
        """
        there = set(names)
        for choice in choices(self.landmarks.get(key, "")):
            markers = tuple(sided(marker, side) for marker in choice)
            if there.issuperset(markers):
                return markers
        return ()

    def lacking(self, names: Iterable[str]) -> list[str]:
        """Markers that a static trial must have and that are not there; of several choices the first is named.

        names: markers that are there, in the names of this set
        """
        there = set(names)
        absent = []
        for key in self.needed_landmarks(there):
            for side in "lr":
                if not self.landmark(key, side, there):
                    first = (sided(marker, side) for marker in choices(self.landmarks[key])[0])
                    absent += [marker for marker in first if marker not in there]
        return list(dict.fromkeys(absent))

    def needed_landmarks(self, names: Iterable[str]) -> list[str]:
        """Landmarks without which no frame can be built from these markers.

        names: markers that are there, in the names of this set
        """
        there = set(names)
        needed: list[str] = list(NEEDED)
        for joint, wand in (("knee", "thigh_wand"), ("ankle", "shank_wand")):
            methods = self.joint_centres[joint]
            medial = all(self.landmark(f"{joint}_medial", side, there) for side in "lr")
            by_midpoint = "midpoint" in methods and (medial or "chord" not in methods)
            needed.append(f"{joint}_medial" if by_midpoint else wand)
        return needed


def sided(name: str, side: str) -> str:
    """Name of a marker on one side.

    name: with `{S}` (R, L), `{s}` (r, l) or `{side}` (right, left), or without

    >>> sided("{S}ASI", "l"), sided("knee_{side}", "r")
    ('LASI', 'knee_right')
    """
    words = {"S": side.upper(), "s": side, "side": {"l": "left", "r": "right"}[side]}
    return PLACEHOLDER.sub(lambda found: words[found[1]], name)


def on_sides(points: Iterable[str], sides: str) -> tuple[str, ...]:
    """Names of points on one side or on both, each once.

    >>> on_sides(["{S}ASI", "SACR"], "lr")
    ('LASI', 'RASI', 'SACR')
    """
    return tuple(dict.fromkeys(sided(point, side) for point in points for side in sides))


def choices(text: str) -> list[tuple[str, ...]]:
    """Markers of each choice of a landmark.

    >>> choices("SACR | LPSI + RPSI")
    [('SACR',), ('LPSI', 'RPSI')]
    """
    return [tuple(part.strip() for part in choice.split("+")) for choice in text.split("|")] if text.strip() else []
