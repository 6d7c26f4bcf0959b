"""What the ground gives to each foot, and with segments in space joint moments and powers, N m/kg and W/kg."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, SchemaError, ShapeError
from gaitdisc.kinematics.pose import JOINT_CHANNELS, SEGMENTS_OF, Pose, angle_signs
from gaitdisc.kinetics.body_inertia import LEG, Person, leg_inertia, segment_lengths
from gaitdisc.kinetics.newton_euler import RigidBody, SegmentMotion, compute_wrench, joint_wrenches, segment_motions
from gaitdisc.kinetics.plate_steps import FootPath, PlateStep
from gaitdisc.kinetics.platform import Platform, Wrench
from gaitdisc.recording import Recording, Trial
from gaitdisc.recording.arrays import Span, Values, runs

SWING_AT_MOST_S = 0.7  # between two steps of one foot; a stance between them would not fit
HOLE_S = 0.06  # between what the file calls foot off and the end of the force


@dataclass(frozen=True, eq=False)
class FootLoad:
    """Wrench of the ground on one foot."""

    wrench: Wrench  # at each frame; zero where the foot is in the air
    known: NDArray[np.bool_]  # (frame,), false where the foot may be on the ground and no platform says what it carries


def foot_loads(
    platforms: Sequence[Platform],
    steps: Sequence[PlateStep],
    time: Values,
    cutoff_hz: float,
    airborne: Mapping[str, Sequence[Span]] | None = None,
) -> dict[str, FootLoad]:
    """Load of both feet from the clean steps of a trial.

    Known are a foot's clean steps, the swing between two of them, the swings that its markers or the file's events
    show, and every frame where a platform names its foot.

    cutoff_hz: of the filter of force and moment; infinite for none
    airborne: as `swings` gives it
    """
    loads = {}
    for side in "rl":
        total = Wrench(np.zeros((len(time), 3)), np.zeros((len(time), 3)))
        for platform in platforms:
            spans = [step.span for step in steps if step.clean and (step.platform, step.side) == (platform.name, side)]
            if spans:
                smooth = platform.smoothed(cutoff_hz, spans)
                columns = np.hstack([smooth.force, smooth.moment]).T
                values = np.stack([np.interp(time, platform.time, column, 0.0, 0.0) for column in columns], axis=1)
                total += Wrench(values[:, :3], values[:, 3:])
        named = any(platform.side == side for platform in platforms)
        spans = [Span(time[0], time[-1])] if named else list((airborne or {}).get(side, ()))
        loads[side] = FootLoad(total, _mark_known(steps, side, time, spans))
    return loads


def swings(trial: Trial, feet: Mapping[str, FootPath]) -> dict[str, list[Span]]:
    """Spans in which each foot is in the air: it goes forwards fast, or the file's events say so."""
    airborne = {side: feet[side].swings() if side in feet else [] for side in "rl"}
    for side, spans in airborne.items():
        events = [event for event in trial.events if event.side == side]
        for event, after in itertools.pairwise(events):
            if (event.label, after.label) == ("foot off", "initial contact"):
                spans.append(Span(event.time, after.time))
    return airborne


def _mark_known(steps: Sequence[PlateStep], side: str, time: Values, known_spans: Sequence[Span]) -> NDArray[np.bool_]:
    clean = [step for step in steps if step.side == side and step.clean]
    gaps = [Span(step.end, after.start) for step, after in itertools.pairwise(clean)]
    known = np.zeros(len(time), bool)
    for span in (*known_spans, *(step.span for step in clean), *(s for s in gaps if 0 < s.seconds < SWING_AT_MOST_S)):
        known |= span.holds(time)
    step = float(time[1] - time[0]) if len(time) > 1 else 0.0
    for start, end in runs(~known):
        if start > 0 and end < len(time) and (end - start) * step <= HOLE_S:
            known[start:end] = True
    for left_out in steps:
        if not left_out.clean and left_out.side in (side, ""):
            known &= ~left_out.span.holds(time)
    return known


FRAMES = ("joint", "distal")
ALONG_BONE = [2, 0, 1]  # the segment's own axes that take the places of those of the joint


def joint_axes(nearer: Pose, farther: Pose) -> Values:
    """Unit axes of a joint in the laboratory's frame, (frame, axis, 3); NaN where the first and third lie on one line.

    As the joint angles have them: the nearer segment's z (to the right), about which flexion turns; one at right angles
    to both others, forwards; the farther segment's y (along the bone), about which rotation turns. Projections of a
    moment on them times the rates of their angles are the joint's power, as with OpenSim's generalised forces.

    Source: Grood & Suntay (1983), J. Biomech. Eng. 105, 136-144. Schache & Baker (2007), Gait Posture 25, 440-452,
        compare the frames in which joint moments are given, and recommend these axes.

    >>> straight = Pose(np.zeros((1, 3)), np.eye(3)[None])
    >>> joint_axes(straight, straight)[0].tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    """
    flexion, rotation = nearer.rotation[:, :, 2], farther.rotation[:, :, 1]
    floating = np.cross(rotation, flexion)
    size = np.linalg.norm(floating, axis=1, keepdims=True)
    floating = floating / np.where(size > 1e-6, size, np.nan)
    return np.stack([flexion, floating, rotation], axis=1)


def along(vector: Values, axes: Values, joint: str, side: str) -> Values:
    """Parts (frame, 3) of a vector (frame, 3) towards a joint's positive angles about axes of `joint_axes`."""
    components = [np.einsum("fx,fx->f", vector, axes[:, axis]) for axis in range(3)]
    return np.stack(components, axis=1) * angle_signs(joint, side)


@dataclass(frozen=True)
class KineticsSettings:
    """How moments are computed.

    Source: Kristianslund, Krosshaug & van den Bogert (2012), J. Biomech. 45, 666-671.

    >>> KineticsSettings().force_cutoff_hz
    20.0
    """

    # [Hz], of the zero-lag filters; infinite for none. Unlike cut-offs leave what the forces have and the accelerations
    # have lost as a moment that nobody made after an impact (Kristianslund 2012); alike ones take both away
    marker_cutoff_hz: float = 6.0
    force_cutoff_hz: float = 20.0
    # `joint`: parts along the axes of the joint angles; `distal`: along the axes of the segment beyond the joint, as
    # Plug-in Gait gives them
    frame: str = "joint"

    def __post_init__(self) -> None:
        for name in ("marker_cutoff_hz", "force_cutoff_hz"):
            if not getattr(self, name) > 0:
                raise SamplingError(
                    f"{name} must be positive", f"it is {getattr(self, name):g} Hz", "Use inf for no filter."
                )
        if self.frame not in FRAMES:
            known = ", ".join(FRAMES)
            raise SchemaError(f"frame must be one of {known}", f"it is {self.frame!r}", "Name one of these.")


@dataclass(frozen=True, eq=False)
class Leg:
    """One leg in motion with its inertia."""

    moving: Mapping[str, SegmentMotion]
    bodies: Mapping[str, RigidBody]

    def needed(self, up: Values) -> dict[str, Wrench]:
        """Wrench that moves each segment and bears its weight; up (3,) is a unit vector."""
        return {segment: compute_wrench(self.moving[segment], body, up) for segment, body in self.bodies.items()}


def legs(
    poses: Mapping[str, Pose], feet: Mapping[str, FootPath], person: Person, settings: KineticsSettings
) -> dict[str, Leg]:
    """Legs all of whose segments have a pose from the proximal joint centre, filtered and differentiated."""
    names = {side: {"pelvis": "pelvis", **{segment: f"{segment}_{side}" for segment in LEG}} for side in feet}
    complete = {side: segments for side, segments in names.items() if set(segments.values()) <= set(poses)}
    by_side, moving = {}, {}
    for side, segments in complete.items():
        path = feet[side]
        wanted = {name: poses[name] for name in segments.values() if name not in moving}  # the pelvis is filtered once
        moving |= segment_motions(wanted, path.time, settings.marker_cutoff_hz)
        lengths = segment_lengths(poses, side)
        places = [poses[f"foot_{side}"].to_segment(part) for part in (path.heel, path.toe)]
        seen = np.isfinite(places).all(axis=(0, 2))
        if not seen.any():
            raise ShapeError(
                f"a frame must have heel, toes and pose of foot_{side}, for its inertia",
                "no frame has all three",
                "Fill the gaps in the markers of this foot, or name other markers.",
            )
        bodies = leg_inertia(person, side, lengths, np.median(places[1][seen], axis=0))
        by_side[side] = Leg({short: moving[name] for short, name in segments.items()}, bodies)
    return by_side


def joint_moments(
    by_side: Mapping[str, Leg],
    loads: Mapping[str, FootLoad],
    time: Values,
    up: Values,
    person: Person,
    settings: KineticsSettings,
) -> Recording:
    """Moments and powers of hip, knee and ankle.

    Moments are internal, of the nearer segment on the farther one, positive towards the positive joint angle: the
    plantarflexors' moment of push-off is negative. Powers are moment times relative angular velocity, positive when
    generated. NaN where the load of the foot or a pose is unknown.

    returns: `hip_flexion_r_moment` [N m/kg], `hip_power_r` [W/kg] and so on, on the frames of the poses
    """
    columns: list[Values] = []
    channels: list[Channel] = []
    for side, leg in by_side.items():
        needed = leg.needed(up)
        carried = dict(zip(LEG, joint_wrenches([needed[segment] for segment in LEG], loads[side].wrench), strict=True))
        unknown = ~loads[side].known
        for joint, (above, segment) in SEGMENTS_OF.items():
            nearer, farther = leg.moving[above], leg.moving[segment]
            moment = carried[segment].about(farther.pose.origin) / person.kg
            moment[unknown] = np.nan
            axes = joint_axes(nearer.pose, farther.pose)
            if settings.frame == "distal":
                axes = np.swapaxes(farther.pose.rotation, 1, 2)[:, ALONG_BONE]
            columns += [*along(moment, axes, joint, side).T]
            angles, _ = JOINT_CHANNELS[joint]
            channels += [Channel(f"{angle}_{side}_moment", "moment", "N m/kg", side) for angle in angles]
            turning = farther.angular_velocity - nearer.angular_velocity
            columns.append(np.einsum("fx,fx->f", moment, turning))
            channels.append(Channel(f"{joint}_power_{side}", "power", "W/kg", side))
    return Recording(time, np.column_stack(columns) if columns else np.empty((len(time), 0)), tuple(channels))
