"""Strides of one leg, from one initial contact to the next of the same foot, and gait cycles with their events."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ShapeError, StrideError
from gaitdisc.recording.arrays import Values, freeze, mean_step, read_only
from gaitdisc.recording.recording import Recording
from gaitdisc.recording.wrapping import find_turn, in_one_turn, unwrap
from gaitdisc.words import as_html

if TYPE_CHECKING:
    import pandas as pd

PERCENT = read_only(np.arange(101.0))  # 0 to 100 % inclusive
NAN = float("nan")


@dataclass(frozen=True)
class DroppedStride:
    """A stride that is not used, and why."""

    start: float  # initial contact [s]
    end: float  # the next one of the same foot [s]
    reason: str  # in words, with the number that decided


@dataclass(frozen=True, eq=False)
class Strides:
    """Strides [start, end) in seconds, valid for every recording of the trial at its own rate.

    Parameters
    ----------
    start, end : ndarray (stride,) [s]
        Initial contact at the start and at the end of each stride, in order and without overlap.
    side : str
        `r` or `l`.
    detector : str
        Detector of the contacts: `force`, `markers`, `angles`, `events`, `oscillator`.
    dropped : tuple of DroppedStride
        Strides that are excluded, each with its reason.

    Raises
    ------
    ShapeError
        If start and end differ in length.
    StrideError
        If a stride ends before it starts or overlaps the next.

    Examples
    --------
    >>> strides = Strides(np.array([0.0, 1.0]), np.array([1.0, 2.0]), "r", "force")
    >>> strides.phi(np.array([0.25, 1.5, 2.5]))
    array([25., 50., nan])
    """

    start: Values
    end: Values
    side: str
    detector: str
    dropped: tuple[DroppedStride, ...] = field(default_factory=tuple)

    def __post_init__(self) -> None:
        freeze(self, "start", "end")
        start, end = self.start, self.end
        if start.ndim != 1 or start.shape != end.shape:
            raise ShapeError(
                "strides must have as many ends as starts",
                f"the starts have shape {start.shape}, the ends {end.shape}",
                "Give one end for each start.",
            )
        if not np.isfinite([start, end]).all() or np.any(end <= start) or np.any(start[1:] < end[:-1] - 1e-9):
            raise StrideError(
                "the initial contacts of strides must be in order",
                f"one of the {len(start)} strides of side {self.side!r} ends before it starts, overlaps the next, "
                "or has no time",
                "Check the events, or choose another detector.",
            )

    def __len__(self) -> int:
        return len(self.start)

    def __repr__(self) -> str:
        span = f", {self.start[0]:.2f} to {self.end[-1]:.2f} s" if len(self) else ""
        return f"Strides({len(self)} of side {self.side!r} by {self.detector}{span}; {len(self.dropped)} dropped)"

    def _repr_html_(self) -> str:
        rows = [("strides", str(len(self))), ("side", self.side), ("contacts by", self.detector)]
        if len(self):
            lasting = self.duration_s
            rows.append(("duration", f"{lasting.min():.2f} to {lasting.max():.2f} s, mean {lasting.mean():.2f} s"))
        rows += [(f"dropped at {stride.start:.2f} s", stride.reason) for stride in self.dropped[:4]]
        return as_html("Strides", rows)

    @property
    def duration_s(self) -> Values:
        """Duration of every stride, (stride,) [s]."""
        return self.end - self.start

    def phi(self, time: Values) -> Values:
        """Percent stride at each time, 0 <= phi < 100; NaN outside the strides.

        Parameters
        ----------
        time : ndarray (time,) [s]
            Times on the trial's clock.
        """
        which = self.number(time)  # -1 is the NaN that is put behind
        start, duration_s = (np.append(values, np.nan)[which] for values in (self.start, self.duration_s))
        return np.minimum(100.0 * (time - start) / duration_s, np.nextafter(100.0, 0.0))

    def number(self, time: Values) -> NDArray[np.intp]:
        """Number of the stride at each time, from 0, (time,); -1 outside the strides.

        Parameters
        ----------
        time : ndarray (time,) [s]
            Times on the trial's clock.
        """
        which = np.searchsorted(self.start, time, side="right") - 1
        return np.where(time < np.append(self.end, -np.inf)[which], which, -1)

    def normalised(self, recording: Recording | pd.DataFrame) -> Values:
        """Every stride of a recording on 0 to 100 % in 101 points, (stride, phase, channel) [channel's unit].

        Linear interpolation; NaN next to a missing sample or outside the recording. A heading that passes 180 deg is
        unwrapped within its stride; whole turns are then added, so that all strides lie in one range.

        Parameters
        ----------
        recording : Recording or DataFrame
            Channels with times on the trial's clock; a DataFrame has times [s] in a column or index `time`.
        """
        if not isinstance(recording, Recording):
            table: Any = recording
            if getattr(getattr(table, "index", None), "name", None) == "time":
                table = table.reset_index()
            if "time" not in getattr(table, "columns", ()):
                raise ShapeError(
                    "strides must be cut from a Recording, or from a DataFrame with times [s] in a column 'time'",
                    f"found {type(table).__name__}" + (" without this column" if hasattr(table, "columns") else ""),
                    "Give one stream of a trial, for instance trial.stream('kinematics'), or rename the column of "
                    "times to 'time'.",
                )
            names = [name for name in table.columns if name != "time"]
            channels = [vocabulary().by_name.get(str(name)) or Channel(str(name), "signal", "1") for name in names]
            recording = Recording(table["time"].to_numpy(float), table[names].to_numpy(float), tuple(channels))
        points = self.start[:, None] + self.duration_s[:, None] * PERCENT / 100.0
        plain = unwrap(recording)
        curves = interpolate(recording.time, plain.values, points)
        if plain is not recording:
            for column, channel in enumerate(recording.channels):
                turn = find_turn(channel)
                if turn is not None:
                    curves[:, :, column] = in_one_turn(curves[:, :, column], turn)
        return curves

    def between(self, start_s: float, end_s: float) -> Strides:
        """Strides that lie completely between two times.

        Parameters
        ----------
        start_s, end_s : float
            Start and end on the trial's clock [s].
        """
        inside = (self.start >= start_s) & (self.end <= end_s)
        return Strides(self.start[inside], self.end[inside], self.side, self.detector, self.dropped)


def interpolate(time: Values, values: Values, points: Values) -> Values:
    """Linear interpolation on an even time base that lets NaN through and does not extrapolate.

    values (time, channel): NaN allowed
    points , any shape [s]: where to read the values, (*points.shape, channel)

    >>> interpolate(np.arange(3.0), np.arange(3.0)[:, None] ** 2, np.array([0.5, 2.0, 3.0])).ravel()
    array([0.5, 4. , nan])
    """
    if len(time) < 2:  # no step, and nothing between
        return np.full((*points.shape, values.shape[1]), np.nan)
    place = (points - time[0]) / mean_step(time)
    left = np.clip(np.floor(place + 1e-9).astype(int), 0, len(time) - 1)
    right = np.minimum(left + 1, len(time) - 1)
    share = np.clip(place - left, 0.0, 1.0)[..., None]
    inside = (place >= -1e-6) & (place <= len(time) - 1 + 1e-6)
    low, high = (np.where(np.isfinite(values[at]), values[at], np.nan) for at in (left, right))
    mixed = np.where(share < 1e-6, low, (1 - share) * low + share * high)
    return np.where(inside[..., None], mixed, np.nan)


@dataclass(frozen=True)
class Cycle:
    """From one initial contact to the next of the same foot, on the trial's clock.

    >>> Cycle("r", 1.0, 2.0, ("markers", "markers"), foot_off=1.5).stance_percent
    50.0
    """

    side: str
    start: float  # initial contact [s]
    end: float  # the next one of the same foot [s]
    # tuple of (str, str), what places the two contacts: `events`, `force`, `markers` or `angles`
    contacts_by: tuple[str, str]
    foot_off: float = NAN  # of this foot [s]; NaN where nothing places it, as the next two
    opposite_off: float = NAN  # of the other foot [s]
    opposite_contact: float = NAN  # of the other foot [s]
    foot_off_by: str = ""  # what places foot off; empty where nothing does
    kinetic: bool = False  # whether this foot alone was on one plate, or on its own belt, for the whole stance
    reason: str = ""  # why the cycle is left out, in words, with the number that decided; empty where it is kept

    @property
    def duration_s(self) -> float:
        """Length of the cycle [s]."""
        return self.end - self.start

    @property
    def stance_percent(self) -> float:
        """Share of the cycle before foot off [%]; NaN where foot off is not known."""
        return 100.0 * (self.foot_off - self.start) / self.duration_s

    @property
    def double_support_percent(self) -> float:
        """Share of the cycle with both feet on the ground [%]; NaN where an event is not known."""
        first, second = self.opposite_off - self.start, self.foot_off - self.opposite_contact
        return 100.0 * (first + second) / self.duration_s
