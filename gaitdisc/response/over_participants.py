"""What the participants say together: which model explains more (section 4.2.3), and all beside these pairs."""

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import ComparisonError
from gaitdisc.response.participant_response import BASELINES, MODELS, DataQuantity, ParticipantResponse
from gaitdisc.response.participants_result import (
    FAMILIES,
    PAIRS,
    RESPONDER_COLUMNS,
    WHOLE,
    OverParticipants,
    PairTests,
    join_rows,
)
from gaitdisc.statistics.groups import FEWEST as FEWEST_GROUPED
from gaitdisc.statistics.groups import find_groups
from gaitdisc.statistics.holm_sidak import holm_sidak
from gaitdisc.statistics.signed_rank import signed_rank, smallest_p
from gaitdisc.statistics.stride_residuals import LEAST_STRIDES, mean_over_strides

FEWEST = 6  # the fewest of whom a two-sided exact test can be below 0.05
ALPHA = 0.05
LEVEL = 0.95
TESTED = ("w", "p", "median_first", "median_second", "median_difference", "shift", "low", "high", "rank_biserial")
MEASURES = ("peak_to_peak", "rms")


def compare_baselines(responses: Sequence[ParticipantResponse]) -> pd.DataFrame:
    """Compare the networks' R2 on held-out device walking with ridge regressions' and the null's (`BASELINE_COLUMNS`).

    Corrected over one model's and baseline's variables; a network shown to be no better there earns nothing.
    """
    if len(responses) < FEWEST:
        return join_rows("baselines")
    null = r2_by_participant(responses, "nominal", "null")
    tables = []
    for model in MODELS:
        network = r2_by_participant(responses, model)
        for kind in BASELINES:
            baseline = null if kind == "null" else r2_by_participant(responses, model, kind)
            tables.append(compare_columns(baseline, network).assign(model=model, first=kind, second="network"))
    return join_rows("baselines", tables)


def compare_lengths(quantities: Sequence[DataQuantity]) -> pd.DataFrame:
    """Compare, at every training length, Augmented with Exo, and Exo with the Exo of the whole training part.

    Corrected over the variables at one length: a family of all would hold 72 tests or more, and at n = 11 at most 52
    can show something. Who lacks a length is left out of it by name; empty for fewer than six.
    Source: Ebers 2023, section 4.2.4, comparisons (i) and (ii). The family is not said there.
    """
    if len(quantities) < FEWEST:
        return join_rows("lengths")
    table = pd.concat([person.table.assign(participant=person.participant) for person in quantities], ignore_index=True)
    table = table[(table["kind"] == "network") & (table["walk"] == "exo")]
    longest = table.groupby("participant")["length_s"].transform("max")
    full = by_participant(table[(table["length_s"] == longest) & (table["model"] == "exo")])
    tables = []
    for length, rows in table[table["length_s"] < longest].groupby("length_s"):
        augmented, exo = (by_participant(rows[rows["model"] == model]).reindex_like(full) for model in MODELS[1:])
        for first, second, pair in (("augmented", "exo", (augmented, exo)), ("exo", WHOLE, (exo, full))):
            tables.append(compare_columns(*pair).assign(length_s=length, first=first, second=second))
    return join_rows("lengths", tables)


def by_participant(table: pd.DataFrame, values: str = "r2") -> pd.DataFrame:
    """Numbers of a table of one row a participant and variable, as (participant, variable)."""
    return table.pivot_table(index="participant", columns="variable", values=values, sort=False, dropna=False)


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
    return join_rows("reductions", [_of_one(response) for response in responses])


def compare_reductions(reductions: pd.DataFrame) -> pd.DataFrame:
    """Test reductions against zero, a family a measure and model; Hodges-Lehmann shift and 95 % interval."""
    if reductions["participant"].nunique() < FEWEST:
        return join_rows("reduction_tests")
    tables = []
    for measure, model in product(MEASURES, MODELS[1:]):
        reduced = by_participant(reductions[reductions["model"] == model], f"{measure}_reduction")
        tables.append(compare_columns(reduced * 0.0, reduced).assign(measure=measure, first="nominal", second=model))
    return join_rows("reduction_tests", tables)


def _of_one(response: ParticipantResponse) -> pd.DataFrame:
    sizes = {}
    for model, curves in response.residuals.items():
        if len(curves) < LEAST_STRIDES:
            sizes[model] = pd.DataFrame(np.nan, index=range(curves.shape[2]), columns=pd.Index(MEASURES))
            continue
        mean = mean_over_strides(curves)
        sizes[model] = pd.DataFrame({measure: getattr(mean, measure) for measure in MEASURES})
    nominal = sizes["nominal"].where(sizes["nominal"] > 0)
    tables = [
        pd.concat([size, (1 - size / nominal).add_suffix("_reduction")], axis=1).assign(
            participant=response.participant,
            variable=response.outputs,
            unit=response.units,
            model=model,
            strides=len(response.residuals[model]),
        )
        for model, size in sizes.items()
    ]
    return pd.concat(tables, ignore_index=True)


def responder_table(responses: Sequence[ParticipantResponse], seed: int = 0) -> tuple[pd.DataFrame, str]:
    """Sub-groups (`RESPONDER_COLUMNS`) and the verdict, naming who was left out; empty where too few or unlike."""
    flags = [bool(np.isfinite(person.residuals["nominal"]).any(axis=0).all()) for person in responses]
    complete = [person for person, has_all in zip(responses, flags, strict=True) if has_all]
    absent = [person.participant for person, has_all in zip(responses, flags, strict=True) if not has_all]
    left_out = f"; excluded because of strides with missing points: {', '.join(absent)}" if absent else ""
    who = f"n = {len(complete)} participants{left_out}"
    if len(complete) < FEWEST_GROUPED:
        verdict = f"Sub-groups were not tested, because the test requires {FEWEST_GROUPED} participants ({who})"
        return join_rows("responders"), verdict
    try:
        groups = find_groups(discrepancy_curves(complete), seed=seed)
    except ComparisonError as error:
        return join_rows("responders"), f"Sub-groups were not tested: {str(error).removesuffix('.')}"
    numbers = (groups.count, groups.silhouette, groups.p, groups.stability)
    rows = [
        (response.participant, int(group), *numbers) for response, group in zip(complete, groups.labels, strict=True)
    ]
    return pd.DataFrame(rows, columns=pd.Index(RESPONDER_COLUMNS)), f"{groups.why} ({who})"


def discrepancy_curves(responses: Sequence[ParticipantResponse]) -> NDArray[np.float64]:
    """Mean Nominal residual (participant, output and phase) [1], each output over its root mean square of all."""
    outputs = {response.outputs for response in responses}
    if len(outputs) != 1:
        raise ComparisonError(
            "discrepancies can be compared only for the same outputs of all participants",
            f"there are {len(outputs)} sets of outputs in {len(responses)} participants",
            "Exclude participants who lack an output.",
        )
    means = np.stack([np.nanmean(response.residuals["nominal"], axis=0) for response in responses])
    size = np.sqrt(np.mean(means**2, axis=(0, 1)))
    return (means / np.where(size > 0, size, 1.0)).transpose(0, 2, 1).reshape(len(responses), -1)


def compare_participants(
    responses: Sequence[ParticipantResponse], quantities: Sequence[DataQuantity] = (), seed: int = 0
) -> OverParticipants:
    """Compare training lengths, residuals and baselines over participants, and look for sub-groups of responders."""
    reductions = residual_reductions(responses)
    responders, verdict = responder_table(responses, seed)
    return OverParticipants(
        lengths=compare_lengths(quantities),
        reductions=reductions,
        reduction_tests=compare_reductions(reductions),
        baselines=compare_baselines(responses),
        responders=responders,
        lengths_said=too_few(len(quantities)) if 0 < len(quantities) < FEWEST else "",
        responders_said=verdict,
    )


def compare_models(responses: Sequence[ParticipantResponse]) -> PairTests:
    """Compare Nominal, Augmented and Exo by their R2 on held-out device walking, in pairs, and Exo with R2 = 1.

    responses: the participants; fewer than six are not tested, and the result says why
    Source: Ebers 2023, section 4.2.3: Wilcoxon signed-rank tests, Holm-Sidak step-down corrections, alpha = 0.05. The
        family is not said; all variables of a pair is the reading that gives the printed 0.013 and 0.042. Beside the
        source: other families, effect sizes, intervals. That Exo is below R2 = 1 no measurement can contradict, for R2
        is never above 1: its p is the smallest that n allows, and only the shift is of interest.
    """
    models = {model: r2_by_participant(responses, model) for model in ("nominal", "augmented", "exo")}
    models["perfect"] = models["exo"].where(models["exo"].isna(), 1.0)
    if len(responses) < FEWEST:
        empty = join_rows("tests"), join_rows("families")
        return PairTests(len(responses), ALPHA, LEVEL, too_few(len(responses)), *empty)
    tests = [compare_columns(models[a], models[b]).assign(first=a, second=b) for a, b in PAIRS]
    joined = join_rows("tests", tests)
    return PairTests(len(responses), ALPHA, LEVEL, "", joined, by_family(joined))


def compare_columns(first: pd.DataFrame, second: pd.DataFrame, alpha: float = ALPHA) -> pd.DataFrame:
    """Test second against first in every column, participants paired, corrected over the columns.

    first, second DataFrame (participant, variable): with the same participants and variables; NaN where a number was
        not computed
    returns: one row a variable, the columns of `PairTests.tests` but first and second. A variable that fewer than six
        participants have is in the table, but not tested and not of the family
    """
    table = pd.DataFrame([_row(variable, first[variable], second[variable]) for variable in first.columns])
    tested = table["p"].notna().to_numpy()
    table["tests"] = int(tested.sum())
    table["step_level"], table["p_adjusted"], table["different"] = np.nan, np.nan, False
    if tested.any():
        corrected = holm_sidak(table.loc[tested, "p"].to_numpy(), alpha)
        table.loc[tested, "step_level"] = corrected.level
        table.loc[tested, "p_adjusted"] = corrected.adjusted
        table.loc[tested, "different"] = corrected.rejected
    return table


def by_family(tests: pd.DataFrame) -> pd.DataFrame:
    """Tests (first, second, variable, p) of three pairs corrected under every family meant: `FAMILY_COLUMNS`."""
    chosen = tests[tests["p"].notna() & (tests["second"] != "perfect")]
    families = {"pair": ["first", "second"], "all": np.zeros(len(chosen)), "variable": "variable"}
    tables = []
    for name in FAMILIES:
        for _, rows in chosen.groupby(families[name], sort=False):
            corrected = holm_sidak(rows["p"], ALPHA)
            tables.append(
                rows[["first", "second", "variable"]].assign(
                    family=name,
                    tests=len(rows),
                    critical=corrected.critical,
                    step_level=corrected.level,
                    p_adjusted=corrected.adjusted,
                    different=corrected.rejected,
                )
            )
    return join_rows("families", tables)


def r2_by_participant(responses: Sequence[ParticipantResponse], model: str, kind: str = "network") -> pd.DataFrame:
    """R2 on held-out device walking, (participant, variable); NaN where it was not computed."""
    variables = dict.fromkeys(name for response in responses for name in response.outputs)
    rows = {r.participant: {v: r.r2_of(v, model, kind) for v in r.outputs} for r in responses}
    return pd.DataFrame.from_dict(rows, orient="index", columns=list(variables), dtype=float)


def too_few(participants: int) -> str:
    """Why so few participants are not tested.

    >>> too_few(5)
    '5 participants are too few for a test: the smallest possible p is 0.0625, not below 0.05 even if all agree'
    """
    if participants < 2:
        return "One participant is not enough for a test" if participants else "There is no participant to test"
    return (
        f"{participants} participants are too few for a test: the smallest possible p is "
        f"{smallest_p(participants):g}, not below {ALPHA:g} even if all agree"
    )


def _row(variable: str, first: pd.Series, second: pd.Series) -> Mapping[str, object]:
    known = np.isfinite(first.to_numpy(float)) & np.isfinite(second.to_numpy(float))
    names = {int(place): str(first.index[place]) for place in np.flatnonzero(~known).tolist()}
    left_out = f"not computed: {', '.join(names.values())}" if names else ""
    row: dict[str, object] = {"variable": variable, "left_out": left_out}
    if known.sum() < FEWEST:
        return row | {"n": int(known.sum()), "zeros": 0, "ties": False} | dict.fromkeys(TESTED, np.nan)
    test = signed_rank(first.to_numpy(), second.to_numpy(), names, LEVEL)
    medians = float(first[known].median()), float(second[known].median())
    tested = (test.w, test.p, *medians, test.median, test.shift, test.low, test.high, test.rank_biserial)
    return row | {"n": test.n, "zeros": test.zeros, "ties": test.ties} | dict(zip(TESTED, tested, strict=True))
