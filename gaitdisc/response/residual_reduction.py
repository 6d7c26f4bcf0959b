"""By how much a model makes the stride-averaged residual smaller than the Nominal model leaves it (Fig. 4.3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.response.comparison import ALPHA, FEWEST, compare_columns
from gaitdisc.results import ParticipantResponse
from gaitdisc.results.over_participants import REDUCTION_COLUMNS, REDUCTION_TEST_COLUMNS, no_rows
from gaitdisc.results.participant_response import MODELS
from gaitdisc.statistics.stride_residuals import LEAST_STRIDES, mean_over_strides

MEASURES = ("peak_to_peak", "rms")


def residual_reductions(responses: Sequence[ParticipantResponse]) -> pd.DataFrame:
    """Size of the stride-averaged residual of every participant, variable and model, and its reduction.

    The residual is measured minus predicted second derivative, averaged over the held-out strides of the device walk;
    its size is the peak-to-peak value and the root mean square over the stride. The reduction is
    1 - size / size of the Nominal model's: 0 for the Nominal model itself, negative where a model makes it larger.

    responses: the participants; one with fewer than five strides has no numbers
    returns: columns `REDUCTION_COLUMNS`
    Source: Ebers 2023, section 4.3: "the magnitude of this pattern was reduced by 52.8%", for the hip of one
        participant. How the magnitude is measured is not said; both usual readings are given. An average over n
        strides keeps 1/n of the variance between strides, so the reduction stays below 1 even where nothing is missed.
    """
    tables = [_of_one(response) for response in responses]
    if not tables:
        return no_rows("reductions")
    return pd.concat(tables, ignore_index=True)[list(REDUCTION_COLUMNS)]


def compare_reductions(reductions: pd.DataFrame, alpha: float = ALPHA) -> pd.DataFrame:
    """Test the reductions against zero over participants, for each measure and model over the variables.

    reductions: of `residual_reductions`
    alpha: of each family: the variables of one measure and model
    returns: columns `REDUCTION_TEST_COLUMNS`; shift, low and high are the Hodges-Lehmann reduction and its interval of
        95 %. Empty for fewer than six participants
    """
    if reductions["participant"].nunique() < FEWEST:
        return no_rows("reduction_tests")
    parts = []
    for measure in MEASURES:
        for model in MODELS[1:]:
            own = reductions[reductions["model"] == model]
            found = own.pivot_table(
                index="participant", columns="variable", values=f"{measure}_reduction", sort=False, dropna=False
            )
            parts.append(
                compare_columns(found * 0.0, found, alpha).assign(measure=measure, first="nominal", second=model)
            )
    return pd.concat(parts, ignore_index=True)[list(REDUCTION_TEST_COLUMNS)]


def representative(reductions: pd.DataFrame, model: str = "augmented", measure: str = "rms") -> str:
    """Participant whose reduction, median over variables, is nearest to the median participant's.

    reductions: of `residual_reductions`
    returns: pseudonym; the first of several as near, empty where nobody has a number
    """
    own = reductions[reductions["model"] == model]
    middle = own.groupby("participant", sort=False)[f"{measure}_reduction"].median().dropna()
    return str((middle - middle.median()).abs().idxmin()) if len(middle) else ""


def _of_one(response: ParticipantResponse) -> pd.DataFrame:
    residuals = response.residuals
    sizes = {model: _sizes(curves) for model, curves in residuals.items()}
    parts = []
    for model, size in sizes.items():
        table = size.assign(
            participant=response.participant,
            variable=response.outputs,
            unit=response.units,
            model=model,
            strides=len(residuals[model]),
        )
        for measure in MEASURES:
            nominal = sizes["nominal"][measure].where(sizes["nominal"][measure] > 0)
            table[f"{measure}_reduction"] = 1 - size[measure] / nominal
        parts.append(table)
    return pd.concat(parts, ignore_index=True)


def _sizes(residuals: NDArray[np.float64]) -> pd.DataFrame:
    if len(residuals) < LEAST_STRIDES:
        return pd.DataFrame(np.full((residuals.shape[2], len(MEASURES)), np.nan), columns=pd.Index(MEASURES))
    mean = mean_over_strides(residuals)
    return pd.DataFrame({measure: getattr(mean, measure) for measure in MEASURES})
