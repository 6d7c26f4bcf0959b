"""Everything from a trial and its poses to joint moments, powers and what they are worth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.errors import ChannelError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import FootLoad, KineticsSettings, Leg, foot_loads, joint_moments, legs, swings
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.kinetics.plate_steps import FootPath, PlateStep, Weight, empty_findings, plate_steps, weigh_steps
from gaitdisc.kinetics.platform import low_passed, platforms
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.signals.derivatives import derivative
from gaitdisc.signals.direction import marker_position

# of body weight; walks at hand reach 11 % and, where only one foot's stance is seen, 9 %: studies/results
LARGEST_RMS, LARGEST_MEAN = 15.0, 12.0
FEWEST_FRAMES = 10


@dataclass(frozen=True)
class ForceBalance:
    """Force that the motion needs against the force that was measured.

    >>> print(ForceBalance(120, 3.21, 2.5, 0.4).line())
    force balance over 120 frames: vertical rms 3.2 % of body weight (mean +0.4 %), horizontal rms 2.5 %
    """

    frames: int  # in which the load of both feet is known
    rms: float  # [% of body weight], of the vertical difference
    level_rms: float  # [% of body weight], of the horizontal difference, both directions together
    # [% of body weight], of the vertical difference, measured less needed: positive where the mass is given too small
    mean: float

    @property
    def tested(self) -> bool:
        """Whether there are enough frames for a balance."""
        return self.frames >= FEWEST_FRAMES

    def line(self) -> str:
        """Return the balance as one line of text."""
        if not self.tested:
            return (
                "force balance: not tested, because the loads of both feet are known together in too few frames "
                f"({self.frames})"
            )
        return (
            f"force balance over {self.frames} frames: vertical rms {self.rms:.1f} % of body weight "
            f"(mean {self.mean:+.1f} %), horizontal rms {self.level_rms:.1f} %"
        )

    def finding(self, file: str) -> Finding:
        """Give the balance as a finding: a note, or a warning above rms 15 % or mean 12 % of body weight."""
        wrong = self.tested and (self.rms > LARGEST_RMS or abs(self.mean) > LARGEST_MEAN)
        spoils = "joint moments; check the body mass, the clocks, and which foot is on which plate" if wrong else ""
        return Finding("warning" if wrong else "note", "force balance", file, self.line(), spoils)


def force_balance(
    by_side: Mapping[str, Leg], loads: Mapping[str, FootLoad], up: Values, person: Person, trunk: Values | None = None
) -> ForceBalance:
    """Whether the ground pushes as hard as the motion needs, over the frames in which the load of both feet is known.

    The sum of m (a - g) over all segments is what the ground must give. Legs have their own poses; head, arms and trunk
    are one mass that moves with the mean of markers on the trunk, or with the middle of the hips where only legs have
    markers. That shows a wrong mass, sign, unit, clock or assignment of feet, and no error of a few per cent of body
    weight. Forces are filtered as the markers are: else an impact would count as an error of the body.

    up (3,): unit vector against gravity
    trunk (frame, 3) [m/s2]: acceleration of head, arms and trunk; that of the middle of the hips by default
    """
    if set(by_side) != {"l", "r"}:
        raise ChannelError(
            "for the balance of forces, both legs and the pelvis must be given",
            f"found {'only leg ' + ', '.join(by_side) if by_side else 'no leg'}",
            "Provide the markers of both legs.",
        )
    needed = np.zeros(loads["r"].wrench.force.shape)
    rest = person.kg
    for leg in by_side.values():
        for segment, wrench in leg.needed(up).items():
            needed = needed + wrench.force
            rest -= leg.bodies[segment].mass_kg
    hips = np.mean([leg.moving["thigh"].acceleration for leg in by_side.values()], axis=0)
    needed = needed + rest * ((hips if trunk is None else trunk) + GRAVITY * up)
    measured = loads["r"].wrench.force + loads["l"].wrench.force
    known = loads["r"].known & loads["l"].known & np.isfinite(needed).all(axis=1)
    over = (measured - needed)[known] / (person.kg * GRAVITY) * 100
    if not len(over):
        return ForceBalance(0, np.nan, np.nan, np.nan)
    vertical = over @ up
    level = over - vertical[:, None] * up
    up_rms, level_rms = (float(np.sqrt(np.mean(squares))) for squares in (vertical**2, np.sum(level**2, axis=1)))
    return ForceBalance(len(over), up_rms, level_rms, float(vertical.mean()))


@dataclass(frozen=True, eq=False)
class TrialKinetics:
    """Joint moments and powers of a trial."""

    moments: Recording  # moments [N m/kg] and powers [W/kg] on the frames of the markers
    steps: tuple[PlateStep, ...]  # on all platforms, with the reasons of those that are left out
    balance: ForceBalance
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

    poses: on the frames of the markers; unfiltered, as they are filtered here. Origins of `thigh_r`, `shank_r`,
        `foot_r` are the centres of hip, knee and ankle
    trunk: markers whose mean moves as head, arms and trunk do (C7, CLAV), for the balance of forces only
    """
    settings = settings or KineticsSettings()
    markers = trial.stream("markers")
    time, file = markers.time, markers.source.file or trial.name
    plates = platforms(trial)
    steps, airborne, up = plate_steps(plates, feet), swings(trial, feet), plates[0].up
    if "pelvis" in poses:
        weight = Weight(person.weighed_n or person.kg * GRAVITY, time, poses["pelvis"].origin @ up)
        steps = weigh_steps(steps, plates, airborne, weight)
    left_out = [finding for step in steps if (finding := step.finding(file))]
    if not any(step.clean for step in steps):
        reasons = "; ".join(f"{step.platform} at {step.start:.2f} s: {step.reason}" for step in steps[:3])
        raise ChannelError(
            "for joint moments, one foot must step alone on a force plate",
            f"{file}: {reasons or 'no platform is loaded'}",
            "Exclude the trial from kinetics, or use one in which each foot hit its own plate.",
        )
    loads = foot_loads(plates, steps, time, settings.force_cutoff_hz, airborne)
    both = legs(poses, feet, person, settings)
    moments = joint_moments(both, loads, time, up, person, settings)
    balance = ForceBalance(0, np.nan, np.nan, np.nan)
    if len(both) == 2:
        cutoff_hz, acceleration = settings.marker_cutoff_hz, None
        alike = foot_loads(plates, steps, time, cutoff_hz, airborne)
        if trunk:
            mean = np.mean([marker_position(markers, name) for name in trunk], axis=0)
            acceleration = derivative(low_passed(time, mean, cutoff_hz), markers.rate_hz, 2)
        balance = force_balance(both, alike, up, person, acceleration)
    findings = (*empty_findings(plates, file), *left_out, balance.finding(file))
    moments = replace(moments, subject=trial.subject, condition=trial.condition, source=markers.source)
    return TrialKinetics(moments, tuple(steps), balance, findings)
