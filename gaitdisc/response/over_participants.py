"""All that the participants of a study say together, beside the pairs of models."""

from __future__ import annotations

from collections.abc import Sequence

from gaitdisc.response.baseline_comparison import compare_baselines
from gaitdisc.response.length_comparison import compare_lengths, why_no_lengths
from gaitdisc.response.residual_reduction import compare_reductions, residual_reductions
from gaitdisc.response.subgroups import responder_table
from gaitdisc.results import DataQuantity, OverParticipants, ParticipantResponse


def compare_participants(
    responses: Sequence[ParticipantResponse], quantities: Sequence[DataQuantity] = (), seed: int = 0
) -> OverParticipants:
    """Compare training lengths, residuals and baselines over participants, and look for sub-groups of responders."""
    reductions = residual_reductions(responses)
    responders, said = responder_table(responses, seed)
    return OverParticipants(
        lengths=compare_lengths(quantities),
        reductions=reductions,
        reduction_tests=compare_reductions(reductions),
        baselines=compare_baselines(responses),
        responders=responders,
        lengths_said=why_no_lengths(quantities) if quantities else "",
        responders_said=said,
    )
