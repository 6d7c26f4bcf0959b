"""What is lost without a family of inputs: fall of R2 by family, for angles and for EMG."""

from __future__ import annotations

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import MODELS
from gaitdisc.report.panels import Room, in_style, legend, panels
from gaitdisc.report.table import Table
from gaitdisc.report.wording import MODEL_WORDS, counted, label, listed, number
from gaitdisc.results.variants import VariantRun

ALL = "all inputs"
GROUPS = {"angles": "joint angles predicted", "EMG": "EMG predicted"}
SHOWN = ("augmented", "exo")
ROW = 0.19  # inch
FARTHEST = 1.0  # a fall beyond it is drawn at the edge


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
        own = numbers[numbers["variables"] == group]
        for model, offset in zip(SHOWN, (-0.17, 0.17), strict=True):
            look = MODELS[model]
            for place, family in enumerate(families):
                values = own.loc[(own["without"] == family) & (own["model"] == model), "fall"].to_numpy()
                values = np.minimum(values, FARTHEST)
                axes.plot(values, np.full(len(values), place + offset), look.mark, color=look.colour, ms=2, alpha=0.45)
                axes.plot(np.median(values), place + offset, look.mark, color=look.colour, ms=5)
        axes.axvline(0, color="#444444", linewidth=0.7, zorder=0)
        axes.set_yticks(range(len(families)), [family_words(name) for name in families] if axes is row[0] else [])
        axes.set_ylim(len(families) - 0.4, -0.6)
        axes.set_xscale("symlog", linthresh=0.01)
        axes.set_xlim(min(-0.02, float(own["fall"].min()) * 1.1), FARTHEST)
        ticks = [tick for tick in (-0.1, -0.01, 0.0, 0.01, 0.1, 1.0) if axes.get_xlim()[0] <= tick]
        axes.set_xticks(ticks, [f"{tick:g}".replace("-", "\u2212") for tick in ticks])
        axes.minorticks_off()
        axes.set_xlabel("fall of R² [1]")
        axes.set_title(GROUPS[group])
    legend(drawn, _key())
    return Figure("modalities", _caption(run), _alt(numbers), numbers, drawn)


def falls(run: VariantRun) -> pd.DataFrame:
    """Fall of R2 without each family of inputs, median over the variables of a group; networks only.

    returns: variables (`angles` or `EMG`), without, model, participant, fall
    """
    table = run.r2_table()
    table = table[table["kind"] == "network"]
    table = table.assign(variables=np.where(table["variable"].str.startswith("emg_"), "EMG", "angles"))
    keys = ["variables", "model", "participant", "variable"]
    whole = table[table["variant"] == ALL].set_index(keys)["r2"]
    others = table[table["variant"] != ALL]
    fall = whole.reindex(pd.MultiIndex.from_frame(others[keys])).to_numpy() - others["r2"].to_numpy()
    grouped = others.assign(fall=fall).groupby(["variables", "variant", "model", "participant"], sort=False)["fall"]
    return grouped.median().reset_index().rename(columns={"variant": "without"})


def modalities_table(run: VariantRun) -> Table:
    """Shift of R2 of the Augmented model without each family, by variable; a star where it is shown to differ."""
    own = run.tests[run.tests["model"] == "augmented"]
    variables = list(dict.fromkeys(own["variable"]))
    rows = []
    for family, tested in own.groupby("variant", sort=False):
        shifts = dict(zip(tested["variable"], tested["shift"].to_numpy(float), strict=True))
        stars = dict(zip(tested["variable"], tested["different"].to_numpy(bool), strict=True))
        shown = [number(shifts[name], 3) + ("*" if stars[name] else "") for name in variables]
        rows.append((family_words(str(family)), *shown))
    caption = (
        f"Hodges-Lehmann shift of R² [1] of the Augmented model on the held-out device walk ({run.exo}) when the "
        f"Discrepancy model lacks a family of inputs, n = {counted(len(run.people), 'participant')}; negative: "
        "R² falls. Star: exact two-sided signed rank test, Holm-Sidak over the variables of a row, alpha = 0.05. The "
        "CSV has both models, W, p, adjusted p and intervals."
    )
    return Table("modalities", caption, ("without", *map(label, variables)), tuple(rows), run.tests)


def modalities_sentences(run: VariantRun) -> tuple[str, ...]:
    """What the others cannot replace, and what the numbers cannot say."""
    numbers = falls(run)
    if not len(numbers):
        return ("Nobody's models could be fitted.",)
    said = []
    for group, words in (("angles", "joint angles"), ("EMG", "EMG")):
        own = numbers[(numbers["variables"] == group) & (numbers["model"] == "augmented")]
        if not len(own):
            continue
        middle = own.groupby("without", sort=False)["fall"].median().sort_values(ascending=False, kind="stable")
        most = [
            f"{family_words(str(name))} ({number(fall, 3)})"
            for name, fall in zip(middle.index[:3], middle.to_numpy(float), strict=False)
        ]
        said.append(f"Of {words}, the Augmented model loses most R² (medians) without {listed(most)}.")
    said.append(
        "A fall says what the other inputs cannot replace. Joint angles and EMG of one walk go together, so a family "
        "whose absence costs nothing may carry the response as well as those that stand in for it; the falls of two "
        "families do not add up."
    )
    return tuple(said)


def family_words(family: str) -> str:
    """Name of a family of inputs as it is read.

    >>> family_words("emg_sol"), family_words("knee_angle"), family_words("EMG velocities")
    ('EMG soleus', 'knee angle', 'EMG velocities')
    """
    return label(f"{family}_r").removesuffix(", right") if "_" in family else family


def _key() -> list:
    from matplotlib.lines import Line2D

    looks = [(MODEL_WORDS[model], MODELS[model]) for model in SHOWN]
    return [
        Line2D([], [], color=look.colour, marker=look.mark, linestyle="", ms=5, label=f"{word}, median")
        for word, look in looks
    ]


def _caption(run: VariantRun) -> str:
    low, high = run.held_out_s
    held = f"{low:.1f}" + (f" to {high:.1f}" if high - low >= 0.05 else "")
    return (
        f"Fall of R² [1] on the held-out device walk ({run.exo}) when a family of inputs (both sides; a joint or "
        f"muscle with its velocity) is left away, median over variables; n = "
        f"{counted(len(run.people), 'participant')}; split: last {held} s of the walk held out. Augmented: only the "
        "Discrepancy model lacks the inputs. Small marks: participants. Linear within 0.01, logarithmic beyond. "
        "Networks only. For section 6.2.2 of the dissertation."
    )


def _alt(numbers: pd.DataFrame) -> str:
    own = numbers[numbers["model"] == "augmented"].groupby("without", sort=False)["fall"].median()
    return f"Fall of R² without each of {len(own)} families of inputs; the largest is without {own.idxmax()}."
