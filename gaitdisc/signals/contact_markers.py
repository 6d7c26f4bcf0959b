"""Initial contact from heel and pelvis markers (Zeni 2008)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

from gaitdisc.errors import StrideError
from gaitdisc.recording import Recording
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.direction import Direction, marker_position, pelvis_position, walking_direction
from gaitdisc.signals.gaps import filled
from gaitdisc.signals.spikes import without_spikes

SHORTEST_STRIDE_S = 0.4
FEWEST_SWING = 0.5  # of the usual excursion of the heel


def marker_contacts(
    markers: Recording, heels: Mapping[str, str], pelvis: Sequence[str], direction: Direction | None = None
) -> dict[str, Contacts]:
    """Contacts of both feet: where the heel is farthest in front of the pelvis.

    markers: channels `<marker>.x`, `<marker>.y`, `<marker>.z` [m]
    heels: side (`r`, `l`) to the name of its heel marker
    direction: direction of walking; inferred (`walking_direction`) and said in the note where it is not given
    returns: for each side in `heels`; foot off (heel farthest behind the pelvis) is not given, since the toe leaves
        later
    Source: Zeni, Richards, Higginson (2008), Gait & Posture 27, 710-714. Differs: the direction need not be an axis of
        the laboratory, and in a turn each step has its own; peaks need half of the usual swing, so that a stop gives
        none; the peak is placed between samples by a parabola; gaps above 0.1 s give no contact.
    """
    direction = direction or walking_direction(markers, heels, pelvis)
    needed = {f"{name}.{axis}" for name in [*heels.values(), *pelvis] for axis in "xyz"}
    bridged = filled(without_spikes(markers.selected([name for name in markers.names if name in needed])))
    centre = pelvis_position(bridged, pelvis)
    found = {}
    for side, heel in heels.items():
        swung = marker_position(bridged, heel) - centre
        ahead = direction.ahead(swung)
        swing = float(np.subtract(*np.nanpercentile(ahead, [95, 5]))) if np.isfinite(ahead).any() else 0.0
        if swing < 0.1:
            raise StrideError(
                f"contacts from markers need heel {heel} to swing 0.1 m or more about the pelvis",
                f"{markers.source.file or 'the recording'}: {swing:.3f} m along the direction of walking",
                "Check the direction, the marker's name and that the trial is walking.",
            )
        times = _peak_times(markers.time, ahead, FEWEST_SWING * swing)
        times = _of_each_step(markers.time, swung, direction, times)
        note = f"{heel} farthest in front of {', '.join(pelvis)}; {direction.how}"
        found[side] = Contacts(times, side, "markers", note=note)
    return found


def _peak_times(time: NDArray[np.float64], x: NDArray[np.float64], prominence: float) -> NDArray[np.float64]:
    step = (time[-1] - time[0]) / (len(time) - 1)
    peaks, _ = find_peaks(np.where(np.isfinite(x), x, -np.inf), distance=max(1, round(SHORTEST_STRIDE_S / step)))
    return np.array([time[p] + step * _vertex(x, p) for p in peaks if _prominent(x, p, prominence)])


def _of_each_step(
    time: NDArray[np.float64], swung: NDArray[np.float64], direction: Direction, times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Peaks again, each along one direction: a line that turns moves the peak of a heel that lies beside it."""
    if direction.headings is None:
        return times
    step = (time[-1] - time[0]) / (len(time) - 1)
    reach = round(SHORTEST_STRIDE_S / 2 / step)
    found = []
    for at in times:
        middle = round((at - time[0]) / step)
        ahead = direction.ahead(swung, middle)
        first, last = max(1, middle - reach), min(len(ahead) - 1, middle + reach + 1)
        top = first + int(np.argmax(np.where(np.isfinite(ahead[first:last]), ahead[first:last], -np.inf)))
        inside = ahead[top] >= max(ahead[top - 1], ahead[top + 1])
        found.append(time[top] + step * _vertex(ahead, top) if inside else at)
    return np.unique(found)


def _prominent(x: NDArray[np.float64], peak: int, prominence: float) -> bool:
    """Rises by `prominence` before the peak (the swing), and begins to fall after it (by a fifth of that)."""
    for side, enough in ((x[:peak][::-1], prominence), (x[peak + 1 :], prominence / 5)):
        higher = np.flatnonzero(~(side <= x[peak]))
        part = side[: higher[0]] if len(higher) else side
        if not len(part) or x[peak] - part.min() < enough:
            return False
    return True


def _vertex(x: NDArray[np.float64], peak: int) -> float:
    left, centre, right = x[peak - 1 : peak + 2]
    bend = left - 2 * centre + right
    return float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5)) if np.isfinite(bend) and bend < 0 else 0.0
