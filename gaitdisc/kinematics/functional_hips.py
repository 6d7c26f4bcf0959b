"""Hip joint centres from a trial in which the thighs are moved about them."""

from typing import NamedTuple

import numpy as np

from gaitdisc.kinematics.calibration import Calibration
from gaitdisc.kinematics.pose import Pose, fit_pose
from gaitdisc.kinematics.segment_poses import PlacedMarkers, name_places, place_markers
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Values

LEAST_SWING_DEG = 5.0  # root mean square to each side; a circle of 20 deg has 14, walking has 3 out of its plane
LARGEST_RESIDUAL_M = 0.015  # skin of the thigh slides by as much
FARTHEST_M = 0.05  # from the hip after the landmarks, which is right to some 2 cm
FEWEST_FRAMES = 50
ROUNDS = 50
SETTLED_M = 1e-7
SPOILS = "this hip by 1 to 2 cm; circle the leg by at least 20 deg, front to back and side to side"


class Pivot(NamedTuple):
    """The centre about which a segment turns, in the frame of the one above, and how far it leaves it (rms)."""

    centre: Values
    residual_m: float


def functional_hips(markers: Recording, calibration: Calibration) -> tuple[dict[str, Values], tuple[Finding, ...]]:
    """Hip centres in the pelvis' frame [m] by side, of a trial of hip movements, and what was found.

    With three markers on the thigh the centre is the point that is fixed in both segments, with fewer that of the
    spheres on which they move. A side whose thigh hardly moves, or in one plane, or not about a point, keeps the hip
    that the calibration has.

    calibration: of the same person's static trial, with the hips of a regression
    """
    file = markers.source.file or "the functional trial"
    placed = place_markers(name_places(markers, calibration), calibration, file)
    pelvis = fit_pose(*placed["pelvis"]).pose
    hips, findings = {}, []
    for side in "lr":
        usual = calibration.points["pelvis"][f"hip_{side}"]
        pivot, refused = _find_hip(pelvis, placed[f"thigh_{side}"], usual)
        if pivot is None:
            what = f"hip_{side} is computed from the landmarks, not from the functional trial: {refused}"
            findings.append(Finding("warning", "functional hip", file, what, SPOILS))
            continue
        hips[f"hip_{side}"] = pivot.centre
        what = f"hip_{side} of the functional trial is {_mm(_apart(pivot, usual))} from that of the landmarks; "
        what += f"the thigh moves about this centre within {_mm(pivot.residual_m)} (rms)"
        findings.append(Finding("note", "functional hip", file, what, ""))
    return hips, tuple(findings)


def _find_hip(pelvis: Pose, thigh: PlacedMarkers, usual: Values) -> tuple[Pivot | None, str]:
    """Centre of one hip, or None and why."""
    complete = pelvis.known & np.isfinite(thigh.seen).all(axis=(1, 2))
    if complete.sum() < FEWEST_FRAMES:
        return None, f"pelvis and thigh are complete in {int(complete.sum())} frames; {FEWEST_FRAMES} frames are needed"
    above, markers = Pose(pelvis.origin[complete], pelvis.rotation[complete]), thigh.seen[complete]
    below, places = fit_pose(thigh.body, markers).pose, above.to_segment(markers)
    pivot = find_fixed_point(above, below) if below.known.all() else sphere_centre(places, usual)
    # to each side, in the direction in which the thigh turns less
    way = (places - pivot.centre).mean(axis=1)
    way = way / np.linalg.norm(way, axis=1, keepdims=True)
    spread = np.linalg.eigvalsh(np.cov(way.T))
    swing_deg = float(np.degrees(np.sqrt(max(spread[1], 0.0))))
    if swing_deg < LEAST_SWING_DEG:
        words = f"the thigh turns by {swing_deg:.1f} deg (rms) perpendicular to its largest swing"
        return None, f"{words}; at least {LEAST_SWING_DEG:g} deg are needed"
    if pivot.residual_m > LARGEST_RESIDUAL_M:
        return None, f"the thigh deviates from the centre by {_mm(pivot.residual_m)} (rms)"
    if _apart(pivot, usual) > FARTHEST_M:
        return None, f"the computed centre is {_mm(_apart(pivot, usual))} from that of the landmarks"
    return pivot, ""


def find_fixed_point(above: Pose, below: Pose) -> Pivot:
    """Point that stays nearest to one place in both segments, in the frame of the one above [m].

    Source: Ehrig 2006, J Biomech 39:2798 (symmetrical centre of rotation estimation).
    """
    both = np.concatenate([above.rotation, -below.rotation], axis=2)
    apart = below.origin - above.origin
    point = np.asarray(np.linalg.lstsq(both.reshape(-1, 6), apart.ravel(), rcond=1e-6)[0], np.float64)
    residual = both @ point - apart
    return Pivot(point[:3], float(np.sqrt((residual**2).sum(axis=1).mean())))


def sphere_centre(places: Values, start: Values) -> Pivot:
    """Centre that all markers keep their distances from, without the bias that noise gives it.

    places (frame, marker, 3) [m]: in the frame of the segment above
    start (3,) [m]: where the search for the bias begins
    Source: Gamage & Lasenby 2002, J Biomech 35:87; Halvorsen 2003, J Biomech 36:999 (the bias).

    >>> turn = np.linspace(0, 6, 90)
    >>> way = np.stack([np.sin(turn), -2 + np.cos(3 * turn) / 2, np.cos(turn)], axis=1)
    >>> way = 0.4 * way / np.linalg.norm(way, axis=1, keepdims=True) + [0.1, 0.2, 0.3]
    >>> sphere_centre(way[:, None], np.zeros(3)).centre.round(6).tolist()
    [0.1, 0.2, 0.3]
    """
    mean = places.mean(axis=0)
    out = places - mean
    matrix = 2 * np.einsum("fmi,fmj->ij", out, out) / len(places)
    square = (places**2).sum(axis=2)
    right = np.einsum("fmi,fm->i", out, square - square.mean(axis=0)) / len(places)
    centre = np.array(start, float)
    for _ in range(ROUNDS):
        far = ((places - centre) ** 2).sum(axis=2)
        noise2 = ((far - far.mean(axis=0)) ** 2).mean(axis=0) / (4 * far.mean(axis=0))
        bias = 2 * np.einsum("m,mi->i", noise2, mean - centre)
        before, centre = centre, np.linalg.lstsq(matrix, right - bias, rcond=1e-6)[0]
        if float(np.linalg.norm(centre - before)) < SETTLED_M:
            break
    distance = np.linalg.norm(places - centre, axis=2)
    return Pivot(centre, float(np.sqrt(((distance - distance.mean(axis=0)) ** 2).mean())))


def _apart(pivot: Pivot, usual: Values) -> float:
    return float(np.linalg.norm(pivot.centre - usual))


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.0f} mm" if metres >= 0.01 else f"{1e3 * metres:.1f} mm"
