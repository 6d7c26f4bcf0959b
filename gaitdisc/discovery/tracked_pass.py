"""Generalised forces along a recorded walk: what the motion demands, what files give of it, what noise makes of it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfiltfilt

from gaitdisc.discovery.effect_words import amount
from gaitdisc.discovery.record_filter import DENSE
from gaitdisc.engines.motion import TrackedMotion
from gaitdisc.engines.opensim_tracked import OpensimTracked
from gaitdisc.engines.tracked_files import check_loads, read_tracked_motion
from gaitdisc.engines.tracked_mapping import Tracked
from gaitdisc.errors import SchemaError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.signals.derivatives import derivative

DRAWS, SEED, NOISE_DEG = 4, 0, 0.3
MM = 1 / 300  # [m] of a translation, that go with a degree of an angle
OTHER_MOTION = 0.15  # of the weight
WRONG_MASS = 0.05  # of the weight, which the ground carries less or more than the model moves
LEAST_ARM_M = 1e-3
NOTHING_NM = 1e-6  # a kilogram that demands less at a joint does not act there: rounding
SIDES = ((1.0, "raising"), (-1.0, "lowering"))


@dataclass(frozen=True, eq=False)
class Pass:
    """Generalised forces along a prescribed motion."""

    engine: OpensimTracked
    motion: TrackedMotion
    cutoff_hz: float
    demanded: Values  # (sample, coordinate)
    pulls: Values  # (sample, actuator, coordinate), of each actuator of the forces' file
    groups: Mapping[str, Values]  # moment (sample,) of muscles that raise or lower a coordinate

    @property
    def left(self) -> Values:
        """What neither the model nor its actuators give (sample, coordinate)."""
        return self.demanded - self.pulls.sum(axis=1)

    @property
    def joints(self) -> tuple[int, ...]:
        """Coordinates on which some actuator of the file acts, those with the ground apart."""
        return tuple(k for k, most in enumerate(self.strongest) if most > 0 and k not in self.engine.base)

    @property
    def strongest(self) -> Values:
        """Largest pull of an actuator on each coordinate (coordinate,)."""
        return np.abs(self.pulls).max(axis=(0, 1), initial=0.0)

    @cached_property
    def weight_n(self) -> float:
        """What moving the body up and down takes in the mean; 0 where no coordinate does [N]."""
        up = self.engine.vertical
        if up < 0:
            return 0.0
        alone = self.engine.demanded(self.motion, loaded=False)
        return abs(float(np.mean(self.dense(alone[:, up]))))

    @cached_property
    def demanded_by_mass(self) -> Mapping[str, Values]:
        """What a kilogram more of each body of the model demands, its shape unchanged (sample, coordinate)."""
        engine, motion = self.engine, self.motion
        alone = engine.demanded(motion, loaded=False)
        heavier = {parameter.name: {parameter.name: parameter.value + 1.0} for parameter in engine.parameters}
        return {name: engine.demanded(motion, False, values) - alone for name, values in heavier.items()}

    def masses_by_joints(self) -> set[str]:
        """Names of masses that act at two joints or more; of bodies that move as one, the heaviest one's."""
        heaviest = dict[tuple[int, ...], str]()
        for parameter in sorted(self.engine.parameters, key=lambda parameter: parameter.value):
            sizes = np.abs(self.demanded_by_mass[parameter.name]).max(axis=0)
            heaviest[tuple(k for k in self.joints if sizes[k] > NOTHING_NM)] = parameter.name
        return {name for joints, name in heaviest.items() if len(joints) > 1}

    @property
    def kept(self) -> slice:
        """Samples that hold all that the low-pass leaves."""
        return slice(None, None, max(int(self.motion.rate_hz / (DENSE * self.cutoff_hz)), 1))

    @property
    def times(self) -> Values:
        """Of these samples [s]."""
        return self.motion.time[self.kept]

    def groups_at(self, number: int) -> list[str]:
        """Names of the groups of muscles that move a coordinate."""
        name = self.engine.coordinates[number].name
        return [f"{name}_{word}_muscles" for _, word in SIDES if f"{name}_{word}_muscles" in self.groups]

    def dense(self, values: Values) -> Values:
        """Values (sample, ...) after the record's low-pass, at these samples."""
        return sosfiltfilt(self.sections, values, axis=0)[self.kept]

    def size(self, values: Values) -> float:
        """Root mean square of values (sample,) after the record's low-pass."""
        return float(np.sqrt(np.mean(self.dense(values) ** 2)))

    @cached_property
    def sections(self) -> Values:
        """Low-pass of the record, in second-order sections."""
        return np.asarray(butter(4, self.cutoff_hz, fs=self.motion.rate_hz, output="sos"))


def compute_pass(tracked: Tracked, kinematics: Path, progress: Callable[[str], None] = lambda _: None) -> Pass:
    """Compute the generalised forces that a recorded motion demands, and those that the files' actuators give."""
    check_loads(tracked)
    engine = OpensimTracked(tracked)
    motion = read_tracked_motion(tracked, kinematics, engine.coordinates, engine.actuators)
    progress("computing the moments that the motion requires, with OpenSim")
    demanded = engine.demanded(motion)
    arms = engine.arms(motion.time, motion.q, motion.actuators)
    pulls = arms * motion.forces[:, :, None]
    muscles = np.array([name in engine.paths for name in motion.actuators])
    groups = {}
    for k, coordinate in enumerate(engine.coordinates):
        if k in engine.base or not muscles.any():
            continue
        mean = arms[:, :, k].mean(axis=0) * muscles
        for sign, word in SIDES:
            acting = sign * mean > LEAST_ARM_M
            if acting.any():
                groups[f"{coordinate.name}_{word}_muscles"] = pulls[:, acting, k].sum(axis=1)
    return Pass(engine, motion, tracked.lowpass_hz, demanded, pulls, groups)


def moments_of_angle_noise(walk: Pass, noise_deg: float | None) -> Values:
    """Return what noise of the angles, after the record's low-pass, makes of the moments (draw, sample, coordinate)."""
    size_deg = noise_deg if noise_deg is not None else (NOISE_DEG if walk.motion.differentiated else 0.0)
    if not size_deg:
        return np.zeros((1, len(walk.times), len(walk.engine.coordinates)))
    rng = np.random.default_rng(SEED)
    moved = [with_angle_noise(walk, size_deg, rng) for _ in range(DRAWS)]
    return np.array([walk.dense(noisy.demanded - walk.demanded) for noisy in moved])


def with_angle_noise(walk: Pass, noise_deg: float, rng: np.random.Generator) -> Pass:
    """Return a walk whose angles have noise of a size [deg] that went through the record's low-pass."""
    motion, spare = walk.motion, int(walk.motion.rate_hz)
    sizes = [np.radians(noise_deg) if dof.unit == "rad" else noise_deg * MM for dof in walk.engine.coordinates]
    white = rng.normal(size=(len(motion.time) + 2 * spare, len(sizes)))
    noise = sosfiltfilt(walk.sections, white, axis=0)
    noise *= sizes / noise.std(axis=0)
    inside = slice(spare, spare + len(motion.time))
    first, second = (derivative(noise, motion.rate_hz, order)[inside] for order in (1, 2))
    moved = replace(motion, q=motion.q + noise[inside], v=motion.v + first, a=motion.a + second)
    return replace(walk, motion=moved, demanded=walk.engine.demanded(moved))


def balance(walk: Pass) -> list[Finding]:
    """Say what is left at the joint with the ground; refuse a model whose mass is not the walker's."""
    engine, up = walk.engine, walk.engine.vertical
    findings = []
    for k in engine.base:
        joint, size = engine.coordinates[k], walk.size(walk.demanded[:, k])
        what = f"{joint.called}: {size:.3g} {joint.force_unit} (rms) that neither the ground nor the body explains"
        findings.append(Finding("note", "residual", "model", what, "", joint.called))
    if up < 0:
        return findings
    mean = float(np.mean(walk.dense(walk.demanded[:, up])))
    share = mean / walk.weight_n
    if abs(share) > WRONG_MASS:
        mass = engine.mass_kg
        raise SchemaError(
            f"the ground forces must carry the model's weight within {100 * WRONG_MASS:.0f} %",
            f"{engine.path.name} moves {mass:.1f} kg, but the forces carry {mass * (1 - share):.1f} kg: "
            f"{engine.coordinates[up].called} lacks {mean:.0f} N on average",
            "Scale the model to the walker's mass, or correct the scale of the force plates. Otherwise this error "
            "would be named as a missing effect.",
        )
    return findings


def refuse_other_motion(walk: Pass) -> None:
    """Refuse forces whose residuals do not balance this motion: they were computed for another one, or failed."""
    weight = walk.weight_n
    for k in walk.engine.base:
        joint, size = walk.engine.coordinates[k], walk.size(walk.left[:, k])
        if joint.unit == "m" and walk.strongest[k] > 0 and weight and size > OTHER_MOTION * weight:
            raise SchemaError(
                f"residual forces must be at most {100 * OTHER_MOTION:.0f} % of the weight",
                f"the residual of {joint.called} is {size:.0f} N (root mean square), and the weight is {weight:.0f} N",
                "Compute the forces for this motion again: they belong to another motion, or their computation failed.",
            )


def only_residuals(walk: Pass) -> str:
    """Return what can be said where no file gives the forces of muscles."""
    base = [(k, walk.engine.coordinates[k]) for k in sorted(walk.engine.base)]
    sizes = [f"{amount(walk.size(walk.demanded[:, k]))} {joint.force_unit} at {joint.called}" for k, joint in base]
    return (
        "No effect can be named at a joint: no file gives the muscle forces, so any moment between two segments is "
        f"attributed to muscles. The ground and the body leave residuals of {', '.join(sizes)} (rms)."
    )
