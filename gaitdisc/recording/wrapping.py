"""Angles that come round to where they began: a heading that passes 180 deg goes on at -180 deg, and nothing jumped.

Whatever mixes neighbouring samples (a filter, a spline, a derivative, a mean over strides) has to see such an angle go
on. A joint angle never comes round: where one leaps by 300 deg, it is bad data and stays as it is.
"""

import re
from dataclasses import replace

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.recording import Recording

HEADINGS = re.compile(
    r"^(pelvis_rotation|\w*(pelvis|thorax|trunk|head|foot_?progress(ion)?)_?angles?(_[rl])?(\.[xyz])?"
    r"|(\w*_)?(heading|yaw)(_\w+)?)$",
    re.IGNORECASE,
)
TURNS = {"deg": 360.0, "rad": 2 * np.pi}
LEAST_LEAP = 0.75  # of a turn, from one sample to the next


def find_turn(channel: Channel) -> float | None:
    """One turn in the unit of a channel that may come round; None for every other channel.

    >>> find_turn(Channel("pelvis_rotation", "angle", "deg")), find_turn(Channel("knee_angle_r", "angle", "deg", "r"))
    (360.0, None)
    """
    return TURNS.get(channel.unit) if channel.quantity == "angle" and HEADINGS.match(channel.name) else None


def unwrap(recording: Recording) -> Recording:
    """Recording whose headings go on where they came round.

    recording: any channels; only headings (of pelvis, trunk, head, foot) that leap by 270 deg or more from one sample
        to the next, or by more than 180 deg over a gap, are changed

    >>> x = np.array([[170.0], [178.0], [-174.0]])
    >>> unwrap(Recording(np.arange(3) / 100, x, (Channel("pelvis_rotation", "angle", "deg"),))).values.ravel()
    array([170., 178., 186.])
    """
    values = recording.values
    for column, channel in enumerate(recording.channels):
        turn = find_turn(channel)
        if turn is None:
            continue
        known = np.flatnonzero(np.isfinite(recording.values[:, column]))
        x = recording.values[known, column]
        leaps = np.diff(x)
        least = np.where(np.diff(known) == 1, LEAST_LEAP, 0.5) * turn
        back = -turn * np.round(leaps / turn) * (np.abs(leaps) > least)
        if back.any():
            values = np.array(values)
            values[known[1:], column] += np.cumsum(back)
    return recording if values is recording.values else replace(recording, values=values)


def wrap_recording(recording: Recording, as_in: Recording) -> Recording:
    """Recording whose headings come round again as those of another one do.

    as_in: before it was unwrapped; where its smallest value is not negative, headings run from 0 to 360 deg, else from
        -180 to 180 deg

    >>> x = np.array([[170.0], [178.0], [-174.0]])
    >>> raw = Recording(np.arange(3) / 100, x, (Channel("pelvis_rotation", "angle", "deg"),))
    >>> wrap_recording(unwrap(raw), raw).values.ravel()
    array([ 170.,  178., -174.])
    """
    plain = unwrap(as_in)
    if plain is as_in:
        return recording
    values = np.array(recording.values)
    for column, channel in enumerate(recording.channels):
        turn = find_turn(channel)
        if turn is not None and not np.array_equal(plain.values[:, column], as_in.values[:, column], equal_nan=True):
            low = 0.0 if np.nanmin(as_in.values[:, column]) >= 0 else -turn / 2
            values[:, column] = (values[:, column] - low) % turn + low
    return replace(recording, values=values)


def in_one_turn(curves: Values, turn: float) -> Values:
    """Curves (curve, point) of a heading moved by whole turns, so that their mean is the mean of their directions.

    >>> in_one_turn(np.array([[170.0, 175.0], [-190.0, -185.0]]), 360.0)
    array([[170., 175.],
           [170., 175.]])
    """
    known = np.isfinite(curves).any(axis=1)
    if not known.any():
        return curves
    middles = np.nanmean(curves[known], axis=1)
    directions = np.exp(2j * np.pi * middles / turn)
    middle = float(np.angle(directions.mean())) * turn / (2 * np.pi)
    moved = np.array(curves)
    moved[known] -= turn * np.round((middles - middle) / turn)[:, None]
    return moved
