"""Foot off, where no plate and no event of the file has it: from the toe's path, or from the ankle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Recording
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.direction import Direction, marker_position, pelvis_position
from gaitdisc.signals.gaps import filled

FROM, TO = 0.25, 0.85  # of a stride after initial contact, where foot off lies in walking and running
SMOOTH_HZ = 10.0


def stance_windows(contacts: NDArray[np.float64], stride_s: float) -> list[tuple[float, float]]:
    """Spans in which a foot leaves the ground, one for each contact and one for the stance before the first [s].

    contacts (contact,) [s]: of one foot
    stride_s: usual stride, for the contact that is the last [s]

    >>> stance_windows(np.array([1.0, 2.0]), 1.0)
    [(0.25, 0.85), (1.25, 1.85), (2.25, 2.85)]
    """
    if not len(contacts):
        return []
    starts = [float(contacts[0]) - stride_s, *map(float, contacts)]
    lengths = [stride_s, *map(float, np.diff(contacts)), stride_s]
    return [(start + FROM * own, start + TO * own) for start, own in zip(starts, lengths, strict=True)]


def marker_foot_off(
    markers: Recording, toe: str, pelvis: Sequence[str], direction: Direction, windows: Sequence[tuple[float, float]]
) -> NDArray[np.float64]:
    """Times at which a toe is farthest behind the pelvis, one for each window that has such a time [s].

    markers: channels `<marker>.x`, `<marker>.y`, `<marker>.z` [m]
    toe: marker at the toes; one at the heel leaves earlier
    windows sequence of (float, float): from `stance_windows` [s]
    Source: Zeni, Richards, Higginson (2008), Gait & Posture 27, 710-714. Differs: in a turn each step has its own
        direction.
    """
    needed = {f"{name}.{axis}" for name in (toe, *pelvis) for axis in "xyz"}
    bridged = filled(markers.selected([name for name in markers.names if name in needed]))
    swung = marker_position(bridged, toe) - pelvis_position(bridged, pelvis)
    found = []
    for start, end in windows:
        first, last = np.searchsorted(markers.time, [start, end])
        if last - first < 3:
            continue
        behind = direction.ahead(swung, (first + last) // 2)[first:last]
        found.append(_lowest(markers.time[first:last], behind))
    return _known(found)


def angle_foot_off(kinematics: Recording, ankle: str, windows: Sequence[tuple[float, float]]) -> NDArray[np.float64]:
    """Times at which an ankle is most plantarflexed, one for each window that has such a time [s].

    kinematics: with the ankle, dorsiflexion positive [deg]
    windows sequence of (float, float): from `stance_windows` [s]
    """
    smooth = lowpassed(kinematics.selected([ankle]), min(SMOOTH_HZ, 0.4 * kinematics.rate_hz))
    found = []
    for start, end in windows:
        first, last = np.searchsorted(smooth.time, [start, end])
        if last - first >= 3:
            found.append(_lowest(smooth.time[first:last], smooth.values[first:last, 0]))
    return _known(found)


def _lowest(time: NDArray[np.float64], x: NDArray[np.float64]) -> float:
    """Time of the lowest value inside; NaN where it lies at an end, or a value is missing."""
    if not np.isfinite(x).all():
        return float("nan")
    low = int(np.argmin(x))
    if low in (0, len(x) - 1):
        return float("nan")
    left, centre, right = x[low - 1 : low + 2]
    bend = left - 2 * centre + right
    share = 0.5 * (left - right) / bend if bend > 0 else 0.0
    return float(time[low] + share * (time[1] - time[0]))


def _known(found: list[float]) -> NDArray[np.float64]:
    times = np.asarray(found, float)
    return np.unique(times[np.isfinite(times)])
