"""Who or what is left out of a result, and why."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Refusal:
    """A participant or a trial that is not in the tables, and why.

    Parameters
    ----------
    condition : str
        Condition of the trial, or empty where the participant as a whole is refused.
    """

    participant: str
    condition: str
    reason: str
