"""A gait cycle: one stride with its events, and why it is left out where it is."""

from __future__ import annotations

from dataclasses import dataclass

NAN = float("nan")


@dataclass(frozen=True)
class Cycle:
    """From one initial contact to the next of the same foot, on the trial's clock.

    >>> Cycle("r", 1.0, 2.0, ("markers", "markers"), foot_off=1.5).stance_percent
    50.0
    """

    side: str
    start: float  # initial contacts [s]
    end: float  # initial contacts [s]
    # tuple of (str, str), what places the two contacts: `events`, `force`, `markers` or `angles`
    contacts_by: tuple[str, str]
    foot_off: float = NAN  # the other events inside of the cycle [s]; NaN where nothing places them
    opposite_off: float = NAN  # the other events inside of the cycle [s]; NaN where nothing places them
    opposite_contact: float = NAN  # the other events inside of the cycle [s]; NaN where nothing places them
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
