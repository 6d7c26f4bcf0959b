"""Everything from a trial and its poses to joint moments, powers and what they are worth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.foot_loads import FootLoad, foot_loads, swings
from gaitdisc.kinetics.force_balance import ForceBalance, force_balance
from gaitdisc.kinetics.joint_moments import KineticsSettings, Leg, joint_moments, legs
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.kinetics.plate_steps import FootPath, PlateStep, Weight, empty_findings, plate_steps, weighed_steps
from gaitdisc.kinetics.platform import platforms
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.derivatives import differentiated
from gaitdisc.signals.direction import marker_position


@dataclass(frozen=True, eq=False)
class TrialKinetics:
    """Joint moments and powers of a trial."""

    moments: Recording  # moments [N m/kg] and powers [W/kg] on the frames of the markers
    steps: tuple[PlateStep, ...]  # on all platforms, with the reasons of those that are left out
    balance: ForceBalance
    loads: Mapping[str, FootLoad]
    found: Mapping[str, Leg]
    findings: tuple[Finding, ...]


def trial_kinetics(
    trial: Trial,
    poses: Mapping[str, Pose],
    feet: Mapping[str, FootPath],
    person: Person,
    settings: KineticsSettings | None = None,
    trunk: Sequence[str] = (),
) -> TrialKinetics:
    """Joint moments and powers of a trial, with the steps they rest on and the balance of forces.

    trial: with markers and forces on one clock, in one frame
    poses: on the frames of the markers; unfiltered, as they are filtered here. Origins of `thigh_r`, `shank_r`,
        `foot_r` are the centres of hip, knee and ankle
    feet: `r`, `l`: heel and toes, as `foot_paths` takes them from markers
    trunk: markers whose mean moves as head, arms and trunk do (C7, CLAV), for the balance of forces only
    """
    settings = settings or KineticsSettings()
    markers = trial.stream("markers")
    time, file = markers.time, markers.source.file or trial.name
    found = platforms(trial)
    steps, airborne, up = plate_steps(found, feet, settings.least_load_n), swings(trial, feet), found[0].up
    if "pelvis" in poses:
        weight = Weight(person.weighed_n or person.kg * GRAVITY, time, poses["pelvis"].origin @ up)
        steps = weighed_steps(steps, found, airborne, weight)
    left_out = [finding for step in steps if (finding := step.finding(file))]
    if not any(step.clean for step in steps):
        reasons = "; ".join(f"{one.platform} at {one.start:.2f} s: {one.reason}" for one in steps[:3])
        raise ChannelError(
            "joint moments need a step of one foot alone on a force platform",
            f"{file} has {reasons or 'no loaded platform'}",
            "Leave the trial out of kinetics, or give one whose plates were hit by one foot each.",
        )
    loads = foot_loads(found, steps, time, settings.force_cutoff_hz, airborne)
    both = legs(poses, feet, person, settings)
    moments = joint_moments(both, loads, time, up, person, settings)
    balance = ForceBalance(0, *[float("nan")] * 3)
    if len(both) == 2:
        alike = foot_loads(found, steps, time, settings.marker_cutoff_hz, airborne)
        balance = force_balance(both, alike, up, person, _acceleration(markers, trunk, settings.marker_cutoff_hz))
    findings = (*empty_findings(found, file, settings.least_load_n), *left_out, balance.finding(file))
    moments = replace(moments, subject=trial.subject, condition=trial.condition, source=markers.source)
    return TrialKinetics(moments, tuple(steps), balance, loads, both, findings)


def _acceleration(markers: Recording, names: Sequence[str], cutoff_hz: float) -> NDArray[np.float64] | None:
    """Acceleration of the mean of some markers, (frame, 3) [m/s2]; None where none is named."""
    if not names:
        return None
    mean = np.mean([marker_position(markers, name) for name in names], axis=0)
    channels = tuple(Channel(f"trunk.{axis}", "marker", "m") for axis in "xyz")
    trunk = Recording(markers.time, mean, channels, source=markers.source)
    smooth = lowpassed(trunk, cutoff_hz) if np.isfinite(cutoff_hz) else trunk
    return differentiated(smooth.values, trunk.rate_hz, 2)
