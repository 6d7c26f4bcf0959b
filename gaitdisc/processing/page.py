"""What the page shows of pooled cycles: for everybody together, then person by person, both feet over each other."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.processing.curves_figure import range_words, sides_together
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
from gaitdisc.report.curve_panels import MOST_SINGLE, Line, Panel, draw_rows
from gaitdisc.report.figure import Figure, SavedFigure, file_names, inline_drawing, largest_inline, save_figures
from gaitdisc.report.page import Block, save_block, write_page
from gaitdisc.report.panels import sheets
from gaitdisc.report.table import findings_table, provenance_tables, refusals_table, save_table, save_tables
from gaitdisc.saved.provenance import Provenance
from gaitdisc.saved.study_run import StudyRun
from gaitdisc.words import SIDE_WORDS, counted, label, listing, sideless, unit_text, upwards

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
MOST_PANELS = 21


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
        f"{counted(sum(pooled.trials for pooled in kept), 'trial')} are kept. Excluded (see “Left out”): {out}."
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
    blocks = (_save(person_sets, names[who], folder, largest_inline(count)) for who, person_sets in sets.items())
    return [save_block(first, folder), *blocks]


def person_block(sets: Sequence[PooledCycles], name: str, drawn: bool = True) -> Block:
    """Part of the page for one person: counts, figures of each session and condition unless they stand, and tables."""
    kept = [pooled for pooled in sets if len(pooled.kept)]
    left_out = tabulate_left_out(sets, name)
    places = file_names([pooled.where for pooled in kept])
    shown = {f"{name}-{places[pooled.where]}": pooled for pooled in kept if drawn}
    figures = [figure for sheet, pooled in shown.items() for figure in cycles_figures(pooled, sheet)]
    tables = [*([spatiotemporal_table(kept, name)] if kept else []), *([left_out] if left_out is not None else [])]
    texts = []
    for pooled in sets:
        counts = " and ".join(f"{pooled.counted(side)} {SIDE_WORDS[side]}" for side in FEET)
        ground = "over ground" if pooled.over_ground else "on a treadmill"
        words = f"{counts} cycles of {counted(pooled.trials, 'trial')} {ground}"
        texts.append(f"{pooled.where}: {words if len(pooled.kept) else 'no cycle, see “Left out”'}")
    return Block(f"cycles-{name}", sets[0].subject, (f"{'; '.join(texts)}.",), tuple(figures), tuple(tables))


def _save(sets: Sequence[PooledCycles], name: str, folder: Path, most: int) -> Block[SavedFigure]:
    part, key, here = f"cycles-{name}", hash_content(sets, name), folder / "figures"
    stored = read_part(folder, part, key)
    block = person_block(sets, name, stored is None)
    save_tables(block.tables, folder)
    if stored is None:
        figures = save_figures(block.figures, folder, most)
        files = [here / f"{figure.name}.{ending}" for figure in figures for ending in ("svg", "csv")]
        keep_part(folder, part, key, [asdict(replace(figure, data="")) for figure in figures], files)
    else:  # in a page that may have grown
        drawn = {figure["name"]: (here / f"{figure['name']}.svg").read_text(encoding="utf-8") for figure in stored}
        figures = [SavedFigure(**{**figure, "data": inline_drawing(drawn[figure["name"]], most)}) for figure in stored]
    return Block(block.anchor, block.heading, block.sentences, tuple(figures), block.tables)


def cycles_figures(pooled: PooledCycles, name: str) -> list[Figure]:
    """Curves of one person, session and condition, a panel for each channel with left and right over each other."""
    numbers = pooled.mean_curves()
    if not len(numbers):
        return []
    joints = list(dict.fromkeys(map(sideless, sides_together(list(dict.fromkeys(numbers["channel"]))))))
    order = {kind: place for place, kind in enumerate(("angle", "translation", "moment", "power"))}
    kinds = {sideless(channel.name): order.get(channel.quantity, len(order)) for channel in pooled.channels}
    joints.sort(key=lambda joint: kinds[joint])
    pages = sheets(joints, MOST_PANELS, f"cycles-{name}")
    return [_figure(pooled, numbers, part, sheet) for sheet, part in pages.items()]


def _figure(pooled: PooledCycles, numbers: pd.DataFrame, joints: list[str], name: str) -> Figure:
    columns, curves = [channel.name for channel in pooled.channels], pooled.curves  # read from the disk once
    shown = numbers[numbers["channel"].map(sideless).isin(joints)].reset_index(drop=True)
    of_side = {side: (pooled.kept["side"] == side).to_numpy() for side in FEET}
    means = {side: float(pooled.kept.loc[rows, "stance_percent"].mean()) for side, rows in of_side.items()}
    offs = tuple((side, percent) for side, percent in means.items() if np.isfinite(percent))
    panels = {}
    for (channel, unit, side), curve in shown.groupby(["channel", "unit", "side"], sort=False):
        word, joint, up = str(side), sideless(str(channel)), upwards(str(channel))
        every = curves[of_side[word], :, columns.index(str(channel))]
        every = every[np.isfinite(every).any(axis=1)]
        mean, sd = curve["mean"].to_numpy(), curve["sd"].to_numpy() if len(every) > 2 else None
        lines = (*(Line(word, cycle, "single") for cycle in every[:MOST_SINGLE]), Line(word, mean, sd=sd))
        empty = Panel(joint, label(joint), unit_text(str(unit)), up, "", note="", lines=(), foot_off=offs)
        known = panels.get(joint, empty)
        panels[joint] = replace(known, lines=(*known.lines, *lines))
    counts = " and ".join(f"{counted(pooled.counted(side), 'cycle')} {SIDE_WORDS[side]}" for side in FEET)
    kinetic = pooled.kept[pooled.kept["kinetic"].astype(bool)]
    plates = ", ".join(f"{int((kinetic['side'] == side).sum())} {SIDE_WORDS[side]}" for side in FEET)
    moments = f" Moments are shown only for cycles in which the channel's own foot was alone on a plate: {plates}."
    filters = dict.fromkeys(finding.what for finding in pooled.findings if finding.kind == "filter")
    caption = (
        f"{pooled.subject}, {pooled.where}: {counts}, pooled over {counted(pooled.trials, 'trial')}; mean ± standard "
        f"deviation (of three or more cycles) and single cycles (the first {MOST_SINGLE}); left red, right blue. 0 %: "
        f"initial contact of the channel's own foot; short marks: mean foot off.{moments if len(kinetic) else ''}"
        + "".join(f" Filters: {words}." for words in filters)
    )
    alt = f"Mean cycles of {pooled.subject}, {pooled.where}: {range_words(shown)}."
    return Figure(name, caption, alt, shown, draw_rows([panels[joint] for joint in joints]))
