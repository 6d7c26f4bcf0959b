"""Raw EMG of one cycle of each leg, the one whose envelopes lie nearest to their mean."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.processing.process import is_raw
from gaitdisc.recording import Recording, Trial
from gaitdisc.recording.arrays import Values


def find_raw_emg(trial: Trial, states: Sequence[Recording]) -> Recording | None:
    """Raw EMG of a trial, of the channels whose envelopes cycles are cut of; None where the file has envelopes."""
    if "emg" not in trial.streams or not is_raw(trial.stream("emg")):
        return None
    raw = trial.stream("emg")
    names = [name for one in states for name in one.names if name in raw.names]
    return raw.selected(names) if names else None


def choose_typical(curves: Values, kept: pd.DataFrame, channels: Sequence[Channel], side: str) -> int | None:
    """Row of the leg's cycle whose envelopes differ least from their means; None where no cycle has all of them.

    curves (cycle, phase, channel) [channel's unit]

    >>> both = (Channel("emg_ta_l", "emg", "V", "l"),) * 2
    >>> curves = np.array([1.0, 2.0, 9.0])[:, None, None] * np.ones((3, 101, 2))
    >>> choose_typical(curves, pd.DataFrame({"side": ["l", "l", "l"]}), both, "l")
    1
    """
    columns = [column for column, one in enumerate(channels) if one.quantity == "emg" and one.side == side]
    own = curves[:, :, columns]
    rows = np.flatnonzero((kept["side"] == side).to_numpy() & np.isfinite(own).all(axis=(1, 2)))
    if not len(rows) or not columns:
        return None
    mean = own[rows].mean(axis=0)
    return int(rows[np.argmin((((own[rows] - mean) / np.maximum(mean.max(axis=0), 1e-12)) ** 2).sum(axis=(1, 2)))])
