"""Whether what is called right is right: markers, angles, plates and muscles, held against how a walk goes."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gaitdisc.errors import ChannelError, GaitdiscError, UnitError
from gaitdisc.kinetics.joint_moments import swings
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.kinetics.plate_steps import BEYOND_EDGE_M, FootPath, Weight, foot_paths, plate_steps, weigh_steps
from gaitdisc.kinetics.platform import LEAST_LOAD_N, Platform, Wrench, platforms
from gaitdisc.processing.contact_choice import find_marker_names
from gaitdisc.recording import Finding, Recording, Strides, Trial
from gaitdisc.signals.direction import marker_position
from gaitdisc.signals.emg import HIGHPASS_HZ, envelopes, live_channels, order_of_muscles
from gaitdisc.signals.sides import load_findings, marker_side_findings, sway_findings

TOES = (("RTOE", "LTOE"), ("RMT5", "LMT5"), ("RMT1", "LMT1"), ("R.Toe.Tip", "L.Toe.Tip"), ("RTOE1", "LTOE1"))
FEWEST = 2  # steps
TOES_AHEAD = 0.3  # of heel to toe marker: toes are a quarter of the foot, and the marker lies behind them
STANDS_STILL = 0.02  # of the weight: who stands sways by less than half of it
NOTED, WRONG = 0.03, 0.05  # of the mass: plates and scales agree within 1 %, clothes and shoes are 1 to 2 kg
MOST, LEAST = 0.75, 0.25  # share of the steps that have their foot, exchanged and as they are


def side_findings(trial: Trial, strides: Mapping[str, Strides], weight_n: float | None = None) -> list[Finding]:
    """What shows exchanged sides, plates or muscles, or plates against feet or, where known, the person's weight."""
    findings: list[Finding] = []
    if "markers" in trial.streams:
        findings += marker_side_findings(trial.stream("markers"))
        findings += _plate_findings(trial, weight_n) if "forces" in trial.streams else []
    if "kinematics" in trial.streams:
        findings += sway_findings(trial.stream("kinematics"), list(strides.values()))
    if {"kinematics", "forces"} <= set(trial.streams):
        findings += load_findings(trial.stream("kinematics"), trial.stream("forces"))
    if "emg" in trial.streams and strides:
        findings += _muscle_findings(trial.stream("emg"), strides)
    return findings


def _muscle_findings(emg: Recording, strides: Mapping[str, Strides]) -> list[Finding]:
    if not (emg.values < 0).any():  # an envelope
        return order_of_muscles(emg, strides)
    live = live_channels(emg)
    if not live or emg.rate_hz <= 2 * HIGHPASS_HZ:
        return []
    try:
        envelope = envelopes(emg.selected(live))
    except GaitdiscError:  # too short or with gaps: nothing is checked
        return []
    return order_of_muscles(envelope, strides)


def _feet_on_plates(trial: Trial) -> tuple[dict[str, FootPath], list[Platform], list[str]]:
    """Paths of the feet by their markers, platforms, and the pelvis's markers; a GaitdiscError where one is lacking."""
    markers = trial.stream("markers")
    there = {name.rsplit(".", 1)[0] for name in markers.names}
    toes = next((pair for pair in TOES if set(pair) <= there), None)
    heels, pelvis = find_marker_names(markers)
    if toes is None or "forces" not in trial.streams:
        raise ChannelError(
            "to compare plates with the feet, there must be toe markers and forces",
            f"{trial.name} lacks toe markers or forces",
            "Name the markers in [channels].",
        )
    return foot_paths(markers, heels, dict(zip("rl", toes, strict=True))), platforms(trial), pelvis


def _plate_findings(trial: Trial, weight_n: float | None) -> list[Finding]:
    """Steps whose force contradicts the feet or the weight, or that two feet made; or that two plates are exchanged."""
    markers, file = trial.stream("markers"), trial.stream("forces").source.file or trial.name
    try:
        feet, plates, pelvis = _feet_on_plates(trial)
        steps = plate_steps(plates, feet) if len(markers.time) > 1 else []  # a static trial may be a single frame
        if weight_n:
            height = np.mean([marker_position(markers, name) for name in pelvis], axis=0) @ plates[0].up
            steps = weigh_steps(steps, plates, swings(trial, feet), Weight(weight_n, markers.time, height))
        other = [_exchange_place(plate, second) for plate, second in zip(plates, plates[::-1], strict=True)]
        as_is = [not step.doubt for step in steps]
        astray = len(plates) == 2 and len(as_is) >= FEWEST and sum(as_is) <= LEAST * len(as_is)
        exchanged = [not step.doubt for step in plate_steps(other, feet)] if astray else []
    except GaitdiscError:  # no wrench or no foot: moments says why
        return []
    if exchanged and sum(exchanged) >= MOST * len(exchanged):
        names = " and ".join(platform.name for platform in plates)
        what = f"the centre of pressure lies under the foot in {sum(as_is)} of {len(as_is)} steps, and in "
        what += f"{sum(exchanged)} of {len(exchanged)} if the channels of {names} are swapped"
        spoils = "the assignment of feet to plates, moments and powers; swap the channels of the two plates"
        spans = tuple(step.span for step in steps)
        return [Finding("warning", "swapped plates", file, what=what, spoils=spoils, channel=names, spans=spans)]
    findings = []
    for doubt in ("warning", "note"):  # one finding of all such steps: a belt has hundreds
        doubted = [finding for step in steps if step.doubt == doubt and (finding := step.finding(file))]
        more = f" (and {len(doubted) - 1} more)" if len(doubted) > 1 else ""
        spans = tuple(span for finding in doubted for span in finding.spans)
        findings += [replace(doubted[0], what=doubted[0].what + more, spans=spans)] if doubted else []
    return findings


def standing_weight_n(trial: Trial) -> float | None:
    """Weight of who stands still with heels and toes of both feet on the plates [N]; None where that is not seen."""
    try:
        feet, plates, _ = _feet_on_plates(trial)
    except GaitdiscError:
        return None
    loaded = [plate.surface for plate in plates if plate.surface is not None and np.median(plate.load_n) > LEAST_LOAD_N]
    points = [point for foot in feet.values() for point in (foot.heel, foot.toe + TOES_AHEAD * (foot.toe - foot.heel))]
    on = all(any(np.nanmedian(surface.outside(point)) < BEYOND_EDGE_M for surface in loaded) for point in points)
    total = np.sum([plate.load_n for plate in plates], axis=0)
    still = loaded and np.std(total) < STANDS_STILL * np.median(total)
    return float(np.median(total)) if on and still else None


def check_weight(weighed_n: float | None, mass_kg: float | None, file: str) -> list[Finding]:
    """Say that the stated mass is not that on the plates; a UnitError where moments per kg are worth nothing."""
    off = abs(weighed_n / (mass_kg * GRAVITY) - 1) if weighed_n and mass_kg else 0.0
    if weighed_n is None or off <= NOTED:
        return []
    what = f"the plates show {weighed_n / GRAVITY:.1f} kg in the static trial, but the stated mass is {mass_kg:.1f} kg"
    if off > WRONG:
        needed = f"for moments per kg, body mass and force plates must agree within {100 * WRONG:.0f} %"
        raise UnitError(needed, what, "Weigh the person again. Correct the mass, or the gain of the plates.")
    return [Finding("warning", "body weight", file, what, f"moments and powers, by {100 * off:.0f} %; weigh again")]


def _exchange_place(platform: Platform, other: Platform) -> Platform:
    """Platform with its own force at the other's place, or with the other's foot where the file names feet."""
    if platform.surface is None or other.surface is None:
        return replace(platform, side=other.side)
    wrench = Wrench.at(other.point, platform.wrench.force, platform.wrench.about(platform.point))
    return replace(platform, wrench=wrench, point=other.point, surface=other.surface)
