"""Whether what is called right is right: markers, angles, plates and muscles, held against how a walk goes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from gaitdisc.errors import GaitdiscError
from gaitdisc.kinetics.plate_steps import foot_paths, plate_steps
from gaitdisc.kinetics.platform import Platform, platforms
from gaitdisc.kinetics.wrench import Wrench
from gaitdisc.processing.contact_choice import named_markers
from gaitdisc.recording import Finding, Recording, Strides, Trial
from gaitdisc.signals.emg_order import order_of_muscles
from gaitdisc.signals.emg_quality import live_channels
from gaitdisc.signals.envelope import HIGHPASS_HZ, enveloped
from gaitdisc.signals.side_labels import load_findings, marker_side_findings, sway_findings

TOES = (("RTOE", "LTOE"), ("RMT5", "LMT5"), ("RMT1", "LMT1"), ("R.Toe.Tip", "L.Toe.Tip"), ("RTOE1", "LTOE1"))
FEWEST = 2  # steps
MOST, LEAST = 0.75, 0.25  # share of the steps that have their foot, exchanged and as they are


def side_findings(trial: Trial, strides: Mapping[str, Strides]) -> list[Finding]:
    """What shows that sides, plates or muscles bear another's name."""
    findings: list[Finding] = []
    if "markers" in trial.streams:
        findings += marker_side_findings(trial.stream("markers"))
        findings += _plate_findings(trial) if "forces" in trial.streams else []
    if "kinematics" in trial.streams:
        findings += sway_findings(trial.stream("kinematics"), list(strides.values()))
    if {"kinematics", "forces"} <= set(trial.streams):
        findings += load_findings(trial.stream("kinematics"), trial.stream("forces"))
    if "emg" in trial.streams and strides:
        findings += _muscle_findings(trial.stream("emg"), strides)
    return findings


def _muscle_findings(emg: Recording, strides: Mapping[str, Strides]) -> list[Finding]:
    raw = bool((emg.values < 0).any())
    if not raw:
        return order_of_muscles(emg, strides)
    live = live_channels(emg)
    if not live or emg.rate_hz <= 2 * HIGHPASS_HZ:
        return []
    try:
        envelope = enveloped(emg.selected(live))
    except GaitdiscError:  # too short or with gaps: nothing is checked
        return []
    return order_of_muscles(envelope, strides)


def _plate_findings(trial: Trial) -> list[Finding]:
    """Say that two plates or belts bear each other's force: exchanged, the centre of pressure is under the feet."""
    markers = trial.stream("markers")
    there = {name.rsplit(".", 1)[0] for name in markers.names}
    toes = next((pair for pair in TOES if set(pair) <= there), None)
    if toes is None:
        return []
    try:
        heels, _ = named_markers(markers)
        found = platforms(trial)
        feet = foot_paths(markers, {"r": (heels["r"], toes[0]), "l": (heels["l"], toes[1])})
        if len(found) != 2:
            return []
        other = [_with_place_of(one, second) for one, second in zip(found, found[::-1], strict=True)]
        as_is, exchanged = (_with_foot(plates, plate_steps(plates, feet)) for plates in (found, other))
    except GaitdiscError:  # no wrench or no foot: moments says why
        return []
    if len(as_is) < FEWEST or sum(as_is) > LEAST * len(as_is) or sum(exchanged) < MOST * len(exchanged):
        return []
    names = " and ".join(platform.name for platform in found)
    what = (
        f"the centre of pressure lies under the foot in {sum(as_is)} of {len(as_is)} steps, and in {sum(exchanged)} of "
        f"{len(exchanged)} with the two exchanged: {names} are swapped"
    )
    spoils = "which foot is on which plate, moments and powers; exchange their channels"
    return [Finding("warning", "swapped plates", trial.stream("forces").source.file, what, spoils, names)]


def _with_place_of(one: Platform, other: Platform) -> Platform:
    """Platform with its own force at the other's place, or with the other's foot where the file names feet."""
    if one.surface is None or other.surface is None:
        return replace(one, side=other.side)
    wrench = Wrench.at(other.point, one.wrench.force, one.wrench.about(one.point))
    return replace(one, wrench=wrench, point=other.point, surface=other.surface)


def _with_foot(found: Sequence[Platform], steps: Sequence) -> list[bool]:
    named = {platform.name for platform in found if platform.side}
    return [bool(step.side) and (step.platform not in named or step.clean) for step in steps]
