"""Which foot is on which platform, from its markers and the force; steps that cannot be used say why."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import other_side
from gaitdisc.errors import ShapeError
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.kinetics.platform import Platform, Wrench
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Span, Values, finite_values, freeze, mean_rate, runs
from gaitdisc.signals.derivatives import derivative
from gaitdisc.signals.direction import marker_position

BESIDE_FOOT_M = 0.10  # a centre of pressure farther from the line from heel to toes than this is another foot's
BEYOND_EDGE_M = 0.01  # a marker lies a little beside the sole
SOLE_AROUND_M = 0.02  # the sole reaches at least this far around its centre of pressure
STILL_M_PER_S = 0.35  # a part of the foot that bears load hardly moves; one that swings is five times as fast
SWINGS_M_PER_S = 3 * STILL_M_PER_S  # heel and toes of a foot that bears no load, forwards
STANDS_S = 0.05  # shorter is a foot that passes
ALONE_S = 0.12  # shorter is too little of a swing to weigh a person in
MOST_APART = 0.15  # of the weight: 20 single stances of six people are 0.97 to 1.07 of it, sd 0.025
CLEAR_LOAD = 0.2  # of the greatest load: where the centre of pressure is the foot's


@dataclass(frozen=True, eq=False)
class FootPath:
    """Heel and toes of one foot in the laboratory's frame."""

    side: str
    time: Values  # (frame,) [s], of the markers
    heel: Values  # (frame, 3) [m], of the markers; NaN where one is missing
    toe: Values  # (frame, 3) [m], of the markers; NaN where one is missing

    def __post_init__(self) -> None:
        freeze(self, "heel", "toe", "time")
        heel, toe, time = self.heel, self.toe, self.time
        if heel.shape != (len(time), 3) or toe.shape != heel.shape:
            raise ShapeError(
                "heel and toe of a foot must have shape (frame, 3)",
                f"their shapes are {heel.shape} and {toe.shape}, with {len(time)} times",
                "Use the markers of one recording.",
            )

    def swings(self) -> list[Span]:
        """Spans [s] in which heel and toes go forwards, where the foot is fastest, too fast to bear load."""
        rate_hz = mean_rate(self.time)
        heel, toe = (derivative(part, rate_hz) for part in (self.heel, self.toe))
        speed = np.nan_to_num(np.linalg.norm(heel + toe, axis=1))
        fastest = int(np.argmax(speed))
        if not speed[fastest] > 0:
            return []
        forward = (heel + toe)[fastest] / speed[fastest]
        with np.errstate(invalid="ignore"):
            both = (heel @ forward > SWINGS_M_PER_S) & (toe @ forward > SWINGS_M_PER_S)
        return [Span(float(self.time[start]), float(self.time[end - 1])) for start, end in runs(both)]

    def still(self, part: Values) -> NDArray[np.bool_]:
        """Frames (frame,) in which a part (frame, 3) [m], `heel` or `toe`, hardly moves."""
        rate_hz = mean_rate(self.time)
        with np.errstate(invalid="ignore"):
            return np.linalg.norm(derivative(part, rate_hz), axis=1) < STILL_M_PER_S

    def beside(self, points: Values, up: Values) -> Values:
        """How far points (frame, 3) [m] lie from the line heel to toe, seen from above, (frame,) [m]; up (3,)."""
        level = np.eye(3) - np.outer(up, up)
        line, off = (self.toe - self.heel) @ level, (points - self.heel) @ level
        share = np.einsum("fx,fx->f", line, off) / np.einsum("fx,fx->f", line, line)
        return np.linalg.norm(off - np.clip(share, 0.0, 1.3)[:, None] * line, axis=1)  # toes reach beyond the marker


def foot_paths(markers: Recording, heels: Mapping[str, str], toes: Mapping[str, str]) -> dict[str, FootPath]:
    """Paths of the feet, `r` and `l`, by the names of heel and toe markers `<marker>.x`, `.y`, `.z` [m]."""
    return {
        side: FootPath(side, markers.time, marker_position(markers, heel), marker_position(markers, toes[side]))
        for side, heel in heels.items()
    }


@dataclass(frozen=True)
class PlateStep:
    """One loading of a platform.

    >>> PlateStep("plate_1", "r", 0.4, 1.1).clean
    True
    """

    platform: str
    side: str  # `r` or `l`; empty where the foot is unknown
    start: float  # of the loading [s]
    end: float  # of the loading [s]
    reason: str = ""  # why it cannot be used; empty where one foot alone stepped on it with all of its sole
    # false where the recording begins or ends in it: its forces are right, and it is no whole stance
    whole: bool = True
    # `warning` where the force contradicts markers or weight, `note` where a sole or a foot explains it: none is shown
    doubt: str = ""

    @property
    def span(self) -> Span:
        """Span of the loading."""
        return Span(self.start, self.end)

    @property
    def clean(self) -> bool:
        """Whether the force is that of one known foot, with all of its sole."""
        return not self.reason

    def finding(self, file: str) -> Finding | None:
        """Why the step is left out, for a person to read; None where it is used."""
        if self.clean:
            return None
        what = f"the step on {self.platform} from {self.start:.2f} to {self.end:.2f} s is excluded: {self.reason}"
        return Finding(self.doubt or "note", "plate step", file, what, "joint moments of this step", spans=(self.span,))


def plate_steps(platforms: Sequence[Platform], feet: Mapping[str, FootPath]) -> list[PlateStep]:
    """Loadings of all platforms with the foot that made them, in order of time.

    The foot is the one whose line from heel to toes the centre of pressure follows. A step is left out where the
    centre of pressure follows no foot's line; where the other foot stands on the same platform meanwhile; where the
    heel or the toes bear load beyond the platform's edge, or the centre of pressure comes within 2 cm of it.

    feet: `r`, `l`; a platform that names its foot is only held against them
    """
    steps = []
    for platform in platforms:
        for start, end in platform.loadings():
            cut = bool(start == 0 or end == len(platform.time))
            wrench = Wrench(platform.wrench.force[start:end], platform.wrench.moment[start:end])
            loaded = replace(platform, time=platform.time[start:end], wrench=wrench)
            side, reason, doubt = _foot(loaded, feet)
            steps.append(PlateStep(platform.name, side, *loaded.span, reason, not cut, doubt))
    return sorted(steps, key=lambda step: step.start)


@dataclass(frozen=True, eq=False)
class Weight:
    """Weight of a person and how high the pelvis is, which the force on one leg must agree with."""

    newton: float  # mass x 9.81
    time: Values  # (frame,) [s], of the markers
    height: Values  # (frame,) [m], of the pelvis

    def share(self, platform: Platform, span: Span) -> float:
        """Force of a platform that bears a person alone over what weight and motion need; NaN without a pelvis.

        Mean under a window w that is 0 and level at both ends: that of w F is m times that of w g + w'' z, so that the
        height z is not differentiated.
        """
        on = span.holds(platform.time)
        time, turn = platform.time[on] - span.start, 2 * np.pi / span.seconds
        height = np.interp(platform.time[on], self.time, self.height)
        window, bend = (1 - np.cos(turn * time)) / 2, turn**2 * np.cos(turn * time) / 2
        needed = self.newton * np.mean(window + bend * (height - height.mean()) / GRAVITY)
        return float(np.mean(window * platform.load_n[on]) / needed)


def weigh_steps(
    steps: Sequence[PlateStep], platforms: Sequence[Platform], airborne: Mapping[str, Sequence[Span]], weight: Weight
) -> list[PlateStep]:
    """Steps, doubted where the other foot swings and the force is not what weight and motion of the person need."""
    named = {platform.name: platform for platform in platforms}

    def weighed(step: PlateStep) -> PlateStep:
        other = airborne.get(other_side(step.side), ()) if step.side else ()
        alone = max((span.shared(step.span) for span in other), key=lambda span: span.seconds, default=Span(0.0, 0.0))
        share = weight.share(named[step.platform], alone) if alone.seconds >= ALONE_S else 1.0
        if not abs(share - 1) > MOST_APART:
            return step
        words = f"its force is {share:.2f} times that of one leg that carries the body weight of {weight.newton:.0f} N"
        if step.reason and share < 1:  # a sole beyond the edge, another foot: explains what is missing, never too much
            return replace(step, doubt=step.doubt or "note")
        return replace(step, reason=f"{words} from {alone.start:.2f} to {alone.end:.2f} s", doubt="warning")

    return [weighed(step) for step in steps]


def empty_findings(platforms: Sequence[Platform], file: str) -> list[Finding]:
    """Say on which platforms no loading is."""
    empty = [platform for platform in platforms if not len(platform.loadings())]
    words = [f"nobody stepped on {plate.name}: its force never exceeds {plate.load_n.max():.0f} N" for plate in empty]
    return [Finding("note", "empty plate", file, what, "nothing; no step on it is counted") for what in words]


def _foot(platform: Platform, feet: Mapping[str, FootPath]) -> tuple[str, str, str]:
    """Side of the foot that loads a platform from its first to its last sample, which the platform may name.

    returns: side; why the step cannot be used; whether that is a doubt
    """
    pressure, known = platform.pressure_centre(), {}  # side -> how far the centre of pressure is from the foot [m]
    for side, foot in feet.items():
        load = np.interp(foot.time, platform.time, platform.load_n)
        place = np.stack([np.interp(foot.time, platform.time, axis) for axis in pressure.T], axis=1)
        frames = platform.span.holds(foot.time)
        frames &= load > CLEAR_LOAD * load[frames].max(initial=0.0)
        metres = foot.beside(place, platform.up)[frames]
        if np.isfinite(metres).any():
            known[side] = float(np.nanmedian(metres))
    side = min(known, key=lambda key: known[key], default="")
    if platform.side:
        away_m = known.get(platform.side, 0.0)
        whose = f"the plate is assigned to the foot of side {platform.side}, but the centre of pressure"
        if away_m > BESIDE_FOOT_M and side != platform.side:
            return platform.side, f"{whose} follows the other foot ({side}), {100 * away_m:.0f} cm away", "warning"
        reason = f"{whose} is {100 * away_m:.0f} cm from this foot" if away_m > BESIDE_FOOT_M else ""
        return platform.side, reason, "warning" if reason else ""
    standing = {side: _stands_s(foot, platform) for side, foot in feet.items()}
    if len(standing) == 2 and min(standing.values()) >= STANDS_S:
        both = ", ".join(f"{side} for {seconds:.2f} s" for side, seconds in standing.items())
        return "", f"both feet are on the plate, {both}", "note"
    if not known:
        return "", "the markers of both feet are missing during this step", ""
    if known[side] > BESIDE_FOOT_M:
        return "", f"the centre of pressure is {100 * known[side]:.0f} cm from the nearest foot ({side})", "warning"
    return side, _edge(feet[side], platform), ""


def _stands_s(foot: FootPath, platform: Platform) -> float:
    """For how long heel or toes of a foot stand on a platform [s]."""
    if platform.surface is None:
        return 0.0
    step = float(foot.time[1] - foot.time[0])
    longest = 0
    for part in (foot.heel, foot.toe):
        stands = platform.span.holds(foot.time) & foot.still(part) & (platform.surface.outside(part) < -BEYOND_EDGE_M)
        longest = max([longest, *(end - start for start, end in runs(stands))])
    return longest * step


def _edge(foot: FootPath, platform: Platform) -> str:
    """Say which part of a foot bears load beside the platform, or must, as the centre of pressure is near its edge."""
    if platform.surface is None:
        return ""
    for name, part in (("the heel is", foot.heel), ("the toes are", foot.toe)):
        frames = platform.span.holds(foot.time) & foot.still(part)
        outside = finite_values(platform.surface.outside(part)[frames])
        if len(outside) and np.median(outside) > BEYOND_EDGE_M:
            return f"{name} {100 * np.median(outside):.0f} cm beyond the plate's edge"
    pressure = platform.pressure_centre()[platform.load_n > CLEAR_LOAD * platform.load_n.max()]
    nearest = -float(np.nanmax(platform.surface.outside(pressure)))
    return f"the centre of pressure comes within {100 * nearest:.1f} cm of the edge" if nearest < SOLE_AROUND_M else ""
