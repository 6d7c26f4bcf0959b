"""A walk: one trial, filtered, cut into strides, differentiated, with everything that was found on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording import PERCENT, Finding, Recording, Strides, Trajectory, Trial
from gaitdisc.results.pooled_cycles import STRIDE_COLUMNS, WalkSummary


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
        """What is kept of the walk: curves of every stride of the study's side, strides, findings, file hashes."""
        return walk_summary(self.trial, [self.state], self.strides, self.side, self.findings)


def walk_summary(
    trial: Trial,
    states: Sequence[Recording],
    strides: Mapping[str, Strides],
    follow: str,
    findings: Sequence[Finding],
) -> WalkSummary:
    """What is kept of a walk; channels of the other side are cut by the strides of their own foot, as the first are."""
    lead = [*states, *trial.streams.values()][0]
    return WalkSummary(
        trial.subject,
        trial.condition,
        lead.duration_s,
        lead.rate_hz,
        strides[follow].detector,
        tuple(channel for state in states for channel in state.channels),
        stride_curves(states, strides, follow),
        pd.concat([stride_table(strides[side]) for side in sorted(strides)], ignore_index=True),
        tuple(findings),
        {one.source.file: one.source.sha256 for one in trial.streams.values() if one.source.sha256},
    )


def stride_curves(states: Sequence[Recording], strides: Mapping[str, Strides], follow: str) -> NDArray[np.float64]:
    """Strides (stride, phase, channel) by the own foot's contacts, else the followed foot's; NaN behind the fewer."""
    columns: list[NDArray[np.float64]] = []
    for state in states:
        own = [channel.side if channel.side in strides else follow for channel in state.channels]
        by_side = {side: strides[side].normalised(state) for side in set(own)}
        columns += [by_side[side][:, :, column] for column, side in enumerate(own)]
    curves = np.full((max(map(len, columns), default=0), len(PERCENT), len(columns)), np.nan)
    for column, values in enumerate(columns):
        curves[: len(values), :, column] = values
    return curves


def stride_table(strides: Strides) -> pd.DataFrame:
    """Kept and dropped strides of one side in order of time, columns `STRIDE_COLUMNS`."""
    kept = [(strides.side, start, end, True, "") for start, end in zip(strides.start, strides.end, strict=True)]
    dropped = [(strides.side, d.start, d.end, False, d.reason) for d in strides.dropped]
    rows = sorted([*kept, *dropped], key=lambda row: row[1])
    return pd.DataFrame(rows, columns=pd.Index(STRIDE_COLUMNS))
