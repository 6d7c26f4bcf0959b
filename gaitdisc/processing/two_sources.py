"""Two sources of a trial against each other: what markers, the other leg or mechanics contradict is left out and said.

An unusual value alone leaves nothing out: a stiff knee is as stiff in its markers, and its power is still its moment
times its rate.
"""

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import median_abs_deviation, rankdata

from gaitdisc.channel import list_names
from gaitdisc.errors import GaitdiscError
from gaitdisc.kinematics.marker_set import NEEDED, read_marker_sets
from gaitdisc.kinematics.markers import marker_labels, marker_places
from gaitdisc.kinematics.pose import hip_of_spines
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.arrays import Values, finite_values
from gaitdisc.recording.strides import interpolate

KIND = "contradicted"
Contradictions = Iterator[tuple[Sequence[str], str]]  # channels that cannot be what they say, and why
# Angles of files follow lines between single markers: r >= .85, median deviations .92 to 2.3 of theirs, offsets within
# 12 deg of these and 6.4 deg apart from left to right (18 walks): 4 times, or 12 deg apart, is no choice of axes.
USUAL_OFFSET_DEG = {"hip_flexion": 0.0, "hip_adduction": 5.0, "knee_angle": -4.0, "ankle_angle": -8.0}
SCALE, OFFSET_DEG = 4.0, 12.0
POWER_SCALE = 3.0  # power over moment times rate in the plane of walking: .87 to 1.13, r >= .83 in the same walks
AGAINST, ALIKE = 0.4, 0.7  # correlations: of another sign, where right ones are beyond -.3 or .8; of one course
FEWEST, MOVES_DEG = 20, 8.0  # samples; range of an angle (of a force in N) that says something
OTHER_PLACE_DEG = 75.0  # from the median: in these frames a marker bears another's label
WALKS_DEG, WALKS_RAD = 15.0, 0.6  # widest range of hips and knees; who stands sways by less than 0.6 deg
STILL_DEG, STILL_OTHER_DEG, LOCKED_DEG = 1.5, 0.6, 0.015  # skin alone moves markers by more; a model's locked joint
LEAST_MOMENT = {"N m/kg": 0.03, "N m": 0.4}  # of the largest: who stands has 0.15 N m/kg, a child of 5 kg 1 N m
LEAST_SHARE, LEAST_SHARE_OTHER = 1 / 300, 1 / 900  # of the largest: a leg that only swings has 1/10, its ankle 1/100
OPPOSED = {"hip_flexion": "hip_flexion_{}", "ankle_angle": "ground_force_{}_vy"}
_FLEXION = re.compile(r"(hip_flexion|knee_angle|ankle_angle)_[rl](_moment)?")
_LEG = re.compile(r"(hip|knee|ankle)_[a-z]+_[rl]_moment")
_ANGLE = re.compile(
    r"(hip_(flexion|adduction|rotation)|knee_(angle|adduction|rotation)|ankle_angle|foot_progression_angle)_[rl]|"
    r"pelvis_(tilt|list|rotation)|[RL](Pelvis|FootProgress)Angles\.[xyz]"
)


def without_contradicted(trial: Trial) -> Trial:
    """Trial without the channels that another source of it contradicts in unit, sign or level; each is a finding."""
    for check, streams in (
        (_in_radians, ("kinematics",)),
        (_against_markers, ("kinematics", "markers")),
        (_find_turned_hips, ("kinematics",)),
        (_moment_sizes, ("moments",)),
        (_powers, ("moments", "kinematics")),
        (_find_turned_moments, ("moments", "kinematics")),
        (_find_turned_moments, ("moments", "forces")),
    ):
        if not set(streams) <= set(trial.streams):
            continue
        recording = trial.stream(streams[0])
        contradictions = list(check(*(trial.stream(key) for key in streams)))
        file, spoils = recording.source.file, "the channel, which is excluded; correct the file"
        findings = [Finding("refused", KIND, file, what, spoils, list_names(names)) for names, what in contradictions]
        lost = {name for names, _ in contradictions for name in names}
        kept = [name for name in recording.names if name not in lost]
        rest = {key: value for key, value in trial.streams.items() if kept or key != streams[0]}
        rest |= {streams[0]: recording.selected(kept)} if kept and lost else {}
        trial = replace(trial, streams=rest, findings=(*trial.findings, *findings))
    return trial


def line_angles(markers: Recording) -> dict[str, Values]:
    """Angles of the lines hip to knee to ankle and heel to toe, each (frame,) [deg], as far as there are markers."""
    labels = marker_labels(markers)
    named: dict[tuple[str, str], list[str]] = {}
    for known in sorted(read_marker_sets().values(), key=lambda marker_set: len(marker_set.names(labels))):  # best last
        label, on = known.names(labels), itertools.product(NEEDED, "lr")
        named |= {place: [label[name] for name in names] for place in on if (names := known.landmark(*place, label))}
    centres = {place: marker_places(markers, names).mean(axis=1) for place, names in named.items()}
    centres = {place: points for place, points in centres.items() if np.isfinite(points).any()}
    angles, axes, spines = {}, (), [("asis", "l"), ("asis", "r"), ("sacrum", "l")]
    if set(spines) <= set(centres):
        left, right, back = (centres[place] for place in spines)
        across = _unit(right - left)
        upward = _unit(np.cross(across, (left + right) / 2 - back))
        axes = (np.cross(upward, across), -upward, across)
        centres |= {("hip", side): hip_of_spines(left, right, back, side) for side in "lr"}
    for side in "lr":
        thigh, shank, foot = (
            _unit(centres[end, side] - centres[start, side]) if {(start, side), (end, side)} <= set(centres) else None
            for start, end in (("hip", "knee_lateral"), ("knee_lateral", "ankle_lateral"), ("heel", "toe"))
        )
        if thigh is not None:
            ahead, down, aside = ((thigh * axis).sum(axis=1) for axis in axes)
            angles[f"hip_flexion_{side}"] = np.degrees(np.arctan2(ahead, down))
            angles[f"hip_adduction_{side}"] = np.degrees(np.arcsin(-aside if side == "r" else aside))
        for name, above, below, straight in (("knee_angle", thigh, shank, 0.0), ("ankle_angle", shank, foot, 90.0)):
            if above is not None and below is not None:
                angles[f"{name}_{side}"] = np.degrees(np.arccos(np.clip((above * below).sum(axis=1), -1, 1))) - straight
    return angles


def _unit(vectors: NDArray) -> Values:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _in_radians(angles: Recording) -> Contradictions:
    """Angles of a walk that move less than skin does and stay within half a turn counted in radians."""
    names = [c.name for c in angles.channels if c.unit == "deg" and _ANGLE.fullmatch(c.name)]
    reach = {name: _range(angles[name]) for name in names}
    still = [
        name
        for name in names
        if LOCKED_DEG < reach[name] < (STILL_DEG if _FLEXION.fullmatch(name) else STILL_OTHER_DEG)
        and np.nanmax(np.abs(angles[name])) < np.pi
    ]
    legs = [name for name in names if name.startswith(("hip_flexion", "knee_angle"))]
    most = max((reach[name] for name in legs), default=0.0)
    all_legs = set(legs) <= set(still) and most >= WALKS_RAD
    if still and (all_legs or most >= WALKS_DEG):
        what = f"{still[0]} varies by {reach[still[0]]:.2g} deg in a walk, less than skin moves: it seems to be in rad"
        yield names if all_legs else still, what


def _against_markers(angles: Recording, markers: Recording) -> Contradictions:
    """Angles that markers show in another sign, another size, or one leg alone at another level."""
    offsets: dict[str, Values] = {}
    try:
        lines = line_angles(markers)
    except GaitdiscError:  # no marker has three coordinates
        return
    for name in sorted(set(lines) & set(angles.names)):
        line = interpolate(markers.time, lines[name][:, None], angles.time)[:, 0]
        if not np.isfinite(line).any():
            continue
        known = np.isfinite(angles[name]) & (np.abs(line - np.nanmedian(line)) < OTHER_PLACE_DEG)
        angle, line = angles[name][known], line[known]
        moved, r = (_range(angle), _range(line)), _correlation(angle, line)
        what = f"{name} varies by {moved[0]:.3g} deg, the lines between its markers by {moved[1]:.3g} deg (r = {r:.2f})"
        if moved[1] >= MOVES_DEG and r < -AGAINST:
            yield [name], f"{what}: its sign is wrong, or two of the markers are exchanged"
        elif (
            moved[1] >= MOVES_DEG
            and r > ALIKE
            and not 1 / SCALE < median_abs_deviation(angle) / median_abs_deviation(line) < SCALE
        ):
            yield [name], f"{what}: its unit or scale is wrong"
        elif len(line) >= FEWEST:
            bent = line > np.median(line)
            offsets[name] = np.array([np.median((angle - line)[part]) for part in (bent, ~bent)])
    for joint, usual in USUAL_OFFSET_DEG.items():
        both = {name: offsets[name] for name in (f"{joint}_l", f"{joint}_r") if name in offsets}
        apart = np.subtract(*both.values()) if len(both) == 2 else np.zeros(2)
        if min(apart) > OFFSET_DEG or max(apart) < -OFFSET_DEG:
            far, near = sorted(both, key=lambda name: -abs(both[name].mean() - usual))
            what = f"{far} is {both[far].mean():+.0f} deg from the lines between its markers"
            yield [far], f"{what}, and {near} {both[near].mean():+.0f} deg: an offset that the markers do not show"


def _find_turned_hips(angles: Recording) -> Contradictions:
    """A hip that flexes with the other one while the knees alternate, or both that extend while their knees swing."""
    names = [f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle") for side in "rl"]
    if not set(names) <= set(angles.names) or min(_range(angles[name]) for name in names) < MOVES_DEG:
        return
    right, left, *knees = (angles[name] for name in names)
    together = _correlation(right, left)
    swings = [_correlation(np.gradient(hip), knee) for hip, knee in zip((right, left), knees, strict=True)]
    if together > AGAINST and together - _correlation(*knees) > AGAINST:
        name = names[int(np.argmin(swings))]
        what = f"{name} flexes with the other hip (r = {together:.2f}), unlike the knees, and extends while its knee"
        yield [name], f"{what} swings: its sign is wrong"
    elif together < -AGAINST and max(swings) < -AGAINST and max(np.nanmean(right), np.nanmean(left)) < 0:
        what = f"both hips extend while their knees swing (r = {max(swings):.2f})"
        yield names[:2], f"{what}, and are extended on average: their sign is wrong"


def _moment_sizes(moments: Recording) -> Contradictions:
    """Moments that no leg on the ground has: all of them too small, or one a thousandth or a thousand of the others."""
    units = {c.name: c.unit for c in moments.channels if c.unit in LEAST_MOMENT and _LEG.fullmatch(c.name)}
    peaks = {name: float(np.nanquantile([0.0, *np.abs(moments[name])], 0.98)) for name in units}
    most = sorted(peaks, key=lambda name: -peaks[name])[:2][-1:]  # the second: the largest may be the wrong one
    if not most or not peaks[most[0]]:
        return
    usual, unit, why = peaks[most[0]], units[most[0]], "the unit is wrong, such as N mm instead of N m"
    if usual < LEAST_MOMENT[unit]:
        least = f"{LEAST_MOMENT[unit]:g} {unit}"
        yield list(peaks), f"moments of the legs reach {usual:.2g} {unit}, but standing takes at least {least}: {why}"
    walks = _range(moments[most[0]]) > usual / 2  # who stands may have next to none about an axis
    for name, peak in peaks.items() if walks and usual >= LEAST_MOMENT[unit] else ():
        share = LEAST_SHARE if _FLEXION.fullmatch(name) else LEAST_SHARE_OTHER
        if 1e-3 * share < peak / usual < share or peak / usual > 1 / share:
            yield [name], f"{name} reaches {peak:.2g} {unit}, but {most[0]} reaches {usual:.3g} {unit}: {why}"


def _powers(moments: Recording, angles: Recording) -> Contradictions:
    """Moments and power of a joint where power is not moment times angular rate, in sign or size."""
    units = {c.name: c.unit for c in moments.channels}
    for angle in (name for name in angles.names if _FLEXION.fullmatch(name) and _range(angles[name]) >= MOVES_DEG):
        joint, side = angle.split("_")[0], angle[-1]
        moment, power = f"{angle}_moment", f"{joint}_power_{side}"
        if units.get(moment, "").replace("N m", "W") != units.get(power):
            continue
        rate = np.radians(np.gradient(angles[angle])) * angles.rate_hz
        made = moments[moment] * interpolate(angles.time, rate[:, None], moments.time)[:, 0]
        known = np.isfinite(made) & np.isfinite(moments[power]) & (moments[power] != 0)
        made, given = made[known], moments[power][known]
        if len(made) < FEWEST or not made.any():
            continue
        slope = float(given @ made / (made @ made))
        r = slope * float(np.sqrt((made @ made) / (given @ given)))
        if r < -AGAINST or (r > ALIKE and not 1 / POWER_SCALE <= slope <= POWER_SCALE):
            what = f"{power} must equal {moment} times the rate of {angle}, but is {slope:.3g} times this (r = {r:.2f})"
            names = [name for name in units if re.fullmatch(rf"{joint}_\w+_{side}_moment|{power}", name)]
            yield names, f"{what}: the sign or unit of one of the three is wrong"


def _find_turned_moments(moments: Recording, source: Recording) -> Contradictions:
    """Moments of a hip that go with its angle, which swings the leg on, or of an ankle that lift the loaded foot."""
    for moment, beside in ((f"{m}_{side}_moment", name.format(side)) for m, name in OPPOSED.items() for side in "rl"):
        if moment not in moments.names or beside not in source.names:
            continue
        other = interpolate(source.time, source[beside][:, None], moments.time)[:, 0]
        values = np.where(moments[moment] == 0, np.nan, moments[moment])
        r = _correlation(values, other)
        if r > AGAINST and _range(other) >= MOVES_DEG and (beside.startswith("hip") or np.nanmean(values) > 0):
            what = f"{moment} correlates with {beside} (r = {r:.2f}), although the two oppose each other in walking"
            yield [moment], f"{what}: its sign is wrong"


def _range(values: Values) -> float:
    """From the 5th to the 95th percentile, without frames in which a fit lost its markers."""
    known = finite_values(values)
    return float(np.ptp(np.quantile(known, [0.05, 0.95]))) if len(known) >= FEWEST else 0.0


def _correlation(first: Values, second: Values) -> float:
    """Of the ranks, which single wild frames do not move; 0 where one stands still."""
    known = np.isfinite(first) & np.isfinite(second)
    if known.sum() < FEWEST or not np.ptp(first[known]) or not np.ptp(second[known]):
        return 0.0
    return float(np.corrcoef(rankdata(first[known]), rankdata(second[known]))[0, 1])
