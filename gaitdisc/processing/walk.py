"""A walk: one trial, filtered, cut into strides, differentiated, with everything that was found on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording import PERCENT, Finding, Recording, Strides, Trajectory, Trial
from gaitdisc.results import WalkSummary
from gaitdisc.results.walk_summary import STRIDE_COLUMNS


@dataclass(frozen=True, eq=False)
class Walk:
    """One processed trial."""

    trial: Trial
    # filtered joint angles, and EMG envelopes where the study requests them, on the time base of the kinematics
    state: Recording
    strides: Mapping[str, Strides]
    trajectory: Trajectory  # state, derivatives and percent stride of the study's side
    findings: tuple[Finding, ...]  # of the reader, of the quality checks, and of the stride detectors
    side: str  # side whose strides the percent stride of the trajectory follows

    def summary(self) -> WalkSummary:
        """What is kept of the walk: curves of every stride of the study's side, strides, findings, file hashes.

        Channels of the other side are cut by the strides of their own foot, so that left and right read alike.
        """
        files = {s.source.file: s.source.sha256 for s in self.trial.streams.values() if s.source.sha256}
        return WalkSummary(
            self.trial.subject,
            self.trial.condition,
            self.state.duration_s,
            self.state.rate_hz,
            self.strides[self.side].detector,
            self.state.channels,
            self._curves(),
            pd.concat([stride_table(self.strides[side]) for side in sorted(self.strides)], ignore_index=True),
            self.findings,
            files,
        )

    def _curves(self) -> NDArray[np.float64]:
        own = [channel.side if channel.side in self.strides else self.side for channel in self.state.channels]
        by_side = {side: self.strides[side].normalised(self.state) for side in set(own)}
        curves = np.full((max(map(len, by_side.values())), len(PERCENT), len(own)), np.nan)
        for column, side in enumerate(own):
            curves[: len(by_side[side]), :, column] = by_side[side][:, :, column]
        return curves


def stride_table(strides: Strides) -> pd.DataFrame:
    """Kept and dropped strides of one side in order of time, columns `STRIDE_COLUMNS`."""
    kept = [(strides.side, start, end, True, "") for start, end in zip(strides.start, strides.end, strict=True)]
    dropped = [(strides.side, d.start, d.end, False, d.reason) for d in strides.dropped]
    rows = sorted([*kept, *dropped], key=lambda row: row[1])
    return pd.DataFrame(rows, columns=pd.Index(STRIDE_COLUMNS))
