"""What the embedded cohort gives for each number that chapter 4 prints, by the `id` of studies/ch4_printed.toml."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pandas as pd

import gaitdisc as gd
from gaitdisc.cohort.demonstration import OUTPUTS
from gaitdisc.response.over_participants import r2_by_participant
from gaitdisc.words import sideless

ANGLES, EMG = OUTPUTS[:3], OUTPUTS[3:]
BELOW_EXO = ("knee_angle_r", "ankle_angle_r", "emg_ham_r", "emg_vas_r")  # in the dissertation


def medians(run: gd.ResponseRun, model: str, walk: str = "exo") -> pd.Series:
    """Median over participants of the network's R2, one number a variable."""
    rows = run.r2_table()
    rows = rows[(rows["model"] == model) & (rows["walk"] == walk) & (rows["kind"] == "network")]
    return rows.groupby("variable")["r2"].median().reindex(OUTPUTS)


def _range(values: pd.Series, factor: float = 1.0, digits: int = 3) -> str:
    return f"{factor * values.min():.{digits}f}-{factor * values.max():.{digits}f}"


def _medians(model: str, names: Sequence[str], walk: str = "exo") -> Callable[[gd.ResponseRun], str]:
    return lambda run: _range(medians(run, model, walk)[list(names)])


def _differ(run: gd.ResponseRun, first: str, second: str, sign: int) -> pd.DataFrame:
    rows = run.tests.of_pair(first, second) if run.tests else pd.DataFrame()
    return rows[rows["different"].astype(bool) & (sign * rows["rank_biserial"] > 0)] if len(rows) else rows


def _named(rows: pd.DataFrame) -> str:
    return ", ".join(sideless(name) for name in rows["variable"]) if len(rows) else "none"


def _over_nominal(run: gd.ResponseRun) -> str:
    rows = _differ(run, "nominal", "augmented", 1)
    return f"{len(rows)} of {len(OUTPUTS)}, p <= {rows['p'].max():.3f}" if len(rows) else "not tested"


def representative(reductions: pd.DataFrame) -> str:
    """Pseudonym whose reduction of the root mean square by Augmented is nearest the median; the first, or empty."""
    augmented = reductions[reductions["model"] == "augmented"]
    middle = augmented.groupby("participant", sort=False)["rms_reduction"].median().dropna()
    return str((middle - middle.median()).abs().idxmin()) if len(middle) else ""


def _hip(run: gd.ResponseRun) -> str:
    if run.over is None or not (person := representative(run.over.reductions)):
        return "too few strides"
    rows = run.over.reductions
    own = rows[(rows["participant"] == person) & (rows["variable"] == ANGLES[0]) & (rows["model"] == "augmented")]
    both = [f"{100 * float(own[f'{measure}_reduction'].iloc[0]):.1f}" for measure in ("peak_to_peak", "rms")]
    return f"{'; '.join(both)} ({person})"


def _reduced(run: gd.ResponseRun, names: Sequence[str]) -> pd.DataFrame:
    rows = run.over.reduction_tests if run.over else pd.DataFrame()
    return rows[(rows["second"] == "augmented") & rows["variable"].isin(names)] if len(rows) else rows


def _hip_all(run: gd.ResponseRun) -> str:
    found = 100 * _reduced(run, ANGLES[:1]).reindex(columns=["shift", "low", "high"]).to_numpy(float)
    return "; ".join(f"{middle:.0f} [{low:.0f}, {high:.0f}]" for middle, low, high in found) or "not tested"


def _emg_reduced(run: gd.ResponseRun) -> str:
    rows = _reduced(run, EMG)
    rows = rows[rows["measure"] == "rms"] if len(rows) else rows
    return _named(rows[rows["different"].astype(bool) & (rows["shift"] > 0)]) if len(rows) else "not tested"


def _at_one_second(run: gd.ResponseRun) -> str:
    rows = [medians.loc[1.0] for quantity in run.quantities if 1.0 in (medians := quantity.medians()).index]
    models, table = ("nominal", "augmented", "exo"), pd.DataFrame(rows)
    return ", ".join(f"{table[model].median():.2f}" for model in models) if len(table) else "none"


def _lengths(run: gd.ResponseRun, enough: bool = False) -> str:
    if run.over is None or not len(rows := run.over.lengths):
        return "not tested"
    if enough:
        return f"{found:g}" if (found := run.over.enough_length()) else "not even 180"
    counts = rows[(rows["second"] == "exo") & rows["different"].astype(bool)].groupby("length_s").size()
    return "; ".join(f"{length:g} ({count} variables)" for length, count in counts.items()) or "none"


OURS: dict[str, Callable[[gd.ResponseRun], str]] = {
    "people": lambda run: str(len(run.responses)),
    "nominal_angles_without": _medians("nominal", ANGLES, "nominal"),
    "nominal_emg_without": _medians("nominal", EMG, "nominal"),
    "nominal_angles": _medians("nominal", ANGLES),
    "nominal_emg": _medians("nominal", EMG),
    "augmented_angles": _medians("augmented", ANGLES),
    "augmented_emg": _medians("augmented", EMG),
    "exo_angles": _medians("exo", ANGLES),
    "exo_emg": _medians("exo", EMG),
    "augmented_over_nominal": _over_nominal,
    "gain": lambda run: _range(
        (r2_by_participant(run.responses, "augmented") - r2_by_participant(run.responses, "nominal")).median(), 100, 1
    ),
    "augmented_below_exo": lambda run: _named(_differ(run, "augmented", "exo", 1)),
    "below_exo_by": lambda run: ", ".join(
        f"{one:.4f}" for one in (medians(run, "exo") - medians(run, "augmented"))[list(BELOW_EXO)]
    ),
    "augmented_above_exo": lambda run: _named(_differ(run, "augmented", "exo", -1)),
    "exo_below_one": lambda run: _named(_differ(run, "exo", "perfect", 1)),
    "hip_reduction": _hip,
    "hip_reduction_all": _hip_all,
    "emg_reduced": _emg_reduced,
    "at_one_second": _at_one_second,
    "lengths_augmented_exo": _lengths,
    "lengths_enough": lambda run: _lengths(run, enough=True),
}
