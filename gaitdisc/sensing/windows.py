"""Windows: what the sensors read now and a while ago, beside the states to be reconstructed from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError, ShapeError
from gaitdisc.recording import Recording, Samples


@dataclass(frozen=True)
class Lags:
    """How far back a window reaches, and how densely.

    >>> Lags(25, 4).reach
    96
    """

    count: int = 25  # readings of each sensor in a window, the present one included
    spacing: int = 4  # samples from one reading to the next; 6 Hz kinematics at 100 Hz lose nothing at 4
    # samples from the last reading to the state that is reconstructed: 0 is the present, more of them a forecast
    ahead: int = 0

    def __post_init__(self) -> None:
        """Refuse a window without a reading."""
        if self.count < 1 or self.spacing < 1 or self.ahead < 0:
            raise ShapeError(
                "a window needs at least one reading, lags at least one sample apart, and a state that is not past",
                f"found {self.count} readings, {self.spacing} samples apart, {self.ahead} ahead",
                "Correct the lags.",
            )

    @property
    def reach(self) -> int:
        """Samples from the first reading of a window to its last."""
        return (self.count - 1) * self.spacing

    def static(self) -> Lags:
        """Return the window that holds the present reading alone."""
        return Lags(1, 1)


def windows_of(
    recording: Recording,
    sensors: Sequence[str],
    states: Sequence[str],
    lags: Lags,
    phi: NDArray[np.float64],
    missing: bool = False,
) -> Samples:
    """Every window of one recording; none reaches beyond its start, nor over a missing value unless that is allowed.

    sensors, states: channels that are read, and channels that are to be reconstructed
    phi (time,) [% stride]: percent stride of every sample of the recording
    missing: whether windows are kept whose readings are missing in part (NaN); the states must be there
    returns: x (window, reading * sensor), oldest reading first, sensors side by side; y, time and phi those of the
        state that is reconstructed, at the last reading or `lags.ahead` samples later. Windows that lack a value are
        left out

    >>> from gaitdisc.channel import Channel
    >>> pair = (Channel("a", "signal", "V"), Channel("b", "signal", "V"))
    >>> r = Recording(np.arange(4) / 10, np.column_stack([np.arange(4), 10 * np.arange(4)]), pair)
    >>> made = windows_of(r, ["a"], ["b"], Lags(2, 1), np.zeros(4))
    >>> made.x.tolist(), made.y.ravel().tolist(), made.inputs
    ([[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]], [10.0, 20.0, 30.0], ('a 0.10 s ago', 'a'))
    """
    read, wanted = recording.selected(sensors).values, recording.selected(states).values
    if len(read) <= lags.reach + lags.ahead:
        forth = f" and {lags.ahead / recording.rate_hz:.2f} s ahead" if lags.ahead else ""
        raise SamplingError(
            f"a window reaches back {lags.reach / recording.rate_hz:.2f} s{forth}",
            f"{recording.source.file or 'the recording'} lasts {recording.duration_s:.2f} s",
            "Take fewer lags, or a longer trial.",
        )
    last = np.arange(lags.reach, len(read) - lags.ahead)
    rows = last[:, None] + (np.arange(lags.count) - lags.count + 1) * lags.spacing
    x = read[rows].reshape(len(last), -1)
    known = np.isfinite(x)
    whole = (known.any(axis=1) if missing else known.all(axis=1)) & np.isfinite(wanted[last + lags.ahead]).all(axis=1)
    names = tuple(
        sensor if ago == 0 else f"{sensor} {ago * lags.spacing / recording.rate_hz:.2f} s ago"
        for ago in range(lags.count - 1, -1, -1)
        for sensor in sensors
    )
    kept = last[whole] + lags.ahead
    return Samples(
        x[whole], wanted[kept], names, tuple(states), recording.time[kept], np.asarray(phi)[kept], recording.subject
    )


def present(samples: Samples, sensors: Sequence[str]) -> Samples:
    """Keep the present reading of each window: what a model without history sees."""
    return replace(samples, x=samples.x[:, -len(sensors) :], inputs=tuple(sensors))


def stacked(samples: Sequence[Samples]) -> Samples:
    """Put windows of several trials one below the other; each window still belongs to one trial."""
    first = samples[0]
    joined = {name: np.concatenate([getattr(each, name) for each in samples]) for name in ("x", "y", "time", "phi")}
    subjects = {each.subject for each in samples}
    return replace(first, **joined, subject=first.subject if len(subjects) == 1 else f"{len(subjects)} people")


def thinned(samples: Samples, most: int) -> Samples:
    """Keep every k-th window, as few as needed to have no more than so many: neighbours say nearly the same."""
    return samples.rows(slice(None, None, max(1, -(-len(samples) // most))))
