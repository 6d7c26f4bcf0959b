"""How much data is enough: the models of a participant fitted to less and less of the training part (section 4.2.4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from gaitdisc.errors import SamplingError, TrainingError
from gaitdisc.recording import Trajectory
from gaitdisc.response.fit_response import ResponseSettings, fit_response, held_out_part
from gaitdisc.response.models import report_share
from gaitdisc.results.participant_response import QUANTITY_COLUMNS, DataQuantity, ParticipantResponse

LENGTHS_S = (1.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0)
PARTS = ("first", "last")


def fit_data_quantity(
    nominal: Trajectory,
    exo: Trajectory,
    settings: ResponseSettings,
    lengths_s: Sequence[float] = LENGTHS_S,
    part: str = "first",
    progress: Callable[[float], None] | None = None,
    whole: ParticipantResponse | None = None,
) -> DataQuantity:
    """Fit Nominal, Exo and Discrepancy to parts of the training part, and to all of it, and score each alike.

    lengths_s: lengths of the training part [s]; its whole length is always added
    part: `first` takes the beginning of the training part, from its first usable sample on, `last` its end, next to
        what is held out. The text does not say which; the two differ where gait drifts
    whole: what the whole training part gave, fitted to the same walks with the same settings; it is then not fitted
        again
    Source: Ebers 2023, section 4.2.4 and Fig. 4.4.
    """
    if part not in PARTS:
        raise SamplingError("the training part is taken from its first or last seconds", f"found {part!r}", "Name one.")
    progress = progress or (lambda _: None)
    training = {"nominal": held_out_part(nominal, settings)[0], "exo": held_out_part(exo, settings)[0]}
    whole_s = min(len(walk.time) / walk.rate_hz for walk in training.values())
    wanted = sorted({length for length in lengths_s if length < whole_s})
    left_away = {
        length: f"the training part has {whole_s:.1f} s" for length in sorted(set(lengths_s)) if length >= whole_s
    }
    tables = []
    for number, length in enumerate(wanted if whole else [*wanted, whole_s]):
        less_nominal, less_exo = (shortened(walk, settings, length, part) for walk in (nominal, exo))
        report = partial(report_share, progress, number, len(wanted) + 1)
        try:
            response = fit_response(less_nominal, less_exo, settings, progress=report)
        except TrainingError as error:
            left_away[length] = str(error)
            continue
        tables.append(_with_length(response, length))
    if whole:
        tables.append(_with_length(whole, whole_s))
    progress(1.0)
    columns = pd.Index(QUANTITY_COLUMNS)
    table = pd.concat(tables, ignore_index=True)[columns] if tables else pd.DataFrame(columns=columns)
    return DataQuantity(exo.subject or nominal.subject, part, table, left_away)


def _with_length(response: ParticipantResponse, length_s: float) -> pd.DataFrame:
    fits, r2 = response.fits, response.r2
    used = int(fits[(fits["model"] == "exo") & (fits["kind"] == "network")]["n_training"].iloc[0])
    return r2[r2["kind"] != "null"].assign(length_s=length_s, n_training=used)  # the filters' null has no length


def shortened(walk: Trajectory, settings: ResponseSettings, length_s: float, part: str) -> Trajectory:
    """Walk whose training part keeps `length_s` [s] usable; the held-out part is untouched."""
    training, _ = held_out_part(walk, settings)
    count, keep = len(training.time), round(length_s * walk.rate_hz)
    good = np.flatnonzero(np.isfinite(training.phi) & training.usable.all(axis=1))
    if not len(good):
        return walk
    usable = walk.usable.copy()
    if part == "first":  # counted from the first sample that can be used: a filter's edge teaches nothing
        usable[good[0] + keep : count] = False
    else:
        usable[: max(0, good[-1] + 1 - keep)] = False
    return replace(walk, usable=usable)
