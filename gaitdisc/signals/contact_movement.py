"""Initial contact and foot off from markers and joint angles, where neither plate nor event of the file has them.

From markers: Zeni 2008. No joint angle touches the ground, so times from angles alone are stand-ins, one for each
stride and at nearly the same percent of it. Measured on 19 contacts of six young people with foot strikes of their own
(young_straight_and_turn, straight walking): the knee is straightest at the end of swing at 97 % of the stride (94 to
99, sd 1.4 %), the hip is most flexed at 86 % (81 to 104, sd 6 %). In running the order is the same; the offset was not
measured. Nothing is corrected here; `processing.contact_choice` takes it off where a plate sees one step.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.signal import find_peaks

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Recording
from gaitdisc.recording.arrays import Span, Values, mean_step
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.direction import Direction, marker_position, pelvis_position, walking_direction
from gaitdisc.signals.gaps import fill_gaps, without_spikes
from gaitdisc.signals.strides import MIN_S, stride_period

FEWEST_SWING = 0.5  # of the usual excursion of the heel
SMOOTH_HZ = 10.0
CYCLE_CUTOFF = 1.7  # of the stride frequency: leaves one hip peak a stride
BEFORE_HIP_PEAK, AFTER_KNEE_PEAK = 0.55, 0.42  # of a period, where the swing's knee peak and the extension after it lie
FEWEST_HIP_DEG = 5.0
FROM, TO = 0.25, 0.85  # of a stride after initial contact, where foot off lies in walking and running


def marker_contacts(
    markers: Recording, heels: Mapping[str, str], pelvis: Sequence[str], direction: Direction | None = None
) -> dict[str, Contacts]:
    """Contacts of both feet: where the heel is farthest in front of the pelvis.

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
    bridged = fill_gaps(without_spikes(markers.selected([name for name in markers.names if name in needed])))
    centre = pelvis_position(bridged, pelvis)
    contacts = {}
    for side, heel in heels.items():
        swung = marker_position(bridged, heel) - centre
        ahead = direction.ahead(swung)
        swing = float(np.subtract(*np.nanpercentile(ahead, [95, 5]))) if np.isfinite(ahead).any() else 0.0
        if swing < 0.1:
            raise StrideError(
                f"heel marker {heel} must swing by at least 0.1 m relative to the pelvis to show contacts",
                f"{markers.source.file or 'the recording'}: it swings by {swing:.3f} m along the direction of walking",
                "Check the direction, the marker's name and whether the trial is a walk.",
            )
        step = mean_step(markers.time)
        known = np.where(np.isfinite(ahead), ahead, -np.inf)
        peaks, _ = find_peaks(known, distance=max(1, round(MIN_S / step)))
        swings = [peak for peak in peaks if _prominent(ahead, peak, FEWEST_SWING * swing)]
        times = np.array([markers.time[peak] + step * _vertex(ahead, peak) for peak in swings])
        times = _of_each_step(markers.time, swung, direction, times)
        note = f"contact if {heel} is farthest in front of {', '.join(pelvis)}; {direction.how}"
        contacts[side] = Contacts(times, side, "markers", note=note)
    return contacts


def _of_each_step(time: Values, swung: Values, direction: Direction, times: Values) -> Values:
    """Peaks again, each along one direction: a line that turns moves the peak of a heel that lies beside it."""
    if direction.headings is None:
        return times
    step = mean_step(time)
    reach = round(MIN_S / 2 / step)
    peaks = []
    for at in times:
        middle = round((at - time[0]) / step)
        ahead = direction.ahead(swung, middle)
        first, last = max(1, middle - reach), min(len(ahead) - 1, middle + reach + 1)
        top = first + int(np.argmax(np.where(np.isfinite(ahead[first:last]), ahead[first:last], -np.inf)))
        inside = ahead[top] >= max(ahead[top - 1], ahead[top + 1])
        peaks.append(time[top] + step * _vertex(ahead, top) if inside else at)
    return np.unique(peaks)


def _prominent(x: Values, peak: int, prominence: float) -> bool:
    """Rises by `prominence` before the peak (the swing), and begins to fall after it (by a fifth of that)."""
    for side, enough in ((x[:peak][::-1], prominence), (x[peak + 1 :], prominence / 5)):
        higher = np.flatnonzero(~(side <= x[peak]))
        part = side[: higher[0]] if len(higher) else side
        if not len(part) or x[peak] - part.min() < enough:
            return False
    return True


def _vertex(x: Values, peak: int) -> float:
    """How far beside a peak the parabola through it and its neighbours is highest [samples]."""
    left, centre, right = x[peak - 1 : peak + 2]
    bend = left - 2 * centre + right
    return float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5)) if np.isfinite(bend) and bend < 0 else 0.0


def angle_contacts(kinematics: Recording, sides: tuple[str, ...] = ("r", "l")) -> dict[str, Contacts]:
    """Contacts from hip and knee flexion: the end of the knee's extension in late swing.

    Strides are counted on the hip: its period comes from the autocorrelation, a low-pass at 1.7 times the stride
    frequency leaves one flexion peak a stride, and peaks need a third of the usual excursion. In each, the knee's swing
    peak is found in the 55 % of a period before, and contact is put at the knee's minimum in the 42 % after that. Where
    there is no knee, the hip's own peak stands instead. The module says what percent of the stride both stand for.

    kinematics: `hip_flexion_<side>` and, for the better mark, `knee_angle_<side>`, flexion positive [deg]
    """
    contacts = {}
    for side in sides:
        name = f"hip_flexion_{side}"
        if name not in kinematics.names:
            raise ChannelError(
                "contacts from angles must have hip flexion",
                f"{kinematics.source.file or 'the recording'} has {len(kinematics.names)} channels, but not {name!r}",
                "Map the column in the study's [channels], or choose another detector.",
            )
        peaks, period = _cycles(kinematics, name)
        knee = f"knee_angle_{side}"
        if knee in kinematics.names:
            times = _terminal_extensions(kinematics, knee, peaks, period)
            note = "end of knee extension in late swing, at about 97 % of a stride that a force plate would show"
        else:
            times = _hip_peaks(kinematics, name, peaks, period)
            note = "peak hip flexion, at about 86 % of a stride that a force plate would show"
        contacts[side] = Contacts(np.unique(times), side, "angles", note=note)
    return contacts


def _cycles(kinematics: Recording, name: str) -> tuple[Values, float]:
    """Time of the one hip peak a stride, and the period [s]."""
    hip = kinematics.selected([name])
    period, regularity = stride_period(hip.values[:, 0], hip.rate_hz)
    known = hip.values[np.isfinite(hip.values)]
    reach = float(np.subtract(*np.percentile(known, [95, 5]))) if len(known) else 0.0
    if not np.isfinite(period) or reach < FEWEST_HIP_DEG:
        raise StrideError(
            f"for strides from angles, the hip must swing by at least {FEWEST_HIP_DEG:g} deg and repeat its motion",
            f"{hip.source.file or 'the recording'}, {name}: the range is {reach:.1f} deg, and the regularity is "
            f"{regularity:.2f} in {hip.duration_s:.1f} s",
            "Check whether the trial is a walk and whether the angle is in deg.",
        )
    slow = low_pass(hip, CYCLE_CUTOFF / period).values[:, 0]
    slow_reach = float(np.subtract(*np.nanpercentile(slow, [95, 5])))
    filled = np.where(np.isfinite(slow), slow, np.nanmin(slow))
    peaks, _ = find_peaks(filled, prominence=slow_reach / 3, distance=max(1, round(0.5 * period * hip.rate_hz)))
    return hip.time[peaks], period


def _terminal_extensions(kinematics: Recording, knee: str, peaks: Values, period: float) -> Values:
    time, x = _smooth(kinematics, knee)
    times = []
    for peak in peaks:
        first, last = np.searchsorted(time, [peak - BEFORE_HIP_PEAK * period, peak + 0.1 * period])
        swing = x[first:last]
        if not len(swing) or np.isnan(swing).any():
            continue
        top = first + int(np.argmax(swing))
        after = x[top : np.searchsorted(time, time[top] + AFTER_KNEE_PEAK * period)]
        lows = np.flatnonzero((after[1:-1] < after[:-2]) & (after[1:-1] <= after[2:])) + 1
        if top > first and len(lows) and np.isfinite(after).all():
            times.append(float(time[top + lows[np.argmin(after[lows])]]))
    return np.array(times)


def _hip_peaks(kinematics: Recording, hip: str, peaks: Values, period: float) -> Values:
    time, x = _smooth(kinematics, hip)
    times = []
    for peak in peaks:
        first, last = np.searchsorted(time, [peak - 0.25 * period, peak + 0.25 * period])
        if np.isfinite(x[first:last]).all():
            top = first + int(np.argmax(x[first:last]))
            if first < top < last - 1:
                times.append(float(time[top]))
    return np.array(times)


def stance_windows(contacts: Values, stride_s: float) -> list[Span]:
    """Spans in which a foot leaves the ground, one for each contact and one for the stance before the first.

    stride_s: usual stride, for the contact that is the last [s]

    >>> stance_windows(np.array([1.0]), 1.0)
    [Span(start=0.25, end=0.85), Span(start=1.25, end=1.85)]
    """
    if not len(contacts):
        return []
    starts = [float(contacts[0]) - stride_s, *map(float, contacts)]
    lengths = [stride_s, *map(float, np.diff(contacts)), stride_s]
    return [Span(start + FROM * length, start + TO * length) for start, length in zip(starts, lengths, strict=True)]


def marker_foot_off(
    markers: Recording, toe: str, pelvis: Sequence[str], direction: Direction, windows: Sequence[Span]
) -> Values:
    """Times at which a toe is farthest behind the pelvis, one for each window that has such a time [s].

    toe: marker at the toes; one at the heel leaves earlier
    windows: from `stance_windows`
    Source: Zeni (2008), as in `marker_contacts`. Differs: in a turn each step has its own direction.
    """
    needed = {f"{name}.{axis}" for name in (toe, *pelvis) for axis in "xyz"}
    bridged = fill_gaps(markers.selected([name for name in markers.names if name in needed]))
    swung = marker_position(bridged, toe) - pelvis_position(bridged, pelvis)
    return _lowest_in(windows, markers.time, lambda middle: direction.ahead(swung, middle))


def angle_foot_off(kinematics: Recording, ankle: str, windows: Sequence[Span]) -> Values:
    """Times at which an ankle is most plantarflexed, one for each of `stance_windows` that has such a time [s]."""
    time, x = _smooth(kinematics, ankle)
    return _lowest_in(windows, time, lambda _: x)


def _smooth(kinematics: Recording, name: str) -> tuple[Values, Values]:
    """Times of one angle, and the angle without what is faster than a step."""
    smooth = low_pass(kinematics.selected([name]), min(SMOOTH_HZ, 0.4 * kinematics.rate_hz))
    return smooth.time, smooth.values[:, 0]


def _lowest_in(windows: Sequence[Span], time: Values, course: Callable[[int], Values]) -> Values:
    """Times [s] at which a course (time,), as it is for the middle sample of a window, is lowest inside each window.

    None where the lowest value lies at an end of the window, or a value is missing.
    """
    times = []
    for window in windows:
        first, last = np.searchsorted(time, window)
        x = course((first + last) // 2)[first:last] if last - first >= 3 else np.empty(0)
        low = int(np.argmin(x)) if len(x) and np.isfinite(x).all() else 0
        if 0 < low < len(x) - 1:
            times.append(time[first + low] + _vertex(-x, low) * (time[first + 1] - time[first]))
    return np.unique(np.asarray(times, float))
