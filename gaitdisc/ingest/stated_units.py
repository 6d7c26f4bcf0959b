"""Units that a file states, held against its numbers: degrees or radians, m or mm, newtons or newtons per kg."""

import math
import re
from collections.abc import Mapping, Sequence

import numpy as np

from gaitdisc.errors import UnitError
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Values, finite_values, runs

FULL_TURN = 2 * math.pi  # a joint angle beyond this cannot be in radians
WALKING_RAD = (0.35, 2.5)  # range of hip flexion or of the knee in a moving trial, in radians (20 to 143 deg)
PERCENTILES = (5, 95)
SHORTEST_S, FEWEST = 0.5, 20  # a shorter piece, or one of fewer samples, may hold no movement
_COPIED = re.compile(r"(knee_angle_[rl])_beta")
METRES_AT_MOST = 15.0  # no laboratory's markers are farther from its origin, and no body is smaller than 10 cm
MILLIMETRES_AT_LEAST = 100.0
FORCE_N = (5.0, 40.0)  # peak of the vertical force: half to four body weights in N/kg; a child of 5 kg has 50 N
MOMENT_NM = (0.4, 6.0)  # peak of hip, knee and ankle in N m/kg; a child of 15 kg has 15 N m and more at push-off
STANCE_S = (0.15, 3.0)  # a plate is loaded for as long as a step lasts; drift is longer, noise shorter
SHARE = 0.5  # of the peak: above it while loaded
EMPTY = 0.1  # of the peak: below it while the foot swings
LEG_MOMENT = re.compile(r"(ankle_angle|knee_angle|hip_flexion)_[rl]_moment")


def plausible_unit(
    time: Values, values: Values, names: Sequence[str], stated: str | None, file: str
) -> tuple[str, Finding | None]:
    """Unit of a file's angles (time, angle): the stated one unless the numbers contradict it; a finding of a doubt."""
    joints = [i for i, name in enumerate(names) if not name.startswith("pelvis_") and not _COPIED.fullmatch(name)]
    if not joints:
        if stated:
            return stated, None
        raise _refuse_undecided(file, "no joint angle of the file shows the unit")
    bounded = [i for i in joints if "_rot" not in names[i]] or joints  # an arm or a thigh may wind on by whole turns
    most = _largest(values[:, bounded])
    moving = [i for i in joints if re.match(r"hip_flexion|knee_angle", names[i])]
    # without the twentieth at either end, where a fit may have lost its markers
    columns = [finite_values(column) for column in values[:, moving or joints].T]
    reach = max((float(np.ptp(np.percentile(column, PERCENTILES))) for column in columns if column.size), default=0.0)
    long_enough = time[-1] - time[0] >= SHORTEST_S and len(time) >= FEWEST
    beyond = most > FULL_TURN
    like_rad = not beyond and long_enough and WALKING_RAD[0] <= reach <= WALKING_RAD[1]
    if stated == "rad" and beyond:
        which = next(names[i] for i in bounded if _largest(values[:, i]) == most)
        raise UnitError(
            f"{file} states radians (inDegrees=no), so no joint angle may exceed {FULL_TURN:.2f} rad",
            f"{which} reaches {most:.4g} rad, which looks like degrees",
            "Write inDegrees=yes in its header, or export it again.",
        )
    if stated == "deg" and like_rad and moving:
        raise UnitError(
            f"{file} states degrees, so hips and knees of a moving trial must vary by more than {WALKING_RAD[1]:g} deg",
            f"the widest range is {reach:.3g} deg and the largest angle {most:.3g} deg, which looks like radians",
            "Write inDegrees=no (or [rad]) in its header, or export it again.",
        )
    if stated:
        what = f"the file states degrees, but no angle varies by more than {reach:.3g} deg"
        doubt = Finding("warning", "unit in doubt", file, what, "all angles if they are radians; check inDegrees")
        return stated, doubt if stated == "deg" and like_rad else None
    if not beyond and not like_rad:
        raise _refuse_undecided(
            file, f"the largest joint angle is {most:.3g}, and the widest hip or knee range is {reach:.3g}"
        )
    unit = "deg" if beyond else "rad"
    what = f"the header does not state degrees or radians; angles are read as {unit} (largest joint angle {most:.4g})"
    return unit, Finding("warning", "unit inferred", file, what, "all angles if this is wrong; state inDegrees")


def find_copied_unit(name: str, values: Values, angles: dict[str, Values]) -> str | None:
    """Unit of OpenSim's `knee_angle_r_beta`, which copies the knee angle, or None where it copies nothing.

    OpenSim converts rotational coordinates when it writes a file but leaves coupled ones as they are, so that in a file
    of degrees the copy stands in radians, and in one of radians it may stand in degrees. The copied knee decides.

    values (time,) [deg or rad]: as read
    angles each (time,) [deg]: the other angles of the file, already in degrees
    """
    copied = _COPIED.fullmatch(name)
    if not copied or copied[1] not in angles:
        return None
    knee = angles[copied[1]]
    both = np.isfinite(values) & np.isfinite(knee)
    if not both.any():
        return None
    values, knee = values[both], knee[both]
    apart = {unit: np.abs(values * factor - knee).mean() for unit, factor in (("deg", 1.0), ("rad", 180 / math.pi))}
    unit = min(apart, key=lambda u: apart[u])
    return unit if apart[unit] <= 0.05 * np.abs(knee).mean() + 1e-6 else None


def _largest(values: Values) -> float:
    return float(np.abs(finite_values(values)).max(initial=0.0))


def _refuse_undecided(file: str, why: str) -> UnitError:
    return UnitError(
        f"{file} must state degrees or radians (inDegrees=yes or no)",
        f"its header states neither, and {why}",
        "Add the line inDegrees=yes or inDegrees=no before endheader.",
    )


def distance_from_origin(places: Values) -> float:
    """99th percentile of marker coordinates (frame, coordinate) of some thousand frames; NaN without any."""
    some = places[:: max(len(places) // 1000, 1)]
    finite = np.abs(finite_values(some))
    return float(np.quantile(finite, 0.99)) if finite.size else float("nan")


def refuse_other_unit(unit: str, far: float, file: str, where: str) -> None:
    """Refuse a unit that the distance from the origin contradicts."""
    if (unit == "m" and far >= MILLIMETRES_AT_LEAST) or (unit == "mm" and 0 < far <= METRES_AT_MOST):
        raise UnitError(
            f"markers in {unit} must be {'less' if unit == 'm' else 'more'} than {METRES_AT_MOST:g} {unit} from the "
            "origin",
            f"those of {file} are {far:.4g} {unit} away, which looks like {'mm' if unit == 'm' else 'm'}",
            f"Correct {where} of the file.",
        )


def per_kg_findings(streams: Mapping[str, Recording]) -> list[Finding]:
    """Say that ground forces or joint moments stated in N or N m are per kg of body mass."""
    findings = []
    steps = "hundreds of N are usual in steps"
    legs = "tens of N m are usual for the largest moment of the legs in walking"
    stated = ("forces", "vertical_force", "N", FORCE_N, steps), ("moments", "moment", "N m", MOMENT_NM, legs)
    for key, quantity, unit, (low, high), like in stated:
        if key not in streams:
            continue
        recording = streams[key]
        meant = [c.name for c in recording.channels if (c.quantity, c.unit) == (quantity, unit)]
        meant = [name for name in meant if key == "forces" or LEG_MOMENT.fullmatch(name)]
        sizes = {name: np.abs(finite_values(recording[name])) for name in meant}
        peaks = {name: float(np.quantile(size, 0.999)) if size.size else 0.0 for name, size in sizes.items()}
        most = max(peaks, key=lambda name: peaks[name], default="")
        walks = recording.duration_s >= STANCE_S[0]
        if walks and most and key == "forces":
            force = np.abs(np.nan_to_num(recording[most]))
            peak = float(force.max())
            longest = max(((end - start) for start, end in runs(force > SHARE * peak)), default=0) / recording.rate_hz
            walks = np.mean(force < EMPTY * peak) > EMPTY and STANCE_S[0] <= longest <= STANCE_S[1]
        if most and low <= peaks[most] <= high and walks:
            what = f"peaks at {peaks[most]:.3g} {unit}, but {like}: the unit seems to be {unit} per kg of body mass"
            spoils = f"contacts from force, moments and powers; state {unit}/kg, or multiply by body mass"
            findings.append(Finding("warning", "per body mass", recording.source.file, what, spoils, most))
    return findings
