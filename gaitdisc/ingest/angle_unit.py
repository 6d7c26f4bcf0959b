"""Degrees or radians: what a file states is checked against how far hips and knees move."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import UnitError
from gaitdisc.recording import Finding

FULL_TURN = 2 * math.pi  # a joint angle beyond this cannot be in radians
WALKING_RAD = (0.35, 2.5)  # range of hip flexion or of the knee in a moving trial, in radians (20 to 143 deg)
PERCENTILES = (5, 95)
SHORTEST_S, FEWEST = 0.5, 20  # a shorter piece, or one of fewer samples, may hold no movement
_COPIED = re.compile(r"(knee_angle_[rl])_beta")


def plausible_unit(
    time: NDArray[np.float64], values: NDArray[np.float64], names: Sequence[str], stated: str | None, file: str
) -> tuple[str, Finding | None]:
    """Unit of a file's angles: the stated one if the numbers do not contradict it.

    time (time,) [s]: times of the samples
    values (time, angle) [deg or rad]: angles as read
    returns finding: said where the unit was taken from the magnitude, or where it is in doubt

    >>> t = np.linspace(0, 2, 200)
    >>> plausible_unit(t, 30 * np.sin(6 * t)[:, None], ["hip_flexion_r"], "deg", "walk.mot")
    ('deg', None)
    """
    joints = [i for i, name in enumerate(names) if not name.startswith("pelvis_") and not _COPIED.fullmatch(name)]
    if not joints:
        if stated:
            return stated, None
        raise _undecided(file, "it has no joint angle that would show it")
    bounded = [i for i in joints if "_rot" not in names[i]] or joints  # an arm or a thigh may wind on by whole turns
    most = _largest(values[:, bounded])
    moving = [i for i in joints if re.match(r"hip_flexion|knee_angle", names[i])]
    reach = _largest_range(values[:, moving or joints])
    long_enough = time[-1] - time[0] >= SHORTEST_S and len(time) >= FEWEST
    beyond = most > FULL_TURN
    like_rad = not beyond and long_enough and WALKING_RAD[0] <= reach <= WALKING_RAD[1]
    if stated == "rad" and beyond:
        which = next(names[i] for i in bounded if _largest(values[:, i]) == most)
        raise UnitError(
            f"{file} states radians (inDegrees=no), so no joint angle may exceed {FULL_TURN:.2f}",
            f"{which} reaches {most:.4g}, which looks like degrees",
            "Write inDegrees=yes in its header, or export it again.",
        )
    if stated == "deg" and like_rad and moving:
        raise UnitError(
            f"{file} states degrees, so hips and knees of a moving trial range over more than {WALKING_RAD[1]:g}",
            f"their widest range is {reach:.3g} and no joint angle exceeds {most:.3g}, which looks like radians",
            "Write inDegrees=no (or [rad]) in its header, or export it again.",
        )
    if stated:
        what = f"stated as degrees, but no angle ranges over more than {reach:.3g}"
        doubt = Finding("warning", "unit in doubt", file, what, "all angles if they are radians; check inDegrees")
        return stated, doubt if stated == "deg" and like_rad else None
    if not beyond and not like_rad:
        raise _undecided(file, f"the largest joint angle is {most:.3g}, the widest hip or knee range {reach:.3g}")
    unit = "deg" if beyond else "rad"
    what = f"the header does not say degrees or radians; taken as {unit} (largest joint angle {most:.4g})"
    return unit, Finding("warning", "unit inferred", file, what, "all angles if wrong; state inDegrees in the header")


def copied_coordinate_unit(
    name: str, values: NDArray[np.float64], angles: dict[str, NDArray[np.float64]]
) -> str | None:
    """Unit of OpenSim's `knee_angle_r_beta`, which copies the knee angle, or None where it copies nothing.

    OpenSim converts rotational coordinates when it writes a file but leaves coupled ones as they are, so that in a file
    of degrees the copy stands in radians, and in one of radians it may stand in degrees. The copied knee decides.

    values (time,) [deg or rad]: as read
    angles each (time,) [deg]: the other angles of the file, already in degrees

    >>> knee = np.array([10.0, 60.0])
    >>> copied_coordinate_unit("knee_angle_r_beta", np.radians(knee), {"knee_angle_r": knee})
    'rad'
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
    unit = min(apart, key=lambda each: apart[each])
    return unit if apart[unit] <= 0.05 * np.abs(knee).mean() + 1e-6 else None


def _largest(values: NDArray[np.float64]) -> float:
    finite = values[np.isfinite(values)]
    return float(np.abs(finite).max()) if finite.size else 0.0


def _largest_range(values: NDArray[np.float64]) -> float:
    """Widest range of a column, without the twentieth at either end, where a fit may have lost its markers."""
    columns = [column[np.isfinite(column)] for column in values.T]
    return max((float(np.ptp(np.percentile(column, PERCENTILES))) for column in columns if column.size), default=0.0)


def _undecided(file: str, why: str) -> UnitError:
    return UnitError(
        f"{file} must state degrees or radians (inDegrees=yes or no)",
        f"its header is silent and {why}",
        "Add the line inDegrees=yes or inDegrees=no before endheader.",
    )
