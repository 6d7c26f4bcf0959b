"""Left and right: by where markers are, by the foot that stands, and by the knee that belongs to the contacts."""

from collections.abc import Sequence

import numpy as np

from gaitdisc.channel import other_side
from gaitdisc.errors import StrideError
from gaitdisc.recording import PERCENT, Finding, Recording, Strides
from gaitdisc.recording.arrays import Values, finite_rows, finite_values
from gaitdisc.signals.direction import marker_position, nearest_axis

SWING = (52.0, 92.0)  # % stride between which the knee's peak lies, in walking and running
FEWEST_DEG = 5.0
PELVIS = (  # right and left front, right and left back
    ("RASI", "LASI", "RPSI", "LPSI"),
    ("RASI", "LASI", "SACR", "SACR"),
    ("RASIS", "LASIS", "RPSIS", "LPSIS"),
    ("R.ASIS", "L.ASIS", "R.PSIS", "L.PSIS"),
    ("R.ASIS", "L.ASIS", "V.Sacral", "V.Sacral"),
)
LEGS = (
    *((f"R{part}", f"L{part}") for part in ("KNE", "ANK", "HEE", "TOE", "CAL", "MT5")),
    *((f"R.{part}", f"L.{part}") for part in ("Knee.Lat", "Ankle.Lat", "Heel", "Toe.Tip")),
)
ASIDE_M = 0.02  # feet cross the middle in a narrow gait, knees and ankles of a whole trial hardly on the median
FEWEST = 2  # pairs of the legs that must agree
SWAY_M = 0.005  # from double support to single support; walks have 40 mm, running 14 mm or more
AGREE = 0.8  # share of the strides
LOADED, UNLOADED = 0.2, 0.05  # of the largest load
SEEN = 0.1  # of the samples, standing and in the air
BENT_MORE_DEG = 5.0  # walks at hand: each knee is bent 12 to 40 deg less under load
SUPPORT = slice(15, 41), slice(65, 91)  # % stride in which the foot, and the other foot, stands alone


def knee_peak_percent(kinematics: Recording, strides: Strides, knee: str) -> float:
    """Percent stride at which the mean curve of a knee is most flexed; NaN where it hardly bends."""
    curves = finite_rows(strides.normalised(kinematics.selected([knee]))[:, :, 0])
    if not len(curves):
        return float("nan")
    mean = np.median(curves, axis=0)
    return float(PERCENT[np.argmax(mean)]) if np.ptp(mean) >= FEWEST_DEG else float("nan")


def verify_sides(kinematics: Recording, strides: Strides) -> float:
    """Refuse strides of one side whose knee on that side does not swing before the next contact.

    The knee bends most in swing, at about 70 % of the stride of its own foot; the other knee does so half a stride
    earlier, at about 20 %. Both being wrong means that the sides are swapped in the contacts or in the angles, one that
    it is stiff. A swap of everything cannot be seen. Verify that the trial is walking first (`verify_walking`).

    returns: percent stride of the knee's peak; NaN where no stride has the knee
    """
    knee, other_knee = (f"knee_angle_{side}" for side in (strides.side, other_side(strides.side)))
    at = knee_peak_percent(kinematics, strides, knee)
    if not np.isfinite(at) or SWING[0] <= at <= SWING[1]:
        return at
    across = knee_peak_percent(kinematics, strides, other_knee) if other_knee in kinematics.names else float("nan")
    if SWING[0] <= across + 50 <= SWING[1]:  # the other knee swings while this foot stands: this knee is stiff
        return at
    swapped = SWING[0] <= across <= SWING[1]
    raise StrideError(
        f"in strides of side {strides.side!r} the knee must bend most at {SWING[0]:g} to {SWING[1]:g} % (swing)",
        f"{kinematics.source.file or 'the recording'}: {knee} peaks at {at:.0f} %"
        + (f", {other_knee} at {across:.0f} %: left and right are exchanged" if swapped else ""),
        f"Exchange the sides of the {strides.detector} contacts or of the angles."
        if swapped
        else "Check that knee flexion is positive and that the contacts are initial contacts.",
    )


def marker_side_findings(markers: Recording) -> list[Finding]:
    """Say that left and right markers are exchanged, of the pelvis or of the legs.

    Up, back and front make left and right: where the spines at the back are behind those in front and the pelvis is
    above the feet, the right spine is to the right. The median over the trial is looked at, whichever way one walks.

    returns: one warning, or none where the sides are right or the markers of the pelvis are not there
    """
    there = {name.rsplit(".", 1)[0] for name in markers.names}
    pelvis = next((names for names in PELVIS if set(names) <= there), None)
    pairs = [pair for pair in LEGS if set(pair) <= there]
    if pelvis is None or not pairs:
        return []
    right_front, left_front, right_back, left_back = (marker_position(markers, name) for name in pelvis)
    ahead = (right_front + left_front - right_back - left_back) / 2
    feet = np.median([marker_position(markers, name) for name in pairs[-1]], axis=0)
    lines = finite_rows((right_front + left_front) / 2 - feet)
    if not len(lines):
        return []
    right = np.cross(ahead, nearest_axis(np.median(lines, axis=0)))
    right /= np.maximum(np.linalg.norm(right, axis=1, keepdims=True), 1e-9)
    across = {pelvis[:2]: _aside(right_front - left_front, right)}
    for pair in pairs:
        across[pair] = _aside(marker_position(markers, pair[0]) - marker_position(markers, pair[1]), right)
    wrong = [pair for pair, metres in across.items() if metres < -ASIDE_M]
    legs = [pair for pair in wrong if pair in pairs]
    if pelvis[:2] not in wrong and len(legs) < FEWEST:
        return []
    examples = ", ".join(f"{pair[0]} is {-100 * across[pair]:.0f} cm to the left of {pair[1]}" for pair in wrong[:3])
    what = (
        f"left and right are exchanged in the labels of {len(wrong)} of {len(across)} pairs, or the frame is mirrored: "
        f"{examples}"
    )
    spoils = "both sides; correct the labels"
    return [Finding("warning", "sides", markers.source.file, what, spoils, ", ".join(wrong[0]))]


def sway_findings(kinematics: Recording, strides: Sequence[Strides]) -> list[Finding]:
    """Say that left and right of all angles are exchanged: the pelvis sways towards the foot that stands alone.

    kinematics: with `pelvis_tx`, `pelvis_tz` [m] and `pelvis_rotation` [deg] as OpenSim has them, y up
    returns: one warning where four of five strides of each foot sway to the other side, by 5 mm or more in the middle
    """
    if not strides or not {"pelvis_tx", "pelvis_tz", "pelvis_rotation"} <= set(kinematics.names):
        return []
    heading = np.radians(np.nanmedian(kinematics["pelvis_rotation"]))
    place = kinematics["pelvis_tx"] * np.sin(heading) + kinematics["pelvis_tz"] * np.cos(heading)
    pelvis = kinematics.selected(["pelvis_tz"])
    pelvis = pelvis.with_values(place[:, None])
    towards = {}
    for foot_strides in strides:
        curves = foot_strides.normalised(pelvis)[:, :, 0]
        sway = curves[:, SUPPORT[0]].mean(axis=1) - curves[:, SUPPORT[1]].mean(axis=1)
        sway = finite_values(sway) * (1.0 if foot_strides.side == "r" else -1.0)
        if len(sway):
            towards[foot_strides.side] = sway
    away = [side for side, sway in towards.items() if np.median(sway) <= -SWAY_M and np.mean(sway < 0) >= AGREE]
    if len(towards) < 2 or len(away) < 2:
        return []
    size = 1e3 * float(np.median(np.concatenate(list(towards.values()))))
    what = (
        f"left and right are exchanged in all angles, or pelvis_tz points to the left: the pelvis is {-size:.0f} mm "
        "nearer to the swing foot than to the stance foot (median of the strides)"
    )
    return [Finding("warning", "sides", kinematics.source.file, what, "both sides; correct the labels", "pelvis_tz")]


def load_findings(kinematics: Recording, forces: Recording) -> list[Finding]:
    """Say that the force of one foot goes with the knee of the other: a knee is bent least while its foot stands.

    returns: one warning where both knees bend more under load than in the air, by 5 deg or more
    """
    bent_more: dict[str, float] = {}
    for channel in forces.channels:
        knee = f"knee_angle_{channel.side}"
        if channel.quantity != "vertical_force" or not channel.side or knee not in kinematics.names:
            continue
        load = np.abs(forces[channel.name])
        bent = np.interp(forces.time, kinematics.time, kinematics[knee], np.nan, np.nan)
        known = np.isfinite(load) & np.isfinite(bent)
        peak = float(load[known].max()) if known.any() else 0.0
        stands, swings = known & (load > LOADED * peak), known & (load < UNLOADED * peak)
        if min(stands.mean(), swings.mean()) >= SEEN:
            bent_more[channel.side] = float(bent[stands].mean() - bent[swings].mean())
    if set(bent_more) != {"l", "r"} or min(bent_more.values()) < BENT_MORE_DEG:
        return []
    knees = " and ".join(f"knee_angle_{side} {more:+.0f} deg" for side, more in sorted(bent_more.items()))
    what = (
        "left and right are exchanged in the forces or in the angles: each knee bends more under its own force than in "
        f"the air ({knees})"
    )
    file = f"{forces.source.file}, {kinematics.source.file}"
    return [Finding("warning", "sides", file, what, "both sides; exchange the forces or the angles")]


def _aside(apart: Values, right: Values) -> float:
    """How far to the right one marker is of the other, over the trial [m]."""
    metres = finite_values(np.einsum("tx,tx->t", apart, right))
    return float(np.median(metres)) if len(metres) else 0.0
