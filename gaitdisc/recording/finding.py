"""What is wrong with a recording, said so that a person can act on it."""

from __future__ import annotations

from dataclasses import dataclass

from gaitdisc.recording.arrays import Span

SEVERITIES = ("note", "warning", "refused")


@dataclass(frozen=True)
class Finding:
    """One observation about a file or a channel.

    Parameters
    ----------
    severity : str
        `note` (nothing is affected), `warning` (some samples or channels are affected), `refused` (the trial is not
        used).
    kind : str
        Kind of the observation in one or two words: `gap`, `dead`, `clipped`, `late change`, ...
    file : str
        Name of the file, or of the trial if there is no file.
    what : str
        The observation, with number and unit.
    spoils : str
        What the observation affects, and what the user can do.
    channel : str
        Name of the channel; empty for the entire file.
    spans : tuple of Span
        Start and end of each affected part [s].

    Examples
    --------
    >>> Finding("warning", "gap", "walk.mot", "0.12 s missing", "accelerations within 0.15 s", "knee_angle_r").line()
    'warning: walk.mot, knee_angle_r: gap: 0.12 s missing; affects accelerations within 0.15 s'
    """

    severity: str
    kind: str
    file: str
    what: str
    spoils: str
    channel: str = ""
    spans: tuple[Span, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a severity that the traffic light does not know."""
        if self.severity not in SEVERITIES:
            raise ValueError(f"severity must be one of {SEVERITIES}, not {self.severity!r}")

    @property
    def rank(self) -> int:
        """Rank of the severity: 0 for `refused`, the most severe."""
        return len(SEVERITIES) - 1 - SEVERITIES.index(self.severity)

    def line(self) -> str:
        """Return the finding as one line of text."""
        where = ", ".join(part for part in (self.file, self.channel) if part)
        spoils = f"; affects {self.spoils}" if self.spoils else ""
        return f"{self.severity}: {where}: {self.kind}: {self.what}{spoils}"
