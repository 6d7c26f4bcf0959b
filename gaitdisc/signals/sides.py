"""Left and right: whether the contacts of a side belong to the knee of that side."""

from __future__ import annotations

import numpy as np

from gaitdisc.errors import StrideError
from gaitdisc.recording import PERCENT, Recording, Strides

SWING = (52.0, 92.0)  # % stride between which the knee's peak lies, in walking and running
FEWEST_DEG = 5.0


def knee_peak_percent(kinematics: Recording, strides: Strides, knee: str) -> float:
    """Percent stride at which the mean curve of a knee is most flexed.

    kinematics: with the knee's flexion [deg]
    """
    curves = strides.normalised(kinematics.selected([knee]))[:, :, 0]
    curves = curves[np.isfinite(curves).all(axis=1)]
    if not len(curves):
        return float("nan")
    mean = np.median(curves, axis=0)
    return float(PERCENT[np.argmax(mean)]) if np.ptp(mean) >= FEWEST_DEG else float("nan")


def verify_sides(kinematics: Recording, strides: Strides) -> float:
    """Refuse strides of one side whose knee on that side does not swing before the next contact.

    The knee bends most in swing, at about 70 % of the stride of its own foot; the other knee does so half a stride
    earlier, at about 20 %. Both being wrong means that the sides are swapped in the contacts or in the angles. Where
    the contacts come from these very angles the check holds by itself; a swap of everything cannot be seen. Verify
    that the trial is walking first (`verify_walking`).

    kinematics: with both knees, flexion positive [deg]
    returns: percent stride of the knee's peak; NaN where no stride has the knee
    """
    own, other = (f"knee_angle_{side}" for side in (strides.side, "l" if strides.side == "r" else "r"))
    at = knee_peak_percent(kinematics, strides, own)
    if not np.isfinite(at) or SWING[0] <= at <= SWING[1]:
        return at
    file = kinematics.source.file or "the recording"
    across = knee_peak_percent(kinematics, strides, other) if other in kinematics.names else float("nan")
    swapped = SWING[0] <= across <= SWING[1]
    raise StrideError(
        f"in strides of side {strides.side!r} its knee bends most in swing, at {SWING[0]:g} to {SWING[1]:g} %",
        f"{file}: {own} peaks at {at:.0f} %"
        + (f", {other} at {across:.0f} %: left and right are swapped" if swapped else ""),
        f"Swap the sides of the {strides.detector} contacts or of the angles."
        if swapped
        else "Check that knee flexion is positive and that the contacts are initial contacts.",
    )
