"""Direction of walking, given or inferred from markers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Recording

FEWEST_SKEW = 0.2


@dataclass(frozen=True, eq=False)
class Direction:
    """Forwards and upwards in the laboratory's axes.

    Parameters
    ----------
    forward, up : ndarray (3,)
        Unit vectors.
    how : str
        `given`, or what they were inferred from.
    """

    forward: NDArray[np.float64]
    up: NDArray[np.float64]
    how: str


def marker_position(markers: Recording, name: str) -> NDArray[np.float64]:
    """Position of one marker, (time, 3) [m].

    Parameters
    ----------
    markers : Recording
        Channels `<marker>.x`, `<marker>.y`, `<marker>.z`.
    name : str
        Name of the marker.

    Raises
    ------
    ChannelError
        If the marker is not there; the nearest name is given.
    """
    return np.stack([markers[f"{name}.{axis}"] for axis in "xyz"], axis=1)


def pelvis_position(markers: Recording, pelvis: Sequence[str]) -> NDArray[np.float64]:
    """Mean position of the pelvis markers, (time, 3) [m]; NaN where one of them is missing.

    Parameters
    ----------
    markers : Recording
        Channels `<marker>.x`, `<marker>.y`, `<marker>.z`.
    pelvis : sequence of str
        Names of the pelvis markers; the two or four at the iliac spines, or one at the sacrum.

    Raises
    ------
    ChannelError
        If none is named.
    """
    if not pelvis:
        raise ChannelError(
            "a pelvis marker is needed", "none is named", "Name the markers of the pelvis, such as RASI, LASI."
        )
    return np.mean([marker_position(markers, name) for name in pelvis], axis=0)


def walking_direction(markers: Recording, heels: Mapping[str, str], pelvis: Sequence[str]) -> Direction:
    """Direction of walking, from how heel markers swing about the pelvis.

    The axis along which the pelvis lies farthest from the heels is up. Across it, the line along which the heels swing
    most is the walking line. On it the foot swings forwards faster than it goes backwards in stance, on a belt as over
    ground, so velocity relative to the pelvis is skewed towards forward.

    Parameters
    ----------
    markers : Recording
        Channels `<marker>.x`, `<marker>.y`, `<marker>.z`.
    heels : mapping of str to str
        Side (`r`, `l`) to the name of its heel marker.
    pelvis : sequence of str
        Names of the pelvis markers.

    Raises
    ------
    StrideError
        If forwards cannot be told from backwards (skewness of the velocity below 0.2).
    ChannelError
        If a marker is not there.
    """
    centre = pelvis_position(markers, pelvis)
    swings = [marker_position(markers, name) - centre for name in heels.values()]
    up_axis = int(np.argmax(np.abs(np.nanmean(np.concatenate(swings), axis=0))))
    up = np.zeros(3)
    up[up_axis] = 1.0
    if np.nanmean(np.concatenate(swings)[:, up_axis]) > 0:
        up = -up
    level = [i for i in range(3) if i != up_axis]
    centred = np.concatenate([s - np.nanmean(s, axis=0) for s in swings])[:, level]
    centred = centred[np.isfinite(centred).all(axis=1)]
    line = np.linalg.eigh(centred.T @ centred)[1][:, -1]
    velocity = np.concatenate([np.diff(s[:, level] @ line) for s in swings])
    velocity = velocity[np.isfinite(velocity)]
    skew = float(np.mean((velocity - velocity.mean()) ** 3) / velocity.std() ** 3)
    if abs(skew) < FEWEST_SKEW:
        raise StrideError(
            f"forwards is where the heels move fastest: a skewness of {FEWEST_SKEW:g} or more",
            f"{markers.source.file or 'the recording'} has {skew:+.2f}",
            "Give the direction of walking in the study's [strides].",
        )
    forward = np.zeros(3)
    forward[level] = line * np.sign(skew)
    shown = ", ".join(f"{part:+.2f}" for part in forward)
    return Direction(forward, up, f"forward ({shown}) inferred: heels move faster that way (skewness {abs(skew):.2f})")


def given_direction(forward: Sequence[float], up: Sequence[float] = (0.0, 0.0, 1.0)) -> Direction:
    """Direction that the laboratory states.

    Parameters
    ----------
    forward, up : sequence of 3 floats
        Any length but zero, at right angles.

    Raises
    ------
    StrideError
        If one of them is zero or they are not at right angles.

    Examples
    --------
    >>> given_direction((0, -2, 0)).forward.tolist()
    [0.0, -1.0, 0.0]
    """
    along, above = np.asarray(forward, float), np.asarray(up, float)
    lengths = np.linalg.norm(along), np.linalg.norm(above)
    if min(lengths) == 0 or abs(along @ above) > 0.1 * lengths[0] * lengths[1]:
        raise StrideError(
            "forwards and upwards need to be at right angles and not zero",
            f"found forward {tuple(forward)}, up {tuple(up)}",
            "Correct them in the study's [strides].",
        )
    return Direction(along / lengths[0] + 0.0, above / lengths[1] + 0.0, "given")
