"""A page for a question beside the study: which inputs carry the response, or does a cut-off decide it."""

from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure, save_figures
from gaitdisc.report.page import write_page
from gaitdisc.report.panels import MODELS, Room, in_style, legend, legend_lines, panels
from gaitdisc.report.table import Table, save_table, save_tables
from gaitdisc.response.r2_tables import grouped_variables
from gaitdisc.response.variants import ALL, VariantRun
from gaitdisc.words import MODEL_WORDS, counted, label, listing, number

GROUPS = {"angles": "joint angles predicted", "EMG": "EMG predicted"}
SHOWN = ("augmented", "exo")
ROW = 0.19  # inch
FARTHEST = 1.0  # a fall beyond it is drawn at the edge
HEADINGS = ("Nominal", "Augmented", "Exo", "null")
TITLES = {"modalities": "Effect of the inputs", "sensitivity": "Other cut-offs and training lengths"}


@in_style
def modalities_figure(run: VariantRun) -> Figure | None:
    """Fall of R2, median over the variables of a group, by family of inputs; None where nobody has numbers."""
    numbers = falls(run)
    if not len(numbers):
        return None
    groups = [group for group in GROUPS if group in set(numbers["variables"])]
    families = list(dict.fromkeys(numbers["without"]))
    drawn, [row] = panels(1, len(groups), ROW * (len(families) + 1), Room(left=2.0, bottom=0.5))
    for axes, group in zip(row, groups, strict=True):
        of_group = numbers[numbers["variables"] == group]
        for model, offset in zip(SHOWN, (-0.17, 0.17), strict=True):
            look = MODELS[model]
            for place, family in enumerate(families):
                values = of_group.loc[(of_group["without"] == family) & (of_group["model"] == model), "fall"].to_numpy()
                values = np.minimum(values, FARTHEST)
                axes.plot(values, np.full(len(values), place + offset), look.mark, color=look.colour, ms=2, alpha=0.45)
                axes.plot(np.median(values), place + offset, look.mark, color=look.colour, ms=5)
        axes.axvline(0, color="#444444", linewidth=0.7, zorder=0)
        axes.set_yticks(range(len(families)), [family_words(name) for name in families] if axes is row[0] else [])
        axes.set_ylim(len(families) - 0.4, -0.6)
        axes.set_xscale("symlog", linthresh=0.01)
        axes.set_xlim(min(-0.02, float(of_group["fall"].min()) * 1.1), FARTHEST)
        ticks = [tick for tick in (-0.1, -0.01, 0.0, 0.01, 0.1, 1.0) if axes.get_xlim()[0] <= tick]
        axes.set_xticks(ticks, [f"{tick:g}".replace("-", "\u2212") for tick in ticks])
        axes.minorticks_off()
        axes.set_xlabel("fall of R² [1]")
        axes.set_title(GROUPS[group])
    looks = {f"{MODEL_WORDS[model]}, median": MODELS[model] for model in SHOWN}
    mark = {"linestyle": "", "ms": 5}
    legend(drawn, legend_lines({w: {"color": k.colour, "marker": k.mark, **mark} for w, k in looks.items()}))
    low, high = run.held_out_s
    held = f"{low:.1f}" + (f" to {high:.1f}" if high - low >= 0.05 else "")
    caption = (
        f"Fall of R² [1] on the held-out device walk ({run.exo}) when a family of inputs (both sides; a joint or "
        "muscle with its velocity) is left out, median over variables; n = "
        f"{counted(len(run.people), 'participant')}; split: last {held} s of the walk held out. Augmented: only the "
        "Discrepancy model lacks the inputs. Small marks: participants. The axis is linear within 0.01 and logarithmic "
        "beyond. Networks only. For section 6.2.2 of the dissertation."
    )
    most = numbers[numbers["model"] == "augmented"].groupby("without", sort=False)["fall"].median()
    alt = f"Fall of R² without each of {len(most)} families of inputs; the largest fall is without {most.idxmax()}."
    return Figure("modalities", caption, alt, numbers, drawn)


def falls(run: VariantRun) -> pd.DataFrame:
    """Variables (`angles` or `EMG`), family left out, network, participant, median fall of R2 over the variables."""
    table = grouped_variables(run.r2_table())
    table = table[table["kind"] == "network"]
    keys = ["variables", "model", "participant", "variable"]
    full = table[table["variant"] == ALL].set_index(keys)["r2"]
    others = table[table["variant"] != ALL]
    fall = full.reindex(pd.MultiIndex.from_frame(others[keys])).to_numpy() - others["r2"].to_numpy()
    grouped = others.assign(fall=fall).groupby(["variables", "variant", "model", "participant"], sort=False)["fall"]
    return grouped.median().reset_index().rename(columns={"variant": "without"})


def modalities_table(run: VariantRun) -> Table:
    """Shift of R2 of the Augmented model without each family, by variable; a star where it is shown to differ."""
    tests = run.tests[run.tests["model"] == "augmented"]
    cells = [number(float(str(row.shift)), 3) + ("*" if row.different else "") for row in tests.itertuples()]
    shown = tests.assign(cell=cells).pivot_table("cell", "variant", "variable", aggfunc="first", sort=False)
    rows = tuple((family_words(str(family)), *row) for family, row in zip(shown.index, shown.to_numpy(), strict=True))
    caption = (
        f"Hodges-Lehmann shift of R² [1] of the Augmented model on the held-out device walk ({run.exo}) when the "
        f"Discrepancy model lacks a family of inputs, n = {counted(len(run.people), 'participant')}; negative: R² "
        "falls. Star: exact two-sided signed-rank test, Holm-Sidak over the variables of a row, alpha = 0.05. The CSV "
        "contains both models, W, p, adjusted p and intervals."
    )
    return Table("modalities", caption, ("without", *map(label, shown.columns)), rows, run.tests)


def modalities_sentences(run: VariantRun) -> tuple[str, ...]:
    """What the others cannot replace, and what the numbers cannot say."""
    numbers = falls(run)
    if not len(numbers):
        return ("No participant's models could be fitted.",)
    sentences = []
    for group, words in (("angles", "joint angles"), ("EMG", "EMG")):
        of_group = numbers[(numbers["variables"] == group) & (numbers["model"] == "augmented")]
        if not len(of_group):
            continue
        middle = of_group.groupby("without", sort=False)["fall"].median().sort_values(ascending=False, kind="stable")
        most = [f"{family_words(str(name))} ({number(fall, 3)})" for name, fall in middle.head(3).items()]
        sentences.append(f"Among {words}, the Augmented model loses most R² (medians) without {listing(most)}.")
    sentences.append(
        "A fall of R² shows information that the other inputs cannot replace. Joint angles and EMG of one walk are "
        "correlated, so an input family may be informative even if R² does not fall without it. The falls of two "
        "families do not add up."
    )
    return tuple(sentences)


def family_words(family: str) -> str:
    """Name of a family of inputs as it is read.

    >>> family_words("emg_sol"), family_words("knee_angle"), family_words("EMG velocities")
    ('EMG soleus', 'knee angle', 'EMG velocities')
    """
    return label(f"{family}_r").removesuffix(", right") if "_" in family else family


def setting_medians(run: VariantRun) -> pd.DataFrame:
    """Medians over participants of medians over variables, by setting, group of variables and model."""
    columns = {
        ("nominal", "network"): "nominal",
        ("augmented", "network"): "augmented",
        ("exo", "network"): "exo",
        ("augmented", "ridge"): "ridge_augmented",
        ("nominal", "null"): "null",
    }
    table = grouped_variables(run.r2_table())
    table["column"] = [columns.get(key, "") for key in zip(table["model"], table["kind"], strict=True)]
    people = table.pivot_table(
        "r2", ["variant", "variables", "participant"], "column", aggfunc="median", sort=False
    ).reindex(columns=list(columns.values()))
    over = people.groupby(level=["variant", "variables"], sort=False)
    return over.median().assign(participants=over.size()).rename_axis(columns=None).reset_index()


def orders(run: VariantRun) -> pd.DataFrame:
    """By variant: how many participants have Nominal < Augmented; in how many variables the two are shown to differ."""
    table = run.r2_table()
    table = table[table["kind"] == "network"]
    middle = table.pivot_table(
        index=["variant", "participant"], columns="model", values="r2", aggfunc="median", sort=False
    )
    holds = (middle["nominal"] < middle["augmented"]).groupby(level="variant", sort=False)
    counts = holds.agg(participants="count", holds="sum")
    higher = run.tests[run.tests["different"].astype(bool) & (run.tests["shift"] > 0)]
    counts["variables"] = table["variable"].nunique()
    counts["different"] = higher.groupby("variant").size().reindex(counts.index).fillna(0) if len(run.tests) else np.nan
    return counts.reset_index()


def sensitivity_table(run: VariantRun) -> Table:
    """Medians under every setting, and whether Nominal < Augmented holds."""
    medians, held = setting_medians(run), orders(run)
    groups = [group for group in GROUPS if group in set(medians["variables"])]
    rows = []
    for setting in held.itertuples():
        of_setting = medians[medians["variant"] == setting.variant].set_index("variables").reindex(groups)
        cells = of_setting[["nominal", "augmented", "exo", "null"]].to_numpy(float).ravel()
        people = f"{setting.holds} of {setting.participants}"
        tested = f"{setting.different:.0f} of {setting.variables}" if len(run.tests) else "not tested"
        rows.append((str(setting.variant), *map(number, cells), people, tested))
    caption = (
        f"R² [1] on the held-out device walk ({run.exo}), medians over participants of medians over variables, n = "
        f"{counted(len(run.people), 'participant')}; one setting changed at a time. R² of two settings refer to "
        "different targets, because the filter changes the predicted signal: compare the models, and each with its "
        "null. People: number of people with Nominal < Augmented in the median over variables; variables: number of "
        "variables with a significantly higher Augmented model (exact signed-rank test, Holm-Sidak over the variables "
        "of a setting, alpha = 0.05)."
    )
    heads = (("", 1), *((group, len(HEADINGS)) for group in groups), ("Nominal < Augmented", 2))
    columns = ("setting", *(HEADINGS * len(groups)), "people", "variables")
    numbers = medians.merge(held.drop(columns=["participants", "variables"]), on="variant")
    return Table("sensitivity", caption, columns, tuple(rows), numbers, heads)


def sensitivity_sentences(run: VariantRun) -> tuple[str, ...]:
    """Whether the order of the models holds under every setting, and what was left away."""
    if not run.people:
        return ("No participant's models could be fitted.",)
    medians = setting_medians(run)
    failing = medians[~(medians["nominal"] < medians["augmented"])]
    cases = counted(len(medians), "case")
    sentences = [
        f"In the medians, Nominal < Augmented holds in all {cases} (each a setting and a group of variables)."
        if not len(failing)
        else f"In the medians, Nominal < Augmented fails in {len(failing)} of {cases}: "
        + ", ".join(f"{row.variant} ({row.variables})" for row in failing.itertuples())
        + "."
    ]
    low = medians[medians["augmented"] <= medians["null"]]
    if len(low):
        where = ", ".join(f"{row.variant} ({row.variables})" for row in low.itertuples())
        sentences.append(f"The Augmented model does not exceed band-limited noise with the same filters in: {where}.")
    lost = sorted({name for person in run.people for name in person.left_away})
    for name in lost:
        people = [person for person in run.people if name in person.left_away]
        who, why = ", ".join(person.participant for person in people), people[0].left_away[name]
        sentences.append(f"{name} is left out for {who}: {why}")
    return tuple(sentences)


def write_variants(run: VariantRun, folder: Path) -> Path:
    """Write `report.html`, `figures/` and `tables/` of one question; the same bytes for the same run."""
    figure = modalities_figure(run) if run.question == "modalities" else None
    tables = variant_tables(run)
    save_tables(tables, folder)
    save_table(run.r2_table(), folder / "tables" / "r2.csv")
    shown = {
        "run": run,
        "heading": TITLES[run.question],
        "sentences": variant_sentences(run),
        "figures": save_figures([figure] if figure else [], folder),
        "tables": tables,
    }
    return write_page("variants", shown, folder)


def variant_tables(run: VariantRun) -> list[Table]:
    """Tables of a question; none where nobody has numbers."""
    if not run.people:
        return []
    if run.question == "sensitivity":
        return [sensitivity_table(run)]
    return [modalities_table(run)] if len(run.tests) else []


def variant_sentences(run: VariantRun) -> tuple[str, ...]:
    """Sentences of a question."""
    return modalities_sentences(run) if run.question == "modalities" else sensitivity_sentences(run)
