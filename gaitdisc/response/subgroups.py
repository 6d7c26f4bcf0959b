"""Do participants respond in kinds: sub-groups of the discrepancies over the stride (the question of section 6.2)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import ComparisonError
from gaitdisc.results import ParticipantResponse
from gaitdisc.results.over_participants import RESPONDER_COLUMNS, no_rows
from gaitdisc.statistics.groups import FEWEST, Groups, find_groups


def responder_table(responses: Sequence[ParticipantResponse], seed: int = 0) -> tuple[pd.DataFrame, str]:
    """Sub-group of each participant, and the verdict in a sentence that says who was looked at.

    responses: the participants. Who lacks a point of the stride in an output is left out by name
    returns table: columns `RESPONDER_COLUMNS`; empty where there were too few, or outputs differ
    """
    complete = [response for response in responses if _complete(response)]
    absent = [response.participant for response in responses if not _complete(response)]
    left_out = f"; left out, for strides with missing points: {', '.join(absent)}" if absent else ""
    who = f"n = {len(complete)} participants{left_out}"
    if len(complete) < FEWEST:
        return no_rows("responders"), f"Sub-groups were not looked for, which takes {FEWEST} participants ({who})"
    try:
        groups = find_responders(complete, seed)
    except ComparisonError as error:
        return no_rows("responders"), f"Sub-groups were not looked for: {error}"
    numbers = (groups.count, groups.silhouette, groups.p, groups.stability)
    rows = [
        (response.participant, int(group), *numbers) for response, group in zip(complete, groups.labels, strict=True)
    ]
    return pd.DataFrame(rows, columns=pd.Index(RESPONDER_COLUMNS)), f"{groups.why} ({who})"


def find_responders(responses: Sequence[ParticipantResponse], seed: int = 0) -> Groups:
    """Look for sub-groups of participants whose discrepancies have one shape over the stride."""
    return find_groups(discrepancy_curves(responses), seed=seed)


def discrepancy_curves(responses: Sequence[ParticipantResponse]) -> NDArray[np.float64]:
    """Mean over strides of what the Nominal model leaves of device walking, one row a participant.

    returns (participant, output and phase) [1]: every output over its root mean square of all participants, so that
        angles and EMG weigh alike
    """
    outputs = {response.outputs for response in responses}
    if len(outputs) != 1:
        raise ComparisonError(
            "discrepancies are compared over the same outputs of all participants",
            f"found {len(outputs)} sets of outputs in {len(responses)} participants",
            "Leave out whoever lacks an output.",
        )
    means = np.stack([np.nanmean(response.residuals["nominal"], axis=0) for response in responses])
    size = np.sqrt(np.mean(means**2, axis=(0, 1)))
    return (means / np.where(size > 0, size, 1.0)).transpose(0, 2, 1).reshape(len(responses), -1)


def _complete(response: ParticipantResponse) -> bool:
    return bool(np.isfinite(response.residuals["nominal"]).any(axis=0).all())
