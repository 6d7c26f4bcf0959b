"""What is kept of one walk after processing: strides, mean curves, findings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from operator import itemgetter

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import ShapeError
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.recording.arrays import read_only
from gaitdisc.results.kind import CSV, Kind
from gaitdisc.results.on_disk import lies_on_disk, may_lie_on_disk
from gaitdisc.results.unit_folder import unit_name

STRIDE_COLUMNS = ("side", "start_s", "end_s", "kept", "reason")


@may_lie_on_disk("curves")
@dataclass(frozen=True, eq=False)
class WalkSummary:
    """One walk of one person, small enough to keep."""

    subject: str  # pseudonym; the study's word for the condition
    condition: str  # pseudonym; the study's word for the condition
    duration_s: float  # length and rate of the processed recording
    rate_hz: float  # length and rate of the processed recording
    detector: str
    channels: tuple[Channel, ...]
    # (stride, phase, channel) [channel's unit], every kept stride on 101 points; of a walk that was loaded it is read
    # each time it is looked at
    curves: NDArray[np.float64]
    strides: pd.DataFrame  # one row a stride, kept or dropped: side, start_s, end_s, kept, reason
    findings: tuple[Finding, ...]  # everything the reader and the quality checks saw
    files: Mapping[str, str]

    def __post_init__(self) -> None:
        """Check shapes once, before they are saved."""
        if lies_on_disk(self, "curves"):
            return
        wanted = (len(PERCENT), len(self.channels))
        if np.ndim(self.curves) != 3 or self.curves.shape[1:] != wanted:
            raise ShapeError(
                f"curves of a walk need the shape (stride, {wanted[0]}, {wanted[1]})",
                f"found {np.shape(self.curves)} for {self.subject} {self.condition}",
                "Normalise the strides with Strides.normalised.",
            )
        object.__setattr__(self, "curves", read_only(self.curves))

    @property
    def where(self) -> str:
        """Say where among the walks of a person it stands: its condition."""
        return self.condition

    @property
    def worst(self) -> str:
        """Return the severest finding: `refused`, `warning`, `note`, or `clean` where there is none."""
        return min(self.findings, key=lambda finding: finding.rank).severity if self.findings else "clean"

    def counted(self, kept: bool = True) -> dict[str, int]:
        """Number of strides of each side."""
        chosen = self.strides[self.strides["kept"] == kept]
        return {str(side): int(count) for side, count in chosen["side"].value_counts().sort_index().items()}


WALK = Kind(
    WalkSummary,
    "walk.json",
    ("subject", "condition", "duration_s", "rate_hz", "detector", "channels", "findings", "files"),
    {"strides": CSV("strides.csv", STRIDE_COLUMNS)},
    {"curves": itemgetter("curves")},
    lambda walk: {"curves": walk.curves},
    blank=("reason",),
    unit=lambda walk: unit_name(walk.subject, walk.condition),
)
