"""A person's segments as the static trial shows them: frames, joint centres, and where the markers lie in them.

Labels that contradict where the landmarks of a standing person lie to each other, whoever it is, are found first.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from gaitdisc.errors import ChannelError, SamplingError, ShapeError
from gaitdisc.kinematics.marker_set import METHODS, PARTS, SIDED, MarkerSet
from gaitdisc.kinematics.markers import check_right_handed, marker_labels, still_places, up_axis
from gaitdisc.kinematics.pose import FEWEST_POINTS, SEGMENTS, SEGMENTS_OF, Pose, chord_centre, davis_hip, harrington_hip
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.trial import BodyMeasures

STANDS_M = 0.03  # who stands sways less than this in half a second
USUAL_DIAMETER_M = 0.014
RIGHTWARD = {"l": -1.0, "r": 1.0}  # sign of what points outward

Points = Mapping[str, Values]
MARKS = {
    "pelvis": ("asis", "sacrum"),
    "thigh": ("knee_lateral", "knee_medial"),
    "shank": ("ankle_lateral", "ankle_medial"),
    "foot": ("heel", "toe"),
}
SIDE_BY_SIDE_M = 0.01  # a right marker this far to the left of its left one is exchanged
DOWN_THE_LEG = ("thigh_wand", "knee_lateral", "shank_wand", "ankle_lateral")
ABOVE = (("pelvis", "thigh"), ("pelvis", "shank"), ("pelvis", "foot"), ("thigh", "foot"), ("shank", "foot"))


@dataclass(frozen=True, eq=False)
class Calibration:
    """What the static trial says of a person; trials of the same session and markers are read with it."""

    marker_set: MarkerSet
    # each (3,) [m], segment -> point that follows it (marker, by the name of the set, or `hip`, `knee`, `ankle`) ->
    # place in the segment's frame
    body: Mapping[str, Points]
    # each (3,) [m], segment -> joint centre or landmark (`hip_r`, `knee_r`, `heel_r`, `asis_l`, ...) -> place in its
    # frame
    points: Mapping[str, Points]
    findings: tuple[Finding, ...] = ()
    # each (3,) [m], marker -> where it lay in the static trial
    places: Points = field(default_factory=dict)
    spoiled: tuple[str, ...] = ()  # segments that exchanged labels of the static trial make unknown


def calibrate_body(
    static: Recording, marker_set: MarkerSet, measures: BodyMeasures | None = None, hips: Points | None = None
) -> Calibration:
    """Frames, joint centres and marker places of a person from the static trial.

    measures: widths of knee and ankle, distance of the iliac spines, leg lengths, diameter of the markers. What the
        static trial shows itself (both condyles, both malleoli) needs none
    hips each (3,) [m]: `hip_l`, `hip_r` in the pelvis' frame, as `functional_hips` finds them; of the marker set where
        there is none
    """
    file = static.source.file or "the static trial"
    names = marker_set.names(marker_labels(static))
    _check_complete(marker_set, names, file)
    needed = [(key, side) for key in marker_set.list_needed_landmarks(names) for side in "lr"]
    markers = dict.fromkeys(marker for key, side in needed for marker in marker_set.landmark(key, side, names))
    places, moved, start = still_places(static, names, [*markers])
    _check_complete(marker_set, places, file)
    if moved > STANDS_M:
        raise SamplingError(
            f"in a static trial the markers must stay within {STANDS_M * 1000:.0f} mm for half a second",
            f"in {file} they move by {moved * 1000:.0f} mm in the stillest half second, at {start:.2f} s",
            "Use the trial in which the person stands.",
        )
    return _Builder(marker_set, places, measures or BodyMeasures(), file, hips or {}).calibration()


def _check_complete(marker_set: MarkerSet, names: Mapping, file: str) -> None:
    lacking = marker_set.lacking(names)
    if lacking:
        several = f" and {len(lacking) - 1} more: {', '.join(lacking[1:6])}" if len(lacking) > 1 else ""
        raise ChannelError(
            f"the static trial must have every landmark of the marker set {marker_set.name}",
            f"{file} has no {lacking[0]}{several}",
            "Name the marker in the set's [aliases], or choose the marker set that matches the labels of the file.",
        )


class _Builder:
    """Builds the segments of one static trial, from the pelvis down."""

    def __init__(self, marker_set: MarkerSet, places: Points, measures: BodyMeasures, file: str, hips: Points) -> None:
        self.marker_set, self.places, self.measures, self.file = marker_set, places, measures, file
        self.hips = hips
        self.findings: list[Finding] = []
        self.exchanged: tuple[str, ...] = ()
        self.centres: dict[str, Values] = {}
        self.static: dict[str, Pose] = {}
        self.up = np.zeros(3)

    def calibration(self) -> Calibration:
        """Frames of all segments, and what lies where in them."""
        middle = (self._place("asis", "l") + self._place("asis", "r")) / 2
        feet = np.mean([self._place(key, side) for key in ("heel", "toe") for side in "lr"], axis=0)
        self.up = up_axis(middle[None], feet[None], self.file)
        self._mend_labels()
        self._pelvis()
        check_right_handed(self.static["pelvis"].rotation, self.up, self.file)
        for side in "lr":
            self._leg(side)
            self._foot(side)
        body = {segment: self._followers(segment) for segment in SEGMENTS}
        points = {segment: self._points(segment) for segment in SEGMENTS}
        return Calibration(
            self.marker_set,
            body=MappingProxyType(body),
            points=MappingProxyType(points),
            findings=tuple(self.findings),
            places=MappingProxyType(dict(self.places)),
            spoiled=self._list_spoiled(),
        )

    def _place(self, key: str, side: str) -> Values:
        return np.mean([self.places[marker] for marker in self._labels(key, side)], axis=0)

    def _labels(self, key: str, side: str) -> tuple[str, ...]:
        return self.marker_set.landmark(key, side, self.places)

    def _has(self, key: str) -> bool:
        return all(self._labels(key, side) for side in "lr")

    def _note(self, kind: str, what: str, spoils: str = "", severity: str = "note") -> None:
        self.findings.append(Finding(severity, kind, self.file, what, spoils))

    def _pelvis(self) -> None:
        left, right = self._place("asis", "l"), self._place("asis", "r")
        middle = (left + right) / 2
        sacrum: Values = np.mean([self._place("sacrum", side) for side in "lr"], axis=0)
        across, ahead = right - left, middle - sacrum
        self.static["pelvis"] = Pose(middle[None], _axes(across, np.cross(across, ahead), self.file, "pelvis"))
        width, depth = float(np.linalg.norm(across)), float(np.linalg.norm(ahead))
        if self.measures.inter_asis_m is not None:
            what = f"the measured distance of the iliac spines is {self.measures.inter_asis_m * 1000:.0f} mm, "
            self._note("pelvis width", f"{what}but the markers are {width * 1000:.0f} mm apart")
            width = self.measures.inter_asis_m
        for side in "lr":
            hip = self.hips.get(f"hip_{side}")
            hip = self._hip(side, width, depth) if hip is None else hip
            self.centres[f"hip_{side}"] = self.static["pelvis"].to_laboratory(hip)[0]

    def _hip(self, side: str, width: float, depth: float) -> Values:
        legs = self.measures.leg_length_m
        methods = self.marker_set.joint_centres["hip"]
        if methods[0] == "davis" and set(legs) == {"l", "r"}:
            return davis_hip(width, (legs["l"] + legs["r"]) / 2, legs[side], self._radius(), side)
        if "harrington" not in methods:
            raise ChannelError(
                "for the hip joint centre after Davis, the lengths of both legs must be known",
                f"{self.file} and the measures have {f'only that of side {next(iter(legs))}' if legs else 'none'}",
                'Provide leg_length_m, or use hip = "harrington".',
            )
        if methods[0] == "davis" and side == "l":
            what = f"hip centres follow Harrington, not Davis: {self.file} and the measures lack a leg length"
            self._note("hip", what, "hip centres by 1 to 2 cm compared with Plug-in Gait")
        return harrington_hip(width, depth, side)

    def _radius(self) -> float:
        diameter = self.measures.marker_diameter_m
        if diameter is None:
            diameter = USUAL_DIAMETER_M
            if not any(finding.kind == "marker diameter" for finding in self.findings):
                what = f"the diameter of the markers is unknown; {diameter * 1000:.0f} mm is assumed"
                self._note("marker diameter", what, "joint centres by a few mm if the diameter differs")
        return diameter / 2

    def _centre(self, joint: str, side: str, above: str, wand: str) -> Values:
        """Joint centre by midpoint or chord."""
        lateral = self._place(f"{joint}_lateral", side)
        if "midpoint" in self.marker_set.joint_centres[joint] and self._has(f"{joint}_medial"):
            return (lateral + self._place(f"{joint}_medial", side)) / 2
        distance = self._width(joint, side) / 2 + self._radius()
        return chord_centre(self.centres[f"{above}_{side}"], self._place(wand, side), lateral, distance)

    def _width(self, joint: str, side: str) -> float:
        widths = self.measures.knee_width_m if joint == "knee" else self.measures.ankle_width_m
        if side in widths:
            return widths[side]
        if self._has(f"{joint}_medial"):
            apart = self._place(f"{joint}_lateral", side) - self._place(f"{joint}_medial", side)
            width = float(np.linalg.norm(apart)) - 2 * self._radius()
            self._note("width", f"the width of {joint}_{side}, between its two markers, is {width * 1000:.0f} mm")
            return width
        raise ChannelError(
            f"for a {joint} joint centre from one lateral marker, the width of the {joint} must be known",
            f"neither {self.file} nor the measures have it for side {side!r}",
            f"Provide {joint}_width_m, or add a medial marker in the static trial.",
        )

    def _leg(self, side: str) -> None:
        """Frames of thigh and shank, whose y points up to the joint above."""
        for segment, above, joint in (("thigh", "hip", "knee"), ("shank", "knee", "ankle")):
            centre = self._centre(joint, side, above, f"{segment}_wand")
            self.centres[f"{joint}_{side}"] = centre
            of = self.marker_set.axes.get(segment, joint)  # a thigh's is always its knee
            to_right = (self._place(f"{of}_lateral", side) - self.centres[f"{of}_{side}"]) * RIGHTWARD[side]
            origin = self.centres[f"{above}_{side}"]
            axes = _axes(to_right, origin - centre, self.file, f"{segment}_{side}", "y")
            self.static[f"{segment}_{side}"] = Pose(origin[None], axes)

    def _foot(self, side: str) -> None:
        along = self._place("toe", side) - self._place("heel", side)
        if self.marker_set.axes["foot"] == "flat":
            along = along - float(along @ self.up) * self.up
        right: Values = np.cross(along, self.up)
        upward: Values = np.cross(right, along)
        axes = _axes(right, upward, self.file, f"foot_{side}")
        self.static[f"foot_{side}"] = Pose(self.centres[f"ankle_{side}"][None], axes)

    def _followers(self, segment: str) -> dict[str, Values]:
        """Points that follow a segment, in its frame; those that the static trial lacks are left out and said."""
        followers, absent = {}, []
        for point in self.marker_set.followers(segment):
            place = self.centres[f"{point}{segment[-2:]}"] if point in METHODS else self.places.get(point)
            if place is None:
                absent.append(point)
            else:
                followers[point] = self.static[segment].to_segment(place[None])[0]
        if len(followers) < FEWEST_POINTS:
            raise ChannelError(
                f"segment {segment} must have at least {FEWEST_POINTS} points",
                f"{self.file} has {', '.join(followers) or 'none'}; missing: {', '.join(absent)}",
                "Attach the missing markers, or choose the marker set that matches the labels of the file.",
            )
        return followers

    def _points(self, segment: str) -> dict[str, Values]:
        part, _, side = segment.partition("_")
        sides, joints = side or "lr", [joint for joint, parts in SEGMENTS_OF.items() if part in parts]
        places = {f"{joint}_{s}": self.centres[f"{joint}_{s}"] for joint in joints for s in sides}
        places |= {f"{mark}_{s}": self._place(mark, s) for mark in MARKS[part] if self._has(mark) for s in sides}
        return {name: self.static[segment].to_segment(place[None])[0] for name, place in places.items()}

    def _mend_labels(self) -> None:
        """Exchange two labels that contradict the order of landmarks, so that the other leg is built, and say so."""
        wrong = min(landmark_order(self.marker_set, self.places, self.up))
        if wrong[0] > 0:
            return
        pair = find_exchanged_in_static(self.marker_set, self.places, self.up)
        if pair is None:
            self._pelvis()
            check_right_handed(self.static["pelvis"].rotation, self.up, self.file)
            raise ShapeError(
                "the landmarks of a static trial must lie in anatomical order",
                f"in {self.file} {wrong[1]} ({-wrong[0] * 1000:.0f} mm)",
                "Correct the labels, or record the person with the legs side by side.",
            )
        self.places = swap(self.places, pair)
        self.exchanged = pair
        what = f"{wrong[1]}: exchanging {' and '.join(pair)} in the static trial corrects this"
        spoils = "the segments of these markers and those distal to them; correct the labels"
        self._note("exchanged markers", what, spoils, "warning")

    def _list_spoiled(self) -> tuple[str, ...]:
        """Segments that hold an exchanged marker, and those below them."""
        spoiled: list[str] = []
        for segment in SEGMENTS:
            part, _, side = segment.partition("_")
            marks = [marker for mark in MARKS[part] for s in side or "lr" for marker in self._labels(mark, s)]
            wands = self._labels(f"{part}_wand", side) if side else ()
            above = "pelvis" in spoiled or any(segment.endswith(f"_{side}") for segment in spoiled if side)
            if above or set(self.exchanged) & {*self.marker_set.followers(segment), *marks, *wands}:
                spoiled.append(segment)
        return tuple(spoiled)


def _axes(right: Values, up: Values, file: str, segment: str, kept: str = "z") -> Values:
    """Rotation (1, 3, 3) with z to the right and y up; one keeps its direction, the other is made square."""
    forward = np.cross(up, right)
    size = float(np.linalg.norm(forward))
    if not size > 1e-3 * float(np.linalg.norm(up) * np.linalg.norm(right)) or not size > 0:
        raise ShapeError(
            f"landmarks of {segment} must span a plane", f"in {file} they are collinear", "Check these markers."
        )
    x = forward / size
    if kept == "y":
        y = up / np.linalg.norm(up)
        return np.stack([x, y, np.cross(x, y)], axis=1)[None]
    z = right / np.linalg.norm(right)
    return np.stack([x, np.cross(z, x), z], axis=1)[None]


def landmark_order(marker_set: MarkerSet, places: Points, up: Values) -> list[tuple[float, str]]:
    """By how much each landmark of a standing person is on its side of another [m]; below 0 a label is wrong, as said.

    Right is right of left, the leg's landmarks come down in their order, ankle between heel and toe, and pelvis and
    toes point to the same side. Joints that are bent and feet that turn by less than 90 deg do not change that.
    """
    labels = {(key, side): marker_set.landmark(key, side, places) for key in (*SIDED, "sacrum") for side in "lr"}
    at = {(name,): np.asarray(place) for name, place in places.items()}
    at |= {names: np.mean([places[name] for name in names], axis=0) for names in labels.values() if names}
    pairs = marker_set.list_sided_pairs(places)
    across = np.sum([places[right] - places[left] for left, right in pairs], axis=0)
    across -= (across @ up) * up
    across = across / np.linalg.norm(across)
    forward = np.cross(up, across)
    order = [((right,), "to the right of", (left,), across) for left, right in pairs]
    for side, outward in (("l", -across), ("r", across)):
        knee, ankle, heel, toe = (labels[key, side] for key in ("knee_lateral", "ankle_lateral", "heel", "toe"))
        along = (at[toe] - at[heel]) / np.linalg.norm(at[toe] - at[heel])
        leg = [labels[key, side] for key in DOWN_THE_LEG if labels[key, side]]
        order += [(upper, "above", lower, up) for upper, lower in itertools.pairwise(leg)]
        order += [(toe, "ahead of", heel, forward), (ankle, "ahead of", heel, along), (toe, "ahead of", ankle, along)]
        order += [(knee, "outside of", labels["knee_medial", side], outward)]
        order += [(ankle, "outside of", labels["ankle_medial", side], outward)]
        segments = {part: marker_set.followers(f"{part}_{side}" if part != "pelvis" else part) for part in PARTS}
        on = {part: [(name,) for name in names if name in places] for part, names in segments.items()}
        on["shank"] = [name for name in on["shank"] if name[0] not in ankle]
        order += [(a, "above", b, up) for above, below in ABOVE for a, b in itertools.product(on[above], on[below])]
        front = itertools.product(labels["asis", side], labels["sacrum", side])
        order += [((spine,), "ahead of", (back,), forward) for spine, back in front]
    slack = {"to the right of": SIDE_BY_SIDE_M}
    return [
        (float((at[a] - at[b]) @ way) + slack.get(words, 0.0), f"{' + '.join(a)} is not {words} {' + '.join(b)}")
        for a, words, b, way in order
        if b
    ]


def find_exchanged_in_static(marker_set: MarkerSet, places: Points, up: Values) -> tuple[str, str] | None:
    """Pair of markers whose exchange puts all landmarks right, by the most; None where no pair does."""
    names = [name for name in marker_set.markers() if name in places]
    ranked = [
        (min(landmark_order(marker_set, swap(places, pair), up))[0], pair) for pair in itertools.combinations(names, 2)
    ]
    margin, pair = max(ranked)
    return pair if margin > 0 else None


def swap(places: Points, pair: Sequence[str]) -> dict[str, Values]:
    """Same places, those of two markers exchanged."""
    first, second = pair
    return {**places, first: places[second], second: places[first]}
