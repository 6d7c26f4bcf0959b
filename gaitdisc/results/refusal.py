"""Who or what is left out of a result, and why."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Refusal:
    """A participant or a trial that is not in the tables, and why."""

    participant: str
    condition: str  # condition of the trial, or empty where the participant as a whole is refused
    reason: str
