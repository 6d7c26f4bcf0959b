"""R2 of the models under other cut-offs and training lengths, and whether their order holds."""

from __future__ import annotations

import numpy as np
import pandas as pd

from gaitdisc.report.table import Table
from gaitdisc.report.wording import counted, number
from gaitdisc.results.variants import VariantRun

HEADINGS = ("Nominal", "Augmented", "Exo", "null")


def setting_medians(run: VariantRun) -> pd.DataFrame:
    """Median over participants of the median over variables, for each setting, group of variables and model.

    returns: variant, variables (`angles`, `EMG`), participants, and a column for each of Nominal, Augmented, Exo, the
        ridge regression's Augmented and the null
    """
    table = run.r2_table()
    table = table.assign(variables=np.where(table["variable"].str.startswith("emg_"), "EMG", "angles"))
    keys = ["variant", "variables", "model", "kind"]
    people = table.groupby([*keys, "participant"], sort=False)["r2"].median().reset_index()
    over = people.pivot_table(index=keys[:2], columns=keys[2:], values="r2", aggfunc="median", sort=False)
    count = people.groupby(keys[:2], sort=False)["participant"].nunique()
    wanted = {
        "nominal": ("nominal", "network"),
        "augmented": ("augmented", "network"),
        "exo": ("exo", "network"),
        "ridge_augmented": ("augmented", "ridge"),
        "null": ("nominal", "null"),
    }
    found = pd.DataFrame(
        {name: over[key] if key in over.columns else np.nan for name, key in wanted.items()}, index=over.index
    )
    return found.assign(participants=count.reindex(found.index)).reset_index()


def orders(run: VariantRun) -> pd.DataFrame:
    """In how many participants Nominal < Augmented holds, and in how many variables the two are shown to differ.

    returns: variant, participants, holds, variables, different (NaN where nothing was tested)
    """
    table = run.r2_table()
    table = table[table["kind"] == "network"]
    middle = table.pivot_table(
        index=["variant", "participant"], columns="model", values="r2", aggfunc="median", sort=False
    )
    holds = (middle["nominal"] < middle["augmented"]).groupby(level="variant", sort=False)
    found = holds.agg(participants="count", holds="sum")
    higher = run.tests[run.tests["different"].astype(bool) & (run.tests["shift"] > 0)]
    found["variables"] = table["variable"].nunique()
    found["different"] = higher.groupby("variant").size().reindex(found.index).fillna(0) if len(run.tests) else np.nan
    return found.reset_index()


def sensitivity_table(run: VariantRun) -> Table:
    """Medians under every setting, and whether Nominal < Augmented holds."""
    medians, held = setting_medians(run), orders(run)
    counts = held[["holds", "participants", "different", "variables"]].to_numpy(float)
    order = dict(zip(held["variant"].astype(str), counts, strict=True))
    groups = [group for group in ("angles", "EMG") if group in set(medians["variables"])]
    rows = []
    for variant, own in medians.groupby("variant", sort=False):
        cells = [
            number(float(own.loc[own["variables"] == group, column].median()))
            for group in groups
            for column in ("nominal", "augmented", "exo", "null")
        ]
        holds, people, different, variables = order[str(variant)]
        shown = "not tested" if np.isnan(different) else f"{different:.0f} of {variables:.0f}"
        rows.append((str(variant), *cells, f"{holds:.0f} of {people:.0f}", shown))
    caption = (
        f"R² [1] on the held-out device walk ({run.exo}), medians over participants of medians over variables, "
        f"n = {counted(len(run.people), 'participant')}; one setting changed at a time. R² of two settings are not of "
        "the same thing, for the filter makes what is predicted as well: compare the models, and each with its null. "
        "People: in whom Nominal < Augmented in the median over variables; variables: in which Augmented is shown to "
        "be higher (exact signed rank, Holm-Sidak over the variables of a setting, alpha = 0.05)."
    )
    heads = (("", 1), *((group, len(HEADINGS)) for group in groups), ("Nominal < Augmented", 2))
    columns = ("setting", *(HEADINGS * len(groups)), "people", "variables")
    return Table(
        "sensitivity",
        caption,
        columns,
        tuple(rows),
        medians.merge(held.drop(columns=["participants", "variables"]), on="variant"),
        heads,
    )


def sensitivity_sentences(run: VariantRun) -> tuple[str, ...]:
    """Whether the order of the models holds under every setting, and what was left away."""
    if not run.people:
        return ("Nobody's models could be fitted.",)
    medians = setting_medians(run)
    failing = medians[~(medians["nominal"] < medians["augmented"])]
    cases = counted(len(medians), "case")
    said = [
        f"In the medians, Nominal < Augmented holds in all of {cases} (a setting and a group of variables)."
        if not len(failing)
        else f"In the medians, Nominal < Augmented fails in {len(failing)} of {cases}: "
        + ", ".join(f"{row.variant} ({row.variables})" for row in failing.itertuples())
        + "."
    ]
    low = medians[medians["augmented"] <= medians["null"]]
    if len(low):
        where = ", ".join(f"{row.variant} ({row.variables})" for row in low.itertuples())
        said.append(f"Augmented does not rise above what noise reaches through the same filters in: {where}.")
    lost = sorted({name for each in run.people for name in each.left_away})
    for name in lost:
        whom = [each for each in run.people if name in each.left_away]
        who, why = ", ".join(each.participant for each in whom), whom[0].left_away[name]
        said.append(f"{name} is left away for {who}: {why}")
    return tuple(said)
