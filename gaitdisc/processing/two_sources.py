"""Two sources of a trial against each other: what markers, the other leg or mechanics contradict is left out and said.

An unusual value alone leaves nothing out: a stiff knee is as stiff in its markers, and its power is still its moment
times its rate.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import spearmanr

from gaitdisc.errors import GaitdiscError
from gaitdisc.kinematics.joint_centres import hip_of_spines
from gaitdisc.kinematics.marker_set_file import shipped_marker_sets
from gaitdisc.kinematics.markers import marker_labels, marker_places
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.strides import interpolated

KIND = "two sources"
# Angles of files follow the lines between single markers: r >= .85, slopes .88 to 1.33, offsets within 7 deg of these
# and 6.4 deg apart from left to right (8 walks). Half, double, or 12 deg from left to right is no choice of axes.
USUAL_OFFSET_DEG = {"hip_flexion": 0.0, "hip_adduction": 5.0, "knee_angle": -4.0, "ankle_angle": -8.0}
SCALE, OFFSET_DEG = 2.0, 12.0
POWER_SCALE = 3.0  # power over moment times rate in the plane of walking: .87 to 1.13, r >= .83 in the same walks
AGAINST = 0.4  # correlation of what has the other sign; a right sign gives -.36 or less, or .83 or more
FEWEST, MOVES_DEG = 20, 10.0  # samples; range of a joint that says something
OTHER_PLACE_DEG = 75.0  # from the median: in these frames a marker bears another's label
WALKS_DEG, WALKS_RAD = 15.0, (0.6, 2.5)  # widest range of hips and knees; who stands sways by less than 0.6 deg
STILL_DEG, STILL_OTHER_DEG, LOCKED_DEG = 1.5, 0.6, 0.015  # skin alone moves markers by more; a model's locked joint
LEAST_MOMENT = {"N m/kg": 0.03, "N m": 0.4}  # largest of all: standing has 0.2 N m/kg, a walking child of 5 kg 1 N m
LEAST_SHARE = {"flexion": 1 / 300, "": 1 / 3000}  # of the largest; a leg that only swings has 1/10, its ankle 1/100
_FLEXION = re.compile(r"(hip_flexion|knee_angle|ankle_angle)_[rl](_moment)?")
_ANGLE = re.compile(
    r"(hip_(flexion|adduction|rotation)|knee_(angle|adduction|rotation)|ankle_angle|foot_progression_angle)_[rl]|"
    r"pelvis_(tilt|list|rotation)|[RL](Pelvis|FootProgress)Angles\.[xyz]"
)


class _Contradiction(NamedTuple):
    stream: str
    names: Sequence[str]  # channels that cannot be what they say
    what: str


def without_contradicted(trial: Trial) -> Trial:
    """Trial without the channels that another source of it contradicts in unit, sign or level; each is a finding."""
    for check in (_in_radians, _against_markers, _turned_hips, _small_moments, _powers, _turned_moments):
        for one in check(trial):
            recording = trial.stream(one.stream)
            kept = [name for name in recording.names if name not in one.names]
            streams = {key: value for key, value in trial.streams.items() if key != one.stream}
            streams |= {one.stream: recording.selected(kept)} if kept else {}
            spoils = "these channels: they are left out; correct the file"
            said = Finding("warning", KIND, recording.source.file, one.what, spoils, ", ".join(one.names))
            trial = replace(trial, streams=streams, findings=(*trial.findings, said))
    return trial


def line_angles(markers: Recording) -> dict[str, NDArray[np.float64]]:
    """Angles between the lines from hip to knee to ankle and from heel to toe, without a static trial.

    returns each (frame,) [deg]: hip flexion and adduction, knee and ankle angles that there are markers for
    """
    labels = marker_labels(markers)
    known = max(shipped_marker_sets().values(), key=lambda one: len(one.names(labels)))
    own, found, lines = known.names(labels), {}, {}
    for side, outward in (("l", -1.0), ("r", 1.0)):
        seen = {
            key: marker_places(markers, [own[name] for name in names]).mean(axis=1)
            for key in ("knee_lateral", "ankle_lateral", "heel", "toe", "sacrum")
            if (names := known.landmark(key, side, own))
        }
        spines = [known.landmark("asis", each, own) for each in "lr"]
        if all(spines) and "sacrum" in seen:
            left, right = (marker_places(markers, [own[name] for name in each]).mean(axis=1) for each in spines)
            seen["hip"] = hip_of_spines(left, right, seen["sacrum"], side)
        ends = {"thigh": ("hip", "knee_lateral"), "shank": ("knee_lateral", "ankle_lateral"), "foot": ("heel", "toe")}
        lines = {
            part: _unit(seen[end] - seen[start]) for part, (start, end) in ends.items() if {start, end} <= set(seen)
        }
        if "thigh" in lines:
            across = _unit(right - left)
            upward = _unit(np.cross(across, (left + right) / 2 - seen["sacrum"]))
            along = [_dot(lines["thigh"], axis) for axis in (np.cross(upward, across), -upward, across)]
            found[f"hip_flexion_{side}"] = np.degrees(np.arctan2(along[0], along[1]))
            found[f"hip_adduction_{side}"] = -outward * np.degrees(np.arcsin(along[2]))
        for name, above, below, straight in (
            ("knee_angle", "thigh", "shank", 0.0),
            ("ankle_angle", "shank", "foot", 90.0),
        ):
            if {above, below} <= set(lines):
                turned = np.degrees(np.arccos(np.clip(_dot(lines[above], lines[below]), -1.0, 1.0)))
                found[f"{name}_{side}"] = turned - straight
    return found


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _dot(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("ti,ti->t", one, other)


def _against_markers(trial: Trial) -> Iterator[_Contradiction]:
    """Angles that markers show in another sign, another size, or one leg alone at another level."""
    if not {"kinematics", "markers"} <= set(trial.streams):
        return
    angles, markers = trial.stream("kinematics"), trial.stream("markers")
    try:
        lines = line_angles(markers)
    except GaitdiscError:  # no markers with three coordinates
        return
    offsets: dict[str, NDArray[np.float64]] = {}
    for name in sorted(set(lines) & set(angles.names)):
        line = interpolated(markers.time, lines[name][:, None], angles.time)[:, 0]
        known = np.isfinite(angles[name]) & (np.abs(line - np.nanmedian(line)) < OTHER_PLACE_DEG)
        if known.sum() < FEWEST:
            continue
        own, line = angles[name][known], line[known]
        moves = (
            f"{name} moves by {_range(own):.3g} deg where the lines between its markers move by {_range(line):.3g} deg"
        )
        if _range(line) >= MOVES_DEG and _correlation(own, line) < -AGAINST:
            yield _Contradiction("kinematics", [name], f"{moves}, the other way (r = {_correlation(own, line):.2f})")
        elif _range(line) >= MOVES_DEG and not 1 / SCALE <= _range(own) / _range(line) <= SCALE:
            yield _Contradiction("kinematics", [name], f"{moves}: its unit or its scale is another")
        else:
            bent = line > np.median(line)
            offsets[name] = np.array([np.median((own - line)[part]) for part in (bent, ~bent)])
    for joint, usual in USUAL_OFFSET_DEG.items():
        left, right = (offsets.get(f"{joint}_{side}") for side in "lr")
        if left is None or right is None or (min(right - left) < OFFSET_DEG and max(right - left) > -OFFSET_DEG):
            continue
        mean = {f"{joint}_l": float(left.mean()), f"{joint}_r": float(right.mean())}
        far, near = sorted(mean, key=lambda name: -abs(mean[name] - usual))
        what = f"{far} lies {mean[far]:+.0f} deg from the lines between its markers, {near} {mean[near]:+.0f} deg"
        yield _Contradiction("kinematics", [far], f"{what}: an offset that the markers do not show")


def _in_radians(trial: Trial) -> Iterator[_Contradiction]:
    """Angles of a walk that move less than skin does and stay within half a turn counted in radians."""
    if "kinematics" not in trial.streams:
        return
    angles = trial.stream("kinematics")
    names = [c.name for c in angles.channels if c.unit == "deg" and _ANGLE.fullmatch(c.name)]
    reach = {name: _range(angles[name]) for name in names}
    legs = max((reach[name] for name in names if name.startswith(("hip_flexion", "knee_angle"))), default=0.0)
    found = [
        name
        for name in names
        if LOCKED_DEG < reach[name] < (STILL_DEG if _FLEXION.fullmatch(name) else STILL_OTHER_DEG)
        and np.nanmax(np.abs(angles[name])) < np.pi
    ]
    all_of_them = WALKS_RAD[0] <= legs <= WALKS_RAD[1]
    if found and (legs >= WALKS_DEG or all_of_them):
        what = f"{found[0]} moves by {reach[found[0]]:.2g} deg in a walk, less than skin does: it looks like radians"
        yield _Contradiction("kinematics", names if all_of_them else found, what)


def _turned_hips(trial: Trial) -> Iterator[_Contradiction]:
    """A hip that flexes with the other one while the knees alternate, or both that extend while their knees swing."""
    names = [f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle") for side in "rl"]
    if "kinematics" not in trial.streams or not set(names) <= set(trial.stream("kinematics").names):
        return
    angles = trial.stream("kinematics")
    right, left, *knees = (angles[name] for name in names)
    if min(_range(angles[name]) for name in names) < MOVES_DEG:
        return
    together = _correlation(right, left)
    swings = [_correlation(np.gradient(hip), knee) for hip, knee in zip((right, left), knees, strict=True)]
    if together > AGAINST and _correlation(*knees) < AGAINST:
        name = names[int(np.argmin(swings))]
        what = f"{name} flexes with the other hip (r = {together:.2f}) where knees alternate"
        yield _Contradiction("kinematics", [name], f"{what}, and extends while its knee swings: its sign is turned")
    elif together < -AGAINST and max(swings) < -AGAINST and max(np.nanmean(right), np.nanmean(left)) < 0:
        what = f"both hips extend while their knees swing (r = {max(swings):.2f}): their sign is turned"
        yield _Contradiction("kinematics", names[:2], what)


def _small_moments(trial: Trial) -> Iterator[_Contradiction]:
    """Moments that no leg on the ground has: a thousandth, all of them or one."""
    if "moments" not in trial.streams:
        return
    moments = trial.stream("moments")
    units = {c.name: c.unit for c in moments.channels if c.unit in LEAST_MOMENT and _ANGLE.fullmatch(c.name[:-7])}
    peaks = {name: float(np.quantile(known, 0.995)) for name in units if len(known := _finite(np.abs(moments[name])))}
    most = max(peaks, key=lambda name: peaks[name], default="")
    if not most or not peaks[most]:
        return
    unit, why = units[most], "the unit is another, as N mm under N m"
    if peaks[most] < LEAST_MOMENT[unit]:
        what = (
            f"{most}, the largest moment of the legs, is {peaks[most]:.2g} {unit}; standing has {LEAST_MOMENT[unit]:g}"
        )
        yield _Contradiction("moments", list(peaks), f"{what} or more: {why}")
        return
    for name, peak in peaks.items():
        share = LEAST_SHARE["flexion" if _FLEXION.fullmatch(name) else ""]
        if 1e-3 * share < peak / peaks[most] < share:
            what = f"{name} reaches {peak:.2g} {unit} where {most} reaches {peaks[most]:.3g}"
            yield _Contradiction("moments", [name], f"{what}: {why}")


def _powers(trial: Trial) -> Iterator[_Contradiction]:
    """Moments and power of a joint where power is not moment times angular rate, in sign or size."""
    if not {"kinematics", "moments"} <= set(trial.streams):
        return
    angles, moments = trial.stream("kinematics"), trial.stream("moments")
    units = {c.name: c.unit for c in moments.channels}
    for angle in (name for name in angles.names if _FLEXION.fullmatch(name) and _range(angles[name]) >= MOVES_DEG):
        joint, side = angle.split("_")[0], angle[-1]
        moment, power = f"{angle}_moment", f"{joint}_power_{side}"
        if units.get(moment, "").replace("N m", "W") != units.get(power):
            continue
        rate = np.radians(np.gradient(angles[angle])) * angles.rate_hz
        made = moments[moment] * interpolated(angles.time, rate[:, None], moments.time)[:, 0]
        known = np.isfinite(made) & np.isfinite(moments[power]) & (moments[power] != 0)
        made, given = made[known], moments[power][known]
        if known.sum() < FEWEST or not made.any():
            continue
        slope, other = (float(given @ made / (one @ one)) for one in (made, given))
        r = float(np.sign(slope) * np.sqrt(slope * other))
        if r < -AGAINST or (r > AGAINST and not 1 / POWER_SCALE <= slope <= POWER_SCALE):
            names = [name for name in units if re.fullmatch(rf"{joint}_\w+_{side}_moment|{power}", name)]
            what = f"{power} is {slope:.3g} times {moment} times the rate of {angle} (r = {r:.2f}), not once"
            yield _Contradiction("moments", names, f"{what}: sign or unit of one of them is another")


def _turned_moments(trial: Trial) -> Iterator[_Contradiction]:
    """Moments of a hip that go with its angle, which a swinging leg's oppose; of an ankle that lift the loaded foot."""
    if "moments" not in trial.streams:
        return
    moments = trial.stream("moments")
    for side in "rl":
        for joint, stream, source in (
            ("hip_flexion", "kinematics", f"hip_flexion_{side}"),
            ("ankle_angle", "forces", f"ground_force_{side}_vy"),
        ):
            moment = f"{joint}_{side}_moment"
            if moment not in moments.names or stream not in trial.streams or source not in trial.stream(stream).names:
                continue
            other = trial.stream(stream)
            beside = interpolated(other.time, other[source][:, None], moments.time)[:, 0]
            own = np.where(moments[moment] == 0, np.nan, moments[moment])
            r = _correlation(own, beside)
            if _range(beside) >= MOVES_DEG and r > AGAINST and (joint == "hip_flexion" or np.nanmean(own) > 0):
                what = f"{moment} goes with {source} (r = {r:.2f}), which it opposes in walking: its sign is turned"
                yield _Contradiction("moments", [moment], what)


def _finite(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return values[np.isfinite(values)]


def _range(values: NDArray[np.float64]) -> float:
    """From the 2nd to the 98th percentile."""
    known = _finite(values)
    return float(np.ptp(np.quantile(known, [0.02, 0.98]))) if len(known) >= FEWEST else 0.0


def _correlation(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Of the ranks, which single wild frames do not move; 0 where one stands still."""
    known = np.isfinite(one) & np.isfinite(other)
    if known.sum() < FEWEST or not np.ptp(one[known]) or not np.ptp(other[known]):
        return 0.0
    return float(spearmanr(one[known], other[known])[0])
