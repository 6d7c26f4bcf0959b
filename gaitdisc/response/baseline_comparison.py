"""Is the network worth its trouble: its R2 against what needs no network, over the participants."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from gaitdisc.response.comparison import ALPHA, FEWEST, compare_columns, r2_by_participant
from gaitdisc.results import ParticipantResponse
from gaitdisc.results.over_participants import BASELINE_COLUMNS, no_rows
from gaitdisc.results.participant_response import BASELINES, MODELS


def compare_baselines(responses: Sequence[ParticipantResponse], alpha: float = ALPHA) -> pd.DataFrame:
    """Compare the networks' R2 on held-out device walking with that of ridge regressions and of the filters' null.

    alpha: of each family: the variables of one model and baseline
    returns: columns `BASELINE_COLUMNS`: first is the baseline, second `network`; empty for fewer than six
        participants. A network that is shown to be no better than its baseline in a variable earns nothing there
    """
    if len(responses) < FEWEST:
        return no_rows("baselines")
    null = r2_by_participant(responses, "nominal", "null")
    parts = []
    for model in MODELS:
        network = r2_by_participant(responses, model)
        for kind in BASELINES:
            baseline = null if kind == "null" else r2_by_participant(responses, model, kind)
            parts.append(compare_columns(baseline, network, alpha).assign(model=model, first=kind, second="network"))
    return pd.concat(parts, ignore_index=True)[list(BASELINE_COLUMNS)]
