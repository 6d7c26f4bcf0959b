"""Direction of walking, given or inferred from markers; it may turn on the way."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Recording
from gaitdisc.recording.arrays import Values, finite_rows, finite_values

FEWEST_SKEW = 0.2
PATH_S = 1.0  # about a stride: sway from step to step cancels over it
LEAST_SPEED = 0.3  # m/s of the pelvis in the laboratory: slower is a treadmill, or standing


@dataclass(frozen=True, eq=False)
class Direction:
    """Forwards and upwards in the laboratory's axes."""

    forward: Values  # (3,), unit vector, the mean one where walking turns
    up: Values  # (3,), unit vector
    how: str  # `given`, or what they were inferred from
    # (time, 3), forward at each sample of the markers, where it follows the path of the pelvis
    headings: Values | None = None

    def ahead(self, positions: Values, sample: int | None = None) -> Values:
        """How far forward positions lie, (time,) [m].

        positions (time, 3) [m]: on the time base of the markers; relative to the pelvis where walking turns
        sample: keep the direction of this sample throughout, as one step needs it; by default each sample has its own
        """
        if self.headings is None:
            return positions @ self.forward
        if sample is not None:
            return positions @ self.headings[sample]
        return np.einsum("tx,tx->t", positions, self.headings)


def marker_position(markers: Recording, name: str) -> Values:
    """Position of one marker, channels `<name>.x`, `.y` and `.z`, (time, 3) [m]."""
    return np.stack([markers[f"{name}.{axis}"] for axis in "xyz"], axis=1)


def pelvis_position(markers: Recording, pelvis: Sequence[str]) -> Values:
    """Mean position of the markers at the iliac spines or the sacrum, (time, 3) [m]; NaN where one is missing."""
    if not pelvis:
        raise ChannelError(
            "at least one pelvis marker is required", "none is named", "Name the pelvis markers, such as RASI and LASI."
        )
    return np.mean([marker_position(markers, name) for name in pelvis], axis=0)


def nearest_axis(vector: Values) -> Values:
    """Axis of the laboratory (3,), of length 1, that lies nearest to a vector (3,)."""
    axis = np.zeros(3)
    longest = int(np.argmax(np.abs(vector)))
    axis[longest] = np.copysign(1.0, vector[longest])
    return axis


def walking_direction(markers: Recording, heels: Mapping[str, str], pelvis: Sequence[str]) -> Direction:
    """Direction of walking: the path of the pelvis over ground, the swing of the heels about it on a treadmill.

    The axis along which the pelvis lies farthest from the heels is up. Where the pelvis travels at 0.3 m/s or more,
    forward at each sample is where it moves over a second around it, so that a turn has the direction of each step.
    On a treadmill, the line along which the heels swing most is the walking line; on it the foot swings forwards faster
    than it goes backwards in stance, so velocity relative to the pelvis is skewed towards forward.
    """
    centre = pelvis_position(markers, pelvis)
    swings = [marker_position(markers, name) - centre for name in heels.values()]
    if not np.isfinite(np.concatenate(swings)).all(axis=1).any():
        raise StrideError(
            "for the direction of walking, a frame must have a heel and the pelvis",
            f"{markers.source.file or 'the recording'}: no frame has {', '.join(heels.values())} and "
            f"{', '.join(pelvis)}",
            "Fill the gaps in the markers, or choose another detector in [strides].",
        )
    up = nearest_axis(-np.nanmean(np.concatenate(swings), axis=0))
    level = np.flatnonzero(up == 0).tolist()
    headings = _headings(centre, level, markers.rate_hz)
    if headings is not None:
        angle = np.unwrap(np.arctan2(headings[:, level[1]], headings[:, level[0]]))
        turned = np.degrees(angle.max() - angle.min())
        mean = headings.mean(axis=0)
        size = float(np.linalg.norm(mean))
        forward = mean / size if size > 1e-9 else headings[0]  # there and back has no mean
        how = f"forward ({_show(forward)}) follows the path of the pelvis, which turns by {turned:.0f} deg"
        return Direction(forward, up, how, headings)
    return _from_swings(swings, up, level, markers.source.file)


def _headings(centre: Values, level: list[int], rate_hz: float) -> Values | None:
    """Forward at each sample, (time, 3), from the path of the pelvis; None where it does not travel."""
    known = np.flatnonzero(np.isfinite(centre).all(axis=1))
    if len(known) < PATH_S * rate_hz:
        return None
    samples = np.arange(len(centre))
    path = np.stack([np.interp(samples, known, centre[known, axis]) for axis in level], axis=1)
    half = round(PATH_S * rate_hz / 2)
    late, early = np.minimum(samples + half, known[-1]), np.maximum(samples - half, known[0])
    velocity = (path[late] - path[early]) / np.maximum(late - early, 1)[:, None] * rate_hz
    speed = np.linalg.norm(velocity, axis=1)
    moving = np.flatnonzero((speed >= LEAST_SPEED) & (late - early >= half))
    if len(moving) < (known[-1] + 1 - known[0]) / 2:  # of the frames from where the cameras see somebody
        return None
    nearest = moving[np.rint(np.interp(samples, moving, np.arange(len(moving)))).astype(int)]  # held in standing
    headings = np.zeros(centre.shape)
    headings[:, level] = velocity[nearest] / speed[nearest, None]
    return headings


def _from_swings(swings: Sequence[Values], up: Values, level: list[int], file: str) -> Direction:
    centred = finite_rows(np.concatenate([s - np.nanmean(s, axis=0) for s in swings])[:, level])
    line = np.linalg.eigh(centred.T @ centred)[1][:, -1]
    velocity = finite_values(np.concatenate([np.diff(s[:, level] @ line) for s in swings]))
    skew = float(np.mean((velocity - velocity.mean()) ** 3) / velocity.std() ** 3)
    if abs(skew) < FEWEST_SKEW:
        raise StrideError(
            f"the heels must move fastest in the direction of walking, with a skewness of at least {FEWEST_SKEW:g}",
            f"in {file or 'the recording'} the skewness is {skew:+.2f}",
            "Write the direction of walking in the study's [treadmill].",
        )
    forward = np.zeros(3)
    forward[level] = line * np.sign(skew)
    how = f"forward ({_show(forward)}) is inferred: heels move faster in this direction (skewness {abs(skew):.2f})"
    return Direction(forward, up, how)


def _show(forward: Values) -> str:
    return ", ".join(f"{part:+.2f}" for part in forward)


def state_direction(forward: Sequence[float], up: Sequence[float] = (0.0, 0.0, 1.0)) -> Direction:
    """Direction that the laboratory states.

    >>> state_direction((0, -2, 0)).forward.tolist()
    [0.0, -1.0, 0.0]
    """
    along, above = np.asarray(forward, float), np.asarray(up, float)
    lengths = np.linalg.norm(along), np.linalg.norm(above)
    if min(lengths) == 0 or abs(along @ above) > 0.1 * lengths[0] * lengths[1]:
        raise StrideError(
            "the forward and upward directions must be perpendicular and not zero",
            f"forward is {tuple(forward)}, up is {tuple(up)}",
            "Correct the two directions.",
        )
    return Direction(along / lengths[0] + 0.0, above / lengths[1] + 0.0, "given")
