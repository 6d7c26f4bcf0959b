"""Initial contacts of one foot, and what two detectors make of the same walk."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import StrideError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import read_only

DETECTORS = ("force", "markers", "angles", "events", "oscillator")
MATCH_S = 0.25


@dataclass(frozen=True, eq=False)
class Contacts:
    """Initial contacts of one foot.

    Parameters
    ----------
    time : ndarray (contact,) [s]
        On the trial's clock, increasing.
    side : str
        `r` or `l`.
    detector : str
        `force`, `markers`, `angles`, `events` or `oscillator`.
    foot_off : ndarray (foot off,) [s]
        Where the detector sees them too; empty otherwise.
    note : str
        What was inferred rather than given, and what the times stand for.

    Raises
    ------
    StrideError
        If the times do not increase, or side or detector is none of the agreed words.

    Examples
    --------
    >>> len(Contacts(np.array([0.1, 1.2]), "r", "force"))
    2
    """

    time: NDArray[np.float64]
    side: str
    detector: str
    foot_off: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    note: str = ""

    def __post_init__(self) -> None:
        """Check order and words once."""
        time = read_only(self.time)
        if self.side not in ("r", "l") or self.detector not in DETECTORS:
            raise StrideError(
                "contacts need side 'r' or 'l' and a known detector",
                f"found side {self.side!r}, detector {self.detector!r}",
                f"Detectors are {', '.join(DETECTORS)}.",
            )
        if time.ndim != 1 or np.any(np.diff(time) <= 0) or not np.isfinite(time).all():
            raise StrideError(
                "initial contacts need increasing times",
                f"side {self.side!r}, detector {self.detector}: shape {time.shape}, out of order or missing",
                "Sort the events of the file, or choose another detector.",
            )
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "foot_off", read_only(self.foot_off))

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        span = f", {self.time[0]:.2f} to {self.time[-1]:.2f} s" if len(self) else ""
        return f"Contacts({len(self)} of side {self.side!r} by {self.detector}{span})"

    def compared(self, other: Contacts, within_s: float = MATCH_S) -> Agreement:
        """Match these contacts with those of another detector, nearest to nearest.

        Parameters
        ----------
        other : Contacts
            Of the same foot in the same walk.
        within_s : float
            Farther apart is no pair [s].

        Returns
        -------
        Agreement
            `difference_s`, other minus these, of each pair; `missed` and `extra` [s]. Contacts before the first or
            after the last of the other detector (by more than `within_s`) count as neither: a plate sees two steps of
            a walk.

        Raises
        ------
        StrideError
            If the two are of different feet.

        Examples
        --------
        >>> a = Contacts(np.array([1.0, 2.0, 3.0]), "r", "force")
        >>> b = Contacts(np.array([1.02, 3.02]), "r", "markers")
        >>> a.compared(b).line()
        '2 pairs, second minus first +20 ms (median), 0 ms (interquartile range); 1 missed, 0 extra'
        """
        if self.side != other.side:
            raise StrideError(
                "contacts to compare need one foot",
                f"found {self.detector} of side {self.side!r} and {other.detector} of side {other.side!r}",
                "Compare right with right, left with left.",
            )
        if not len(self) or not len(other):
            return Agreement(np.empty(0), np.empty(0), np.empty(0))
        apart = other.time[None, :] - self.time[:, None]
        nearest = np.abs(apart).argmin(axis=1)
        back = np.abs(apart).argmin(axis=0)
        rows = np.flatnonzero((back[nearest] == np.arange(len(self))) & (np.abs(apart).min(axis=1) <= within_s))
        columns = nearest[rows]
        lone_own = np.delete(self.time, rows)
        lone_other = np.delete(other.time, columns)
        return Agreement(
            apart[rows, columns], _covered(lone_own, other, within_s), _covered(lone_other, self, within_s)
        )


@dataclass(frozen=True, eq=False)
class Agreement:
    """Two detectors on the same walk."""

    difference_s: NDArray[np.float64]  # (pair,) [s], second minus first, of each matched pair
    missed: NDArray[np.float64]  # [s], contacts of the first that the second does not see, within the span of both
    extra: NDArray[np.float64]  # [s], contacts of the second that the first does not see, within the span of both

    @property
    def median_ms(self) -> float:
        """Median difference [ms]; NaN without pairs."""
        return float(1e3 * np.median(self.difference_s)) if len(self.difference_s) else float("nan")

    @property
    def iqr_ms(self) -> float:
        """Interquartile range of the differences [ms]; NaN without pairs."""
        return (
            float(1e3 * np.subtract(*np.percentile(self.difference_s, [75, 25]))) if len(self.difference_s) else np.nan
        )

    def line(self) -> str:
        """Return the comparison as one line of text."""
        return (
            f"{len(self.difference_s)} pairs, second minus first {self.median_ms:+.0f} ms (median), "
            f"{self.iqr_ms:.0f} ms (interquartile range); {len(self.missed)} missed, {len(self.extra)} extra"
        )


def order_findings(right: Contacts, left: Contacts, file: str = "") -> list[Finding]:
    """Find where right and left contacts do not alternate.

    returns: one warning for each side, with the spans between two contacts of one foot that have none of the other
        between them: a missed contact, or a foot that stepped on the other belt

    >>> r = Contacts(np.array([0.0, 1.0, 2.0, 3.0]), "r", "force")
    >>> print(order_findings(r, Contacts(np.array([0.5, 2.5]), "l", "force"))[0].what)
    1 of 3 strides of side r without one contact of side l inside: at 1.00 s
    """
    findings = []
    for one, other in ((right, left), (left, right)):
        wrong = []
        for start, end in zip(one.time, one.time[1:], strict=False):
            if not len(other) or end < other.time[0] or start > other.time[-1]:
                continue
            if np.sum((other.time > start) & (other.time < end)) != 1:
                wrong.append((float(start), float(end)))
        if wrong:
            at = ", ".join(f"{start:.2f}" for start, _ in wrong[:5]) + (" ..." if len(wrong) > 5 else "")
            findings.append(
                Finding(
                    "warning",
                    "crossover",
                    file,
                    f"{len(wrong)} of {len(one) - 1} strides of side {one.side} without one contact of side "
                    f"{other.side} inside: at {at} s",
                    "these strides: a contact was missed, or a foot stepped on the other plate or belt",
                    spans=tuple(wrong),
                )
            )
    return findings


def _covered(times: NDArray[np.float64], other: Contacts, within_s: float) -> NDArray[np.float64]:
    return times[(times >= other.time[0] - within_s) & (times <= other.time[-1] + within_s)]
