"""Do participants respond in kinds: sub-groups of the discrepancies over the stride (the question of section 6.2)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ComparisonError
from gaitdisc.results import ParticipantResponse
from gaitdisc.statistics.clusters import Groups, find_groups


def find_responders(responses: Sequence[ParticipantResponse], seed: int = 0) -> Groups:
    """Look for sub-groups of participants whose discrepancies have one shape over the stride.

    Parameters
    ----------
    responses : sequence of ParticipantResponse
        Six or more, with the same outputs.
    seed : int
        Of the clouds that the sub-groups are held against.

    Returns
    -------
    Groups

    Raises
    ------
    ComparisonError
        If the participants differ in outputs, or there are fewer than six.
    """
    return find_groups(discrepancy_curves(responses), seed=seed)


def discrepancy_curves(responses: Sequence[ParticipantResponse]) -> NDArray[np.float64]:
    """Mean over strides of what the Nominal model leaves of device walking, one row a participant.

    Parameters
    ----------
    responses : sequence of ParticipantResponse
        With the same outputs.

    Returns
    -------
    ndarray (participant, output and phase) [1]
        Every output over its root mean square of all participants, so that angles and EMG weigh alike.

    Raises
    ------
    ComparisonError
        If the participants differ in outputs.
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
