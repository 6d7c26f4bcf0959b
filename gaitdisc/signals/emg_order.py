"""EMG of the wrong muscle or leg: the calf works while its foot stands, the tibialis anterior while it swings.

In eleven walks of six young people (young_straight_and_turn) the natural logarithm of stance over swing is 1.0 to 3.4
in the calf and -1.5 to -0.66 in the tibialis anterior; -0.1 and 0.15 in one leg of which both are clipped.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from gaitdisc.recording import Finding, Recording, Strides

STANDS, SWINGS = slice(10, 56), slice(65, 96)  # % stride
CLEAR = 0.5  # of the logarithm; below it a muscle says nothing
_CALF = re.compile(r"emg_(gas|gasmed|gaslat|gm|gl|sol)_([rl])")
_SHIN = re.compile(r"emg_(ta)_([rl])")


def stance_over_swing(envelope: Recording, strides: Strides, name: str) -> float:
    """Natural logarithm of a channel's mean in stance over that in swing; NaN without a whole stride."""
    curves = strides.normalised(envelope.selected([name]))[:, :, 0]
    curves = curves[np.isfinite(curves).all(axis=1)]
    if not len(curves):
        return float("nan")
    mean = curves.mean(axis=0)
    stands, swings = float(mean[STANDS].mean()), float(mean[SWINGS].mean())
    return float(np.log(stands / swings)) if min(stands, swings) > 0 else float("nan")


def order_of_muscles(envelope: Recording, strides: Mapping[str, Strides]) -> list[Finding]:
    """Say that calf and tibialis anterior of a leg, or the calves of both legs, are exchanged.

    A muscle alone is not tested: a foot that drops or a calf that is spastic has its own course. Two that each do what
    the other should are.
    """
    seen: dict[tuple[str, str], tuple[str, float]] = {}
    for name in envelope.names:
        for kind, pattern in (("calf", _CALF), ("shin", _SHIN)):
            found = pattern.fullmatch(name)
            if found and found[2] in strides:
                value = stance_over_swing(envelope, strides[found[2]], name)
                worst = seen.get((kind, found[2]), ("", -np.inf))[1]
                if np.isfinite(value) and value > worst:
                    seen[kind, found[2]] = name, value
    calf_swings = {side for kind, side in seen if kind == "calf" and seen[kind, side][1] < -CLEAR}
    shin_stands = {side for kind, side in seen if kind == "shin" and seen[kind, side][1] > CLEAR}
    pairs = [(seen["calf", side], seen["shin", side]) for side in sorted(calf_swings & shin_stands)]
    if calf_swings == {"l", "r"} and not shin_stands:
        pairs.append((seen["calf", "l"], seen["calf", "r"]))
    return [_finding(one, other, envelope.source.file) for one, other in pairs]


def _finding(one: tuple[str, float], other: tuple[str, float], file: str) -> Finding:
    def said(muscle: tuple[str, float]) -> str:
        more, where = np.exp(abs(muscle[1])), "its foot stands" if muscle[1] > 0 else "its foot swings"
        return f"{muscle[0]} is {more:.1f} times as strong while {where}"

    what = f"{one[0]} and {other[0]} look exchanged, or the muscles of both legs: {said(one)}, {said(other)}"
    return Finding("warning", "exchanged EMG", file, what, "both muscles; correct the labels", f"{one[0]}, {other[0]}")
