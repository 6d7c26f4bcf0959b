"""A trajectory: state, its first and second derivative, and percent stride (Eqs. 4.1-4.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, ShapeError
from gaitdisc.recording.arrays import read_only


@dataclass(frozen=True, eq=False)
class Trajectory:
    """State and derivatives on one even time base.

    >>> t, x = np.arange(4) / 100, np.zeros((4, 1))
    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> Trajectory(t, x, x, x, np.zeros(4), (knee,), np.ones((4, 1), bool)).names
    ('knee_angle_r',)
    """

    time: NDArray[np.float64]  # (time,) [s], even
    x: NDArray[np.float64]  # (time, channel) [unit, unit/s, unit/s2], state and its time derivatives
    xdot: NDArray[np.float64]  # (time, channel) [unit, unit/s, unit/s2], state and its time derivatives
    xddot: NDArray[np.float64]  # (time, channel) [unit, unit/s, unit/s2], state and its time derivatives
    phi: NDArray[np.float64]  # (time,) [% stride], 0 <= phi < 100, NaN outside of strides
    channels: tuple[Channel, ...]
    usable: NDArray[np.bool_]  # (time, channel), false where x, xdot or xddot is missing or not to be trusted
    subject: str = ""
    condition: str = ""

    def __post_init__(self) -> None:
        """Check shapes once."""
        shape = (len(self.time), len(self.channels))
        for name in ("x", "xdot", "xddot", "usable"):
            found = np.shape(getattr(self, name))
            if found != shape:
                raise ShapeError(
                    f"a trajectory needs {name} of shape (time, channel) = {shape}",
                    f"found {found}",
                    "Put time first, one column a channel.",
                )
        if np.shape(self.phi) != shape[:1]:
            raise ShapeError(
                f"a trajectory needs phi of shape (time,) = {shape[:1]}",
                f"found {np.shape(self.phi)}",
                "Give one percent stride a sample.",
            )
        for name in ("time", "x", "xdot", "xddot", "phi"):
            object.__setattr__(self, name, read_only(getattr(self, name)))
        object.__setattr__(self, "usable", read_only(self.usable, bool))
        object.__setattr__(self, "channels", tuple(self.channels))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels, in order."""
        return tuple(channel.name for channel in self.channels)

    @property
    def rate_hz(self) -> float:
        """Samples a second."""
        return float(round((len(self.time) - 1) / (self.time[-1] - self.time[0]), 6))

    def columns(self, names: Sequence[str]) -> list[int]:
        """Return the columns of channels."""
        return [self.names.index(name) for name in names]

    def rows(self, chosen: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Trajectory:
        """Trajectory of some samples; usually a contiguous part.

        chosen slice or ndarray: samples to keep
        """
        parts = {name: getattr(self, name)[chosen] for name in ("time", "x", "xdot", "xddot")}
        return replace(self, phi=self.phi[chosen], usable=self.usable[chosen], **parts)

    def split(self, held_out_s: float, seam_s: float = 0.3) -> tuple[Trajectory, Trajectory]:
        """Split into a training part and the last part, held out.

        Zero-lag filters look ahead: what they carry over the seam is kept out of the training part, whose last
        `seam_s` are left away. The held-out part keeps its full length.

        held_out_s: length of the held-out part [s]; the dissertation holds out the last 30 s of 240 s (section 4.2.2)
        seam_s: length left away before the seam [s]
        """
        held = round(held_out_s * self.rate_hz)
        last = len(self.time) - held - round(seam_s * self.rate_hz)
        if held < 1 or last < 1:
            raise SamplingError(
                f"holding out the last {held_out_s:g} s (and {seam_s:g} s before it) needs a longer trial",
                f"{self.subject} {self.condition} lasts {len(self.time) / self.rate_hz:.2f} s",
                "Shorten [held_out] in the study, or leave it out to hold back 12.5 %.",
            )
        return self.rows(slice(0, last)), self.rows(slice(len(self.time) - held, None))
