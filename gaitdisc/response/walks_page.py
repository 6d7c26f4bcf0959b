"""Walks of a run: every stride, kept or dropped, and how long it lasted; what was found, and who is left out."""

from __future__ import annotations

import re
import string
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.processing.curves_figure import WALKS, find_walk
from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import DROPPED, KEPT, SIDES, Room, in_style, legend, legend_lines, panels
from gaitdisc.report.table import Table
from gaitdisc.response.participant_response import FIT_COLUMNS, ResponseRun
from gaitdisc.response.participants_result import table_of_people
from gaitdisc.words import LIGHTS, MODEL_WORDS, SIDE_WORDS, counted, listing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMNS = ("participant", "condition", "side", "start_s", "end_s", "duration_s", "kept", "code", "reason")
_HEIGHTS = {"r": 1.0, "l": 0.0, "": 0.5}


def stride_numbers(run: ResponseRun, participant: str) -> pd.DataFrame:
    """Every stride with its duration in order of time, and a letter for the kind of reason that dropped it."""
    walks = [find_walk(run, participant, walk) for walk in WALKS]
    tables = [
        walk.strides.assign(participant=walk.subject, condition=walk.condition) for walk in walks if walk is not None
    ]
    if not tables:
        return pd.DataFrame(columns=pd.Index(COLUMNS))
    table = pd.concat(tables, ignore_index=True)
    table["duration_s"] = table["end_s"] - table["start_s"]
    table["kept"] = table["kept"].astype(bool)
    table["reason"] = table["reason"].fillna("").astype(str).where(~table["kept"], "")
    kinds = list(dict.fromkeys(table.loc[~table["kept"], "reason"].map(reason_kind)))
    letters = string.ascii_uppercase
    codes = {kind: (letters[i // 26 - 1] if i >= 26 else "") + letters[i % 26] for i, kind in enumerate(kinds)}
    table["code"] = [("" if kept else codes[reason_kind(r)]) for kept, r in zip(table["kept"], table["reason"])]  # noqa: B905
    return table[list(COLUMNS)]


def reason_kind(reason: str) -> str:
    """Kind of a reason: its words without its numbers, so that like reasons are counted together.

    >>> reason_kind("lasts 1.62 s, the median is 1.08 s")
    'lasts … s, the median is … s'
    """
    return re.sub(r"[-−+]?\d+(?:\.\d+)?", "…", reason) or "no reason was given"


@in_style
def strides_figure(run: ResponseRun, participant: str, name: str) -> Figure | None:
    """Every stride as a bar, and stride durations over time, for each walk; None where there is no stride."""
    from matplotlib.patches import Patch

    numbers = stride_numbers(run, participant)
    if not len(numbers):
        return None
    groups = list(numbers.groupby("condition", sort=False))
    drawn, grid = panels(2 * len(groups), 1, 0.62, Room(down=0.42))
    for index, (condition, strides) in enumerate(groups):
        strip, durations = grid[2 * index][0], grid[2 * index + 1][0]
        walk = next(w for w in run.walks if (w.subject, w.condition) == (participant, condition))
        _draw_strip(strip, strides)
        strip.set_title(f"{condition}: every stride (contacts by {walk.detector})", loc="left")
        _draw_durations(durations, strides)
        for axes in (strip, durations):
            axes.set_xlim(0, max(walk.duration_s, float(strides["end_s"].max())))
        strip.tick_params(labelbottom=False)
    grid[-1][0].set_xlabel("time in the trial [s]")
    looks = {"left": SIDES["l"], "right": SIDES["r"], "dropped": DROPPED}
    marks = {
        words: {"marker": look.mark, "color": look.colour, "linestyle": "", "ms": 4} for words, look in looks.items()
    }
    bars = {"kept": KEPT, "dropped, with the letter of its reason": DROPPED}
    legend(drawn, [*(Patch(facecolor=look.colour, label=words) for words, look in bars.items()), *legend_lines(marks)])
    counts = [
        f"{condition}: {int(rows['kept'].sum())} of {len(rows)} strides kept, median duration "
        f"{rows['duration_s'].median():.2f} s"
        for condition, rows in groups
    ]
    alt = f"Strides of {participant}. {listing(counts)}."
    return Figure(f"strides-{name}", _caption(participant, numbers), alt, numbers, drawn)


def _draw_strip(axes: Axes, strides: pd.DataFrame) -> None:
    for side, rows in strides.groupby("side"):
        middle = _HEIGHTS.get(str(side), 0.5)
        kept, dropped = rows[rows["kept"]], rows[~rows["kept"]]
        for chosen, look, half in ((kept, KEPT, 0.26), (dropped, DROPPED, 0.40)):
            spans = list(zip(chosen["start_s"], chosen["duration_s"], strict=True))
            axes.broken_barh(spans, (middle - half, 2 * half), facecolor=look.colour, edgecolor="white", linewidth=0.5)
        for start, length, code in zip(dropped["start_s"], dropped["duration_s"], dropped["code"], strict=True):
            axes.text(
                start + length / 2, middle, code, color="white", ha="center", va="center", fontsize=6, clip_on=True
            )
    present = [side for side in _HEIGHTS if side in set(strides["side"])]
    axes.set_yticks([_HEIGHTS[side] for side in present], [SIDE_WORDS[side] or "stride" for side in present])
    for tick, side in zip(axes.get_yticklabels(), present, strict=True):
        tick.set_color(SIDES[side].colour)
    axes.set_ylim(-0.55, 1.55)


def _draw_durations(axes: Axes, strides: pd.DataFrame) -> None:
    kept, dropped = strides[strides["kept"]], strides[~strides["kept"]]
    for side, rows in kept.groupby("side"):
        look = SIDES[str(side)]
        axes.plot(rows["start_s"], rows["duration_s"], look.mark, color=look.colour, ms=3.4, mew=0, alpha=0.8)
    axes.plot(dropped["start_s"], dropped["duration_s"], DROPPED.mark, color=DROPPED.colour, ms=4, mew=1.0)
    axes.set_ylabel("duration [s]")
    middle = float(strides["duration_s"].median())
    reach = max(1.15 * float(np.abs(strides["duration_s"] - middle).max()), 0.05 * middle)
    axes.set_ylim(max(0.0, middle - reach), middle + reach)


def _caption(participant: str, numbers: pd.DataFrame) -> str:
    counts = [
        f"{counted(len(rows), 'stride')} ({condition}: {int(rows['kept'].sum())} kept, {int((~rows['kept']).sum())} "
        "dropped)"
        for condition, rows in numbers.groupby("condition", sort=False)
    ]
    return (
        f"{participant}: every stride of each walk, from initial contact to the next of the same foot, n = "
        f"{' and '.join(counts)}; entire walks, not split. Light bars: kept; black, taller bars: dropped, with the "
        "letter of its reason in the table below. Under each strip: duration of every stride [s] over time. Red "
        "triangles: left; blue discs: right; crosses: dropped."
    )


def walks_table(run: ResponseRun) -> Table:
    """Every walk with its light, its strides and what found them."""
    rows, records = [], []
    for walk in run.walks:
        colour, word = LIGHTS[walk.worst]
        kept, dropped = walk.counted(True), walk.counted(False)
        sides = sorted({*kept, *dropped}, reverse=True)
        strides = "; ".join(f"{SIDE_WORDS.get(s, s) or 'all'} {kept.get(s, 0)} / {dropped.get(s, 0)}" for s in sides)
        rows.append((
            f"light:{colour}:{word}", walk.subject, walk.condition, f"{walk.duration_s:.1f}", f"{walk.rate_hz:g}",
            walk.detector, strides or "none", str(len(walk.findings)),
        ))  # fmt: skip
        records.append({
            "participant": walk.subject, "condition": walk.condition, "light": colour, "worst": walk.worst,
            "duration_s": walk.duration_s, "rate_hz": walk.rate_hz, "detector": walk.detector,
            **{f"kept_{s or 'all'}": kept.get(s, 0) for s in sides},
            **{f"dropped_{s or 'all'}": dropped.get(s, 0) for s in sides},
            "findings": len(walk.findings),
        })  # fmt: skip
    columns = (
        "quality", "participant", "walk", "length [s]", "rate [Hz]", "contacts by", "strides kept / dropped",
        "findings",
    )  # fmt: skip
    caption = (
        f"Processed walks, n = {len(run.walks)}. Green: no findings, or notes only; amber: warnings (some samples or "
        "channels are affected); red: the trial is refused."
    )
    return Table("walks", caption, columns, tuple(rows), pd.DataFrame(records))


def tabulate_dropped(run: ResponseRun, participant: str, name: str) -> Table | None:
    """Dropped strides of a participant counted by kind of reason, or None where none was dropped."""
    strides = stride_numbers(run, participant)
    dropped = strides[~strides["kept"].astype(bool)]
    if not len(dropped):
        return None
    rows = []
    for (code, condition, side), chosen in dropped.groupby(["code", "condition", "side"], sort=False):
        rows.append((
            str(code), str(condition), SIDE_WORDS.get(str(side), str(side)), str(len(chosen)),
            reason_kind(str(chosen["reason"].iloc[0])), str(chosen["reason"].iloc[0]),
        ))  # fmt: skip
    rows.sort()
    caption = f"{participant}: dropped strides by reason, n = {len(dropped)} of {len(strides)}."
    columns = ("letter", "walk", "side", "strides", "kind of reason", "first example")
    return Table(f"dropped-{name}", caption, columns, tuple(rows), dropped)


def fits_table(run: ResponseRun) -> Table:
    """What was fitted, on how much, with which decay, in how long."""
    numbers = table_of_people(run.responses, "fits", FIT_COLUMNS)
    rows = [
        (str(row.participant), MODEL_WORDS.get(str(row.model), str(row.model)), str(row.kind), f"{row.decay:g}",
         f"{row.epochs:.0f}", f"{row.n_training:.0f}", f"{row.n_inner:.0f}")
        for row in numbers.itertuples(index=False)
    ]  # fmt: skip
    headings = ("participant", "model", "kind", "decay chosen", "epochs", "training samples", "inner samples")
    caption = (
        f"Fits, n = {len(rows)}; decay: strength of the regularisation, chosen on inner samples, which are the "
        "contiguous last part of the training samples and contain no held-out samples."
    )
    return Table("fits", caption, headings, tuple(rows), numbers)
