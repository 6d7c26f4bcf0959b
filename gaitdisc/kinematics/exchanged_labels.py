"""Two markers that bear each other's label: which they are, and in which frames of a trial or in the static trial."""

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.kinematics.calibration import Calibration, Points, landmark_order, swap
from gaitdisc.kinematics.markers import marker_labels
from gaitdisc.kinematics.pose import SEGMENTS
from gaitdisc.kinematics.segment_poses import free_fits, place_markers
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Values, spans_s

# Root mean square over a segment's points [m]. Two labels exchanged give 0.012 or more, whatever pair (2,400 pairs in
# six walks of three people); one person's skin 0.002 to 0.004 (median), in 1 % of the frames up to 0.016.
LOOKED_AT_M = 0.01
BROKEN_M = 0.025  # skin moves by up to 0.03 m over the thigh, less elsewhere (Leardini 2005, Gait Posture 21:212)
EXPLAINED = 0.5  # of the misfit is gone when two labels are exchanged
UNFIT = ("exchanged markers", "broken segment")  # kinds of findings
MOST_PAIRS = 3  # exchanged in one trial
FRAMES = 12  # in which each pair is tried
SPOILS = "the segments' angles and cycles in these frames; correct the labels, or use the session's static trial"
FEWEST_FRAMES = 3  # that a pair has to explain: fewer are single frames in which a marker jumped


class Exchange(NamedTuple):
    """Two markers whose exchange makes their segments fit."""

    pair: tuple[str, str]  # by the names of the marker set
    frames: NDArray[np.bool_]  # (frame,), in which it does
    segments: tuple[str, ...]  # that hold one of them
    before_m: float  # median of the misfit in these frames, as they are and exchanged [m]
    after_m: float


def find_exchanged_pairs(
    places: Points, calibration: Calibration, up: Values
) -> tuple[list[Exchange], dict[str, NDArray[np.bool_]]]:
    """Pairs of markers whose labels are exchanged in a trial, and where segments have lost their shape without one.

    places each (frame, 3) [m]: as `name_places` returns them
    up (3,): in the laboratory
    returns exchanges: each pair with its frames
    returns broken each (frame,): segment -> frames in which its markers lie farther from their places than skin moves
    """
    now = misfits(places, calibration, up)
    exchanges: list[Exchange] = []
    unexplained = np.max([*now.values()], axis=0) > LOOKED_AT_M
    while unexplained.any() and len(exchanges) < MOST_PAIRS:
        frames: NDArray[np.intp] = np.flatnonzero(unexplained)
        some = frames[np.linspace(0, len(frames) - 1, min(FRAMES, len(frames))).astype(int)]
        if (pair := _best_pair({name: place[some] for name, place in places.items()}, calibration, up)) is None:
            break
        segments = holders(pair, calibration)
        before_m, after_m = (
            np.max([misfit[name] for name in segments], axis=0)
            for misfit in (now, misfits(swap(places, pair), calibration, up))
        )
        better = unexplained & (before_m > LOOKED_AT_M) & (after_m < before_m)
        exchanges.append(
            Exchange(pair, better, segments, float(np.median(before_m[better])), float(np.median(after_m[better])))
        )
        unexplained = unexplained & ~better
    return exchanges, {segment: unexplained & (now[segment] > BROKEN_M) for segment in SEGMENTS}


def misfits(places: Points, calibration: Calibration, up: Values) -> dict[str, Values]:
    """How far the points of each segment lie from where the static trial has them, each (frame,) [m].

    A foot that points backward in its shank (no ankle bends by 90 deg), and a pelvis that is upside down or turned
    against both feet, is infinitely far: markers exchanged may keep their distances.
    """
    fits = free_fits(place_markers(places, calibration), calibration)
    by_segment, feet = {segment: fit.residual_m.copy() for segment, fit in fits.items()}, []
    for side in "lr":
        names = [calibration.marker_set.landmark(end, side, places) for end in ("heel", "toe")]
        heel, toe = (np.mean([places[name] for name in marks] or [np.full(3, np.nan)], axis=0) for marks in names)
        feet.append(np.broadcast_to(toe - heel, fits["pelvis"].pose.origin.shape))
        backward = np.einsum("fi,fi->f", fits[f"shank_{side}"].pose.rotation[:, :, 0], feet[-1]) < 0
        by_segment[f"foot_{side}"][backward] = np.inf
    pelvis = fits["pelvis"].pose.rotation
    against = np.all([np.einsum("fi,fi->f", pelvis[:, :, 0], foot) < 0 for foot in feet], axis=0)
    by_segment["pelvis"][against | (pelvis[:, :, 1] @ up < 0)] = np.inf
    return {
        segment: np.where(segment in calibration.spoiled, 0.0, np.where(np.isnan(metres), 0.0, metres))
        for segment, metres in by_segment.items()
    }


def holders(pair: Iterable[str], calibration: Calibration) -> tuple[str, ...]:
    """Segments that hold one of the markers."""
    return tuple(segment for segment in SEGMENTS if set(pair) & set(calibration.body[segment]))


def _best_pair(places: Points, calibration: Calibration, up: Values) -> tuple[str, str] | None:
    """Pair of which one marker is in a segment that does not fit, and which explains most frames; None if none does."""
    now = misfits(places, calibration, up)
    off = {segment for segment in SEGMENTS if (now[segment] > LOOKED_AT_M).any()}
    pairs = itertools.combinations([name for name in places if holders((name,), calibration)], 2)
    swapped = {pair: swap(places, pair) for pair in pairs if off & set(holders(pair, calibration))}
    each = {name: np.concatenate([place, *(one[name] for one in swapped.values())]) for name, place in places.items()}
    each = {name: np.split(metres, len(swapped) + 1) for name, metres in misfits(each, calibration, up).items()}
    ranked = []
    for number, pair in enumerate(swapped, 1):  # all pairs at once: to fit each alone took ten times as long
        segments, after = holders(pair, calibration), {name: metres[number] for name, metres in each.items()}
        before_m, after_m = (np.max([misfit[segment] for segment in segments], axis=0) for misfit in (now, after))
        rest_m, rest_after_m = (np.max([one[s] for s in SEGMENTS if s not in segments], axis=0) for one in (now, after))
        fits = (after_m < BROKEN_M) & (rest_after_m <= np.maximum(rest_m, BROKEN_M))
        explains = fits & (before_m > LOOKED_AT_M) & (after_m < EXPLAINED * before_m)
        ranked.append((int(explains.sum()), -float(after_m[explains].sum()), pair))
    count, _, pair = max(ranked, default=(0, 0.0, ("", "")))
    return pair if count >= FEWEST_FRAMES else None


def exchange_findings(
    exchanges: Sequence[Exchange],
    broken: Mapping[str, NDArray[np.bool_]],
    calibration: Calibration,
    markers: Recording,
    up: Values,
) -> list[Finding]:
    """Say which labels are exchanged, where and in which trial, and which segments have lost their shape without."""
    file, names = markers.source.file or "the trial", calibration.marker_set.names(marker_labels(markers))
    findings = []
    for case in exchanges:
        first, second = (names[name] for name in case.pair)
        order = landmark_order(calibration.marker_set, swap(calibration.places, case.pair), up)
        where = "this trial" if min(order)[0] <= 0 else "this trial or in the static trial"
        before = f"{1000.0 * case.before_m:.0f} mm" if np.isfinite(case.before_m) else "a reversed axis"
        what = f"{', '.join(case.segments)}: exchanging {first} and {second} in {where} corrects {case.frames.sum()} "
        what += f"of {len(case.frames)} frames: misfit to the static trial {1e3 * case.after_m:.0f} mm, before {before}"
        spans = spans_s(markers.time, case.frames)
        findings.append(Finding("warning", "exchanged markers", file, what, SPOILS, f"{first}, {second}", spans=spans))
    for segment, frames in broken.items():
        if frames.any():
            what = f"{segment}: in {int(frames.sum())} of {len(frames)} frames its markers are more than "
            what += f"{1000.0 * BROKEN_M:.0f} mm from their positions in the static trial, and no exchange explains it"
            spans = spans_s(markers.time, frames)
            findings.append(Finding("warning", "broken segment", file, what, SPOILS, spans=spans))
    return findings


def without_exchanged(markers: Recording, exchanges: Sequence[Exchange], calibration: Calibration) -> Recording:
    """Same markers, missing in the frames in which they bear another's label."""
    names, values = calibration.marker_set.names(marker_labels(markers)), np.array(markers.values)
    for exchange in exchanges:
        columns = [markers.index(f"{names[name]}.{axis}") for name in exchange.pair for axis in "xyz"]
        values[np.flatnonzero(exchange.frames)[:, None], columns] = np.nan
    return markers.with_values(values) if exchanges else markers
