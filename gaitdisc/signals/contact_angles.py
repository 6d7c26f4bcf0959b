"""Initial contact from joint angles alone, for trials without forces, markers or events.

No joint angle touches the ground, so these times are stand-ins, one for each stride and at nearly the same percent of
it. Measured on 19 contacts of six young people with foot strikes of their own (young_straight_and_turn, straight
walking): the knee is straightest at the end of swing at 97 % of the stride (94 to 99 %), the hip is most flexed at 86
% (81 to 104 %). So percent stride counted from these contacts runs about 3 % ahead of that from the ground where the
knee is used, with a standard deviation of 1.4 %, and about 14 % where only the hip is there, with one of 6 %. In
running the order of the marks is the same; the offset was not measured. Nothing is corrected here: the offset is
constant for a person and drops out of stride durations, but not out of a comparison with percent strides counted from a
plate; `processing.contact_choice` takes it off where a plate sees one step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Recording
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.period import stride_period

SMOOTH_HZ = 10.0
CYCLE_CUTOFF = 1.7  # of the stride frequency: leaves one hip peak a stride
BEFORE_HIP_PEAK, AFTER_KNEE_PEAK = 0.55, 0.42  # of a period, where the swing's knee peak and the extension after it lie
FEWEST_HIP_DEG = 5.0


def angle_contacts(kinematics: Recording, sides: tuple[str, ...] = ("r", "l")) -> dict[str, Contacts]:
    """Contacts from hip and knee flexion: the end of the knee's extension in late swing.

    Strides are counted on the hip: its period comes from the autocorrelation, a low-pass at 1.7 times the stride
    frequency leaves one flexion peak a stride, and peaks need a third of the usual excursion. In each, the knee's swing
    peak is found in the 55 % of a period before, and contact is put at the knee's minimum in the 42 % after that. Where
    there is no knee, the hip's own peak stands instead. The module says what percent of the stride both stand for.

    kinematics: `hip_flexion_<side>` and, for the better mark, `knee_angle_<side>`, flexion positive [deg]
    """
    found = {}
    for side in sides:
        name = f"hip_flexion_{side}"
        if name not in kinematics.names:
            raise ChannelError(
                "contacts from angles need the hip's flexion",
                f"{kinematics.source.file or 'the recording'} has {len(kinematics.names)} channels, no {name!r}",
                "Map the column in the study's [channels], or choose another detector.",
            )
        peaks, period = _cycles(kinematics, name)
        knee = f"knee_angle_{side}"
        if knee in kinematics.names:
            times = _terminal_extensions(kinematics, knee, peaks, period)
            note = "end of the knee's extension in late swing, at about 97 % of the stride that a plate would see"
        else:
            times = _hip_peaks(kinematics, name, peaks, period)
            note = "hip flexion peak, at about 86 % of the stride that a plate would see"
        found[side] = Contacts(np.unique(times), side, "angles", note=note)
    return found


def _cycles(kinematics: Recording, name: str) -> tuple[NDArray[np.float64], float]:
    """Time of the one hip peak a stride, and the period [s]."""
    hip = kinematics.selected([name])
    period, regularity = stride_period(hip.values[:, 0], hip.rate_hz)
    known = hip.values[np.isfinite(hip.values)]
    reach = float(np.subtract(*np.percentile(known, [95, 5]))) if len(known) else 0.0
    if not np.isfinite(period) or reach < FEWEST_HIP_DEG:
        raise StrideError(
            f"strides from angles need a hip that swings {FEWEST_HIP_DEG:g} deg or more and repeats",
            f"{hip.source.file or 'the recording'}, {name}: {reach:.1f} deg, regularity {regularity:.2f}",
            "Check that the trial is walking and that the angle is in deg.",
        )
    slow = lowpassed(hip, CYCLE_CUTOFF / period).values[:, 0]
    slow_reach = float(np.subtract(*np.nanpercentile(slow, [95, 5])))
    peaks, _ = find_peaks(
        np.where(np.isfinite(slow), slow, np.nanmin(slow)),
        prominence=slow_reach / 3,
        distance=max(1, round(0.5 * period * hip.rate_hz)),
    )
    return hip.time[peaks], period


def _terminal_extensions(
    kinematics: Recording, knee: str, peaks: NDArray[np.float64], period: float
) -> NDArray[np.float64]:
    smooth = lowpassed(kinematics.selected([knee]), min(SMOOTH_HZ, 0.4 * kinematics.rate_hz))
    x, time = smooth.values[:, 0], smooth.time
    found = []
    for peak in peaks:
        first, last = np.searchsorted(time, [peak - BEFORE_HIP_PEAK * period, peak + 0.1 * period])
        swing = x[first:last]
        if not len(swing) or np.isnan(swing).any():
            continue
        top = first + int(np.argmax(swing))
        after = x[top : np.searchsorted(time, time[top] + AFTER_KNEE_PEAK * period)]
        lows = np.flatnonzero((after[1:-1] < after[:-2]) & (after[1:-1] <= after[2:])) + 1
        if top > first and len(lows) and np.isfinite(after).all():
            found.append(float(time[top + lows[np.argmin(after[lows])]]))
    return np.array(found)


def _hip_peaks(kinematics: Recording, hip: str, peaks: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    smooth = lowpassed(kinematics.selected([hip]), min(SMOOTH_HZ, 0.4 * kinematics.rate_hz))
    x, time = smooth.values[:, 0], smooth.time
    found = []
    for peak in peaks:
        first, last = np.searchsorted(time, [peak - 0.25 * period, peak + 0.25 * period])
        if np.isfinite(x[first:last]).all():
            top = first + int(np.argmax(x[first:last]))
            if first < top < last - 1:
                found.append(float(time[top]))
    return np.array(found)
