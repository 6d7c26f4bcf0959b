"""What the page shows of pooled cycles: for everybody together, then person by person, both feet over each other."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from gaitdisc.processing.curves_figure import label_curve, range_words, sides_together
from gaitdisc.processing.kept_parts import hash_content, keep_part, read_part
from gaitdisc.processing.leg_curves import FEET
from gaitdisc.processing.pooled_cycles import CYCLES, PooledCycles
from gaitdisc.processing.tables import (
    all_cycles,
    all_means,
    all_spatiotemporal,
    offset_words,
    overview_table,
    spatiotemporal_table,
    tabulate_left_out,
)
from gaitdisc.recording import PERCENT
from gaitdisc.recording.arrays import Values
from gaitdisc.report.figure import Figure, SavedFigure, file_names, largest_inline, save_figures
from gaitdisc.report.page import Block, draw_side_by_side, save_block, write_page
from gaitdisc.report.panels import SIDES, Room, in_style, legend, legend_lines, panels_for, sheets
from gaitdisc.report.table import findings_table, provenance_tables, refusals_table, save_table, save_tables
from gaitdisc.saved.provenance import Provenance
from gaitdisc.saved.study_run import StudyRun
from gaitdisc.words import SIDE_WORDS, counted, label, listing, sideless

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_HERE = 2  # people whose figures are drawn one after the other
FEW = 3  # cycles of a foot below which no spread is spoken of
METHOD = (
    "Contacts come from the file's events, otherwise from force, markers (heel farthest in front of the pelvis, each "
    "step along its own direction) or joint angles, in this order. A detector is skipped if it finds fewer than 80 % "
    "of the strides of another. If a plate recorded or an event marked a step that markers or angles also find, the "
    "plate's or event's time is used. Other contacts are shifted by the median difference of the person's session.",
    "Foot off comes from events, otherwise from force (if markers agree within 0.15 s), from the toe farthest behind "
    "the pelvis, or from the ankle's largest plantarflexion. With angles only, contacts are about 30 ms early and foot "
    "off about 30 ms late, so stance is about 6 % of a stride too long.",
    "A cycle is excluded if it is too short or too long, differs from the person's other cycles by more than 15 % "
    "and 6 robust standard deviations, does not contain exactly one contact of the other foot, or lacks an angle of "
    "its own leg. Cycles never cross trials.",
    "Moments are shown for cycles in which the channel's own foot was alone on one plate for the entire stance.",
    "Speed and step lengths are measured at the heels from contact to contact. On a treadmill the belt speed is "
    "added if the study states it.",
)
COMPUTED = (
    "Joint angles are computed from markers, calibrated with the person's static trial. “Findings” lists the marker "
    "set, the distance of the markers from their static positions, bridged gaps and the force balance. Moments and "
    "powers of these trials are shown for cycles whose stance is a complete step of the channel's own foot, with "
    "centre of pressure, heel and toes on the plate."
)
COLUMNS, MOST_PANELS = 4, 20
MOST_FAINT = 25  # cycles that are drawn one by one


def write_cycles_page(run: StudyRun, folder: Path) -> Path:
    """Write the report of a run that pooled cycles and fitted no models: `report.html`, `figures/` and `tables/`."""
    computed = any(finding.kind == "residual" for pooled in run.of(CYCLES) for finding in pooled.findings)
    tables = {"refusals": refusals_table(run), "findings": findings_table(run), **provenance_tables(run.provenance)}
    save_tables(tables.values(), folder)
    shown = {
        "run": run,
        "answer": cycles_sentences(run),
        "blocks": save_cycle_blocks(run, folder),
        "tables": tables,
        "method": (*METHOD, *([COMPUTED] if computed else [])),
    }
    save_cycle_tables(run, folder)
    return write_page("cycles", shown, folder)


def write_lone_cycles(pooled: PooledCycles, folder: Path) -> Path:
    """Write the page of cycles that stand alone, as a run of nothing else has it."""
    created = "in the original run, whose run.json contains settings and date,"
    made = Provenance({}, 0, pooled.files, {"gaitdisc": "of the version named there"}, "gait cycles", created)
    return write_cycles_page(StudyRun(pooled.name, "", "", pooled.refusals, made, {CYCLES.file: (pooled,)}), folder)


def save_cycle_tables(run: StudyRun, folder: Path) -> None:
    """Write all cycles, all mean curves and all spatiotemporal values of a run as three tables."""
    cycles, tables = run.of(CYCLES), folder / "tables"
    for name, table in (("cycles", all_cycles), ("spatiotemporal", all_spatiotemporal)):
        save_table(table(cycles), tables / f"{name}.csv")
    means = (all_means([pooled]) for pooled in cycles if len(pooled.kept))  # of 500 people, two million rows
    save_table(next(means, all_means(())), tables / "means.csv", means)


def cycles_sentences(run: StudyRun) -> list[str]:
    """Who is reported, with how many cycles; who is not, and what the numbers do not carry."""
    kept = [pooled for pooled in run.of(CYCLES) if len(pooled.kept)]
    if not kept:
        return ["No cycle could be kept; see “Left out”."]
    people = list(dict.fromkeys(pooled.subject for pooled in kept))
    left = sum(pooled.counted("l") for pooled in kept)
    right = sum(pooled.counted("r") for pooled in kept)
    out = sum(len(pooled.left_out) for pooled in run.of(CYCLES))
    sentences = [
        f"{counted(len(people), 'participant')}: {counted(left, 'left cycle')} and {counted(right, 'right cycle')} of "
        f"{counted(sum(pooled.trials for pooled in kept), 'trial')} are kept; {out} are left out, each with its reason."
    ]
    if few := sorted({pooled.subject for pooled in kept if min(pooled.counted("l"), pooled.counted("r")) < FEW}):
        sentences.append(
            f"Participants with fewer than {FEW} cycles of a foot in a session and condition: {listing(few)}. Their "
            "curves show single cycles, not the variability of walking."
        )
    if moved := [pooled for pooled in kept if pooled.contact_offset_s is not None]:
        shifts = [f"{pooled.name} {offset_words(pooled)}" for pooled in moved]
        sentences.append(f"Contacts from markers or angles were shifted: {'; '.join(shifts)}.")
    return sentences


def save_cycle_blocks(run: StudyRun, folder: Path) -> list[Block[SavedFigure]]:
    """Part of the page for everybody together, then one for each person, with figures and tables written."""
    if not run.of(CYCLES):
        return []
    unfitted = tuple(f"No models are fitted to {refusal.participant}: {refusal.reason}" for refusal in run.unfitted)
    device = "" if run.exo else " The study does not compare a device, so no models are fitted."
    windows = f"Every cycle lies within one trial.{device}"
    first = Block("cycles", "Cycles", (windows, *unfitted), (), (overview_table(run.of(CYCLES)),))
    people = list(dict.fromkeys(pooled.subject for pooled in run.of(CYCLES)))
    names, count = file_names(people), len(run.of(CYCLES))
    sets = {who: [pooled for pooled in run.of(CYCLES) if pooled.subject == who] for who in people}
    parts = [(own, names[who], hash_content(own, names[who]), folder, count) for who, own in sets.items()]
    new = [part for part in parts if read_part(folder, f"cycles-{part[1]}", part[2]) is None]
    if len(new) > MOST_HERE:
        draw_side_by_side(_save, new, MOST_HERE)
    return [save_block(first, folder), *(_save(*part) for part in parts)]  # all stand by now


def person_block(sets: Sequence[PooledCycles], name: str, drawn: bool = True) -> Block:
    """Part of the page for one person: counts, figures of each session and condition unless they stand, and tables."""
    kept = [pooled for pooled in sets if len(pooled.kept)]
    left_out = tabulate_left_out(sets, name)
    places = file_names([pooled.where for pooled in kept])
    shown = {f"{name}-{places[pooled.where]}": pooled for pooled in kept if drawn}
    figures = [figure for sheet, pooled in shown.items() for figure in cycles_figures(pooled, sheet)]
    tables = [*([spatiotemporal_table(kept, name)] if kept else []), *([left_out] if left_out is not None else [])]
    parts = []
    for pooled in sets:
        counts = " and ".join(f"{pooled.counted(side)} {SIDE_WORDS[side]}" for side in FEET)
        ground = "over ground" if pooled.over_ground else "on a treadmill"
        words = f"{counts} cycles of {counted(pooled.trials, 'trial')} {ground}"
        parts.append(f"{pooled.where}: {words if len(pooled.kept) else 'no cycle, see “Left out”'}")
    return Block(f"cycles-{name}", sets[0].subject, (f"{'; '.join(parts)}.",), tuple(figures), tuple(tables))


def _save(sets: Sequence[PooledCycles], name: str, key: str, folder: Path, count: int) -> Block[SavedFigure]:
    part = f"cycles-{name}"
    block = person_block(sets, name, (kept := read_part(folder, part, key)) is None)
    save_tables(block.tables, folder)
    here, most = folder / "figures", largest_inline(count)
    figures = [figure_again(shown, here, most) for shown in kept or ()] or save_figures(block.figures, folder, most)
    if kept is None:
        files = [here / f"{figure.name}.{ending}" for figure in figures for ending in ("svg", "png", "csv")]
        keep_part(folder, part, key, [asdict(replace(figure, data="")) for figure in figures], files)
    return Block(block.anchor, block.heading, block.sentences, tuple(figures), block.tables)


def figure_again(shown: Mapping[str, Any], folder: Path, inline_bytes: int) -> SavedFigure:
    """Figure that stands in a folder, as data in a page that may have grown; chosen as `save_figure` does."""
    svg, png = ((folder / f"{shown['name']}.{ending}").read_bytes() for ending in ("svg", "png"))
    kind, content = ("svg+xml", svg) if len(svg) <= max(inline_bytes, len(png)) else ("png", png)
    data = f"data:image/{kind};base64,{base64.b64encode(content).decode('ascii')}"
    return SavedFigure(**{**shown, "data": data})


@in_style
def cycles_figures(pooled: PooledCycles, name: str) -> list[Figure]:
    """Curves of one person, session and condition, a panel for each channel with left and right over each other."""
    numbers = pooled.mean_curves()
    if not len(numbers):
        return []
    joints = list(dict.fromkeys(map(sideless, sides_together(list(dict.fromkeys(numbers["channel"]))))))
    order = {kind: place for place, kind in enumerate(("angle", "translation", "moment", "power"))}
    kinds = {sideless(channel.name): order.get(channel.quantity, len(order)) for channel in pooled.channels}
    joints.sort(key=lambda joint: kinds[joint])
    parts = sheets(joints, MOST_PANELS, f"cycles-{name}")
    return [_figure(pooled, numbers, part, sheet) for sheet, part in parts.items()]


def _figure(pooled: PooledCycles, numbers: pd.DataFrame, joints: list[str], name: str) -> Figure:
    columns, curves = [channel.name for channel in pooled.channels], pooled.curves  # read from the disk once
    drawn, cells = panels_for(len(joints), COLUMNS, 1.15, Room(left=0.6, across=0.64, down=0.46))
    stems = {channel: sideless(channel) for channel in numbers["channel"].unique()}
    shown = numbers[numbers["channel"].map(stems).isin(joints)].reset_index(drop=True)
    of_side = {side: (pooled.kept["side"] == side).to_numpy() for side in FEET}
    offs = {side: float(pooled.kept.loc[rows, "stance_percent"].mean()) for side, rows in of_side.items()}
    panels = dict(zip(joints, cells, strict=True))
    for (channel, unit, side), curve in shown.groupby(["channel", "unit", "side"], sort=False):
        axes, word = panels[stems[channel]], str(side)
        if not axes.get_title():
            axes.set_title(label(stems[channel]), fontsize=7.4)
            label_curve(axes, str(channel), str(unit))
        every = curves[of_side[word], :, columns.index(str(channel))]
        every = every[np.isfinite(every).any(axis=1)]
        draw_cycles(axes, every, curve["mean"].to_numpy(), curve["sd"].to_numpy(), word)
        if np.isfinite(offs[word]):
            axes.axvline(offs[word], color=SIDES[word].colour, linewidth=0.7, linestyle=(0, (1.5, 1.5)), zorder=0)
    for axes in cells[-COLUMNS:]:
        axes.set_xlabel("cycle [%]", labelpad=1)
    cycle = {"color": "#666666", "linewidth": 0.5}
    foot_off = {"color": "#666666", "linestyle": (0, (1.5, 1.5)), "linewidth": 0.9}
    sides = {SIDE_WORDS[side]: SIDES[side] for side in FEET}
    legend(drawn, legend_lines({**sides, "single cycles": cycle, "foot off": foot_off}))
    alt = f"Mean cycles of {pooled.subject}, {pooled.where}: {range_words(shown)}."
    return Figure(name, _caption(pooled), alt, shown, drawn)


def draw_cycles(axes: Axes, every: Values, mean: Values, sd: Values, side: str) -> None:
    """Draw every cycle (cycle, phase) faint, and their mean (phase,); from three cycles on its spread."""
    from matplotlib.collections import LineCollection

    look = SIDES[side]
    axes.axhline(0.0, color="#cccccc", linewidth=0.6, zorder=0)
    lines = [np.column_stack([PERCENT, cycle]) for cycle in every[:MOST_FAINT]]
    axes.add_collection(LineCollection(lines, colors=look.colour, linewidths=0.4, alpha=0.35, zorder=1))
    if len(every) > 2:
        axes.fill_between(PERCENT, mean - sd, mean + sd, color=look.colour, alpha=0.18, linewidth=0, zorder=1)
    axes.plot(PERCENT, mean, color=look.colour, linewidth=1.2, zorder=2)


def _caption(pooled: PooledCycles) -> str:
    counts = " and ".join(f"{counted(pooled.counted(side), 'cycle')} {SIDE_WORDS[side]}" for side in FEET)
    kinetic = pooled.kept[pooled.kept["kinetic"].astype(bool)]
    plates = ", ".join(f"{int((kinetic['side'] == side).sum())} {SIDE_WORDS[side]}" for side in FEET)
    moments = f" Moments are shown only for cycles in which the channel's own foot was alone on a plate: {plates}."
    filters = dict.fromkeys(finding.what for finding in pooled.findings if finding.kind == "filter")
    return (
        f"{pooled.subject}, {pooled.where}: {counts}, pooled over {counted(pooled.trials, 'trial')}; mean ± standard "
        f"deviation (of three or more cycles) and single cycles (the first {MOST_FAINT}); left red, right blue. 0 %: "
        f"initial contact of the channel's own foot; dotted: mean foot off.{moments if len(kinetic) else ''}"
        + "".join(f" Filters: {words}." for words in filters)
    )
