"""The page of a run: one self-contained page, with every figure and table beside it as files."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from gaitdisc.processing.curves_figure import curves_figures
from gaitdisc.processing.page import save_cycle_blocks, save_cycle_tables, write_cycles_page
from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.report.figure import Figure, file_names, largest_inline, save_figures
from gaitdisc.report.page import draw_side_by_side, save_block, write_page
from gaitdisc.report.table import findings_table, flatten, provenance_tables, refusals_table, save_table, save_tables
from gaitdisc.response.held_out import draw_held_out, residual_figures
from gaitdisc.response.over_participants_page import over_blocks
from gaitdisc.response.pair_tests import comparison_figures, comparison_sentences, comparison_tables
from gaitdisc.response.participant_response import RESPONSE, ResponseRun
from gaitdisc.response.r2_tables import (
    not_computed,
    participants_table,
    r2_figures,
    r2_table,
    study_r2_table,
    tail_words,
)
from gaitdisc.response.sentences import participant_sentences, study_sentences
from gaitdisc.response.walks_page import fits_table, strides_figure, tabulate_dropped, walks_table

FIGURES_A_PERSON = 5
MOST_OPEN = 2  # with more participants than this, the first screen is brief and their sections are folded
_FILTER_WORDS = ("filter", "cutoff", "low_pass", "high_pass", "lowpass", "highpass", "order", "envelope", "band")


def write_report(run: ResponseRun, folder: Path) -> Path:
    """Write the report of a run: `report.html`, `figures/` and `tables/`.

    The page needs nothing but itself: figures are inside it, no script, nothing from a network. Beside every figure
    lies a CSV with the numbers drawn. Writing the same run again gives the same bytes.
    """
    if run.cycles and not run.walks:
        return write_cycles_page(run, folder)
    people = list(dict.fromkeys([*(r.participant for r in run.responses), *(w.subject for w in run.walks)]))
    names = file_names(people)
    limit = largest_inline(FIGURES_A_PERSON * len(run.responses))
    alone = []
    for person, name in names.items():
        walks = tuple(walk for walk in run.walks if walk.subject == person)
        responses = tuple(response for response in run.responses if response.participant == person)
        person_run = replace(run, units={WALK.file: walks, RESPONSE.file: responses})
        alone.append((person_run, person, name, folder, limit))
    sections = draw_side_by_side(_section, alone, MOST_OPEN)  # drawing takes seconds a participant
    overview = save_figures(r2_figures(run) if run.responses else [], folder)
    compared = save_figures(comparison_figures(run), folder)
    pair_tables = comparison_tables(run)
    blocks = [*(save_block(block, folder) for block in over_blocks(run)), *save_cycle_blocks(run, folder)]
    tables = {
        "refusals": refusals_table(run),
        "walks": walks_table(run),
        "findings": findings_table(run),
        "fits": fits_table(run),
        **({"people": participants_table(run), "study": study_r2_table(run)} if len(run.responses) > 1 else {}),
        **provenance_tables(run.provenance),
    }
    save_tables((*tables.values(), *pair_tables), folder)
    save_table(run.r2_table(), folder / "tables" / "r2.csv")
    if run.cycles:
        save_cycle_tables(run, folder)
    shown = {
        "run": run,
        "study": study_sentences(run),
        "sections": sections,
        "overview": overview,
        "comparison": {"sentences": comparison_sentences(run), "figures": compared, "tables": pair_tables},
        "blocks": blocks,
        "tables": tables,
        "method": method_sentences(run),
        "headline": 1 if not run.responses else 0 if len(run.responses) == 1 else 2,
        "briefly": len(sections) > MOST_OPEN,
    }
    return write_page("report", shown, folder)


def _section(run: ResponseRun, person: str, name: str, folder: Path, limit: int) -> dict[str, Any]:
    """What the page shows of one participant; no sentences and no R2 where there is no response."""
    response = next(iter(run.responses), None)
    strides = strides_figure(run, person, name)
    drawn: dict[str, list[Figure]] = {
        "held_out": draw_held_out(response, name) if response else [],
        "residual": residual_figures(response, name) if response else [],
        "curves": curves_figures(run, person, name),
        "strides": [strides] if strides else [],
    }
    r2, dropped = (r2_table(response, name) if response else None), tabulate_dropped(run, person, name)
    save_tables((table for table in (r2, dropped) if table is not None), folder)
    return {
        "participant": person,
        "anchor": f"participant-{name}",
        "sentences": participant_sentences(response) if response else [],
        "r2": r2,
        "reasons": not_computed(run, response) if response else [],
        "dropped": dropped,
        "figures": {subject: save_figures(figures, folder, limit) for subject, figures in drawn.items()},
    }


def method_sentences(run: ResponseRun) -> list[str]:
    """State, where angles come from markers, models, discrepancy, judgement, filters, a sentence each."""
    held_out, markers = tail_words(run), []
    computed = sum(any(finding.kind == "marker set" for finding in walk.findings) for walk in run.walks)
    if computed:
        walks = "the only walk" if len(run.walks) == 1 else f"{computed} of {len(run.walks)} walks"
        markers.append(
            f"Joint angles of {walks} are computed from markers, calibrated with the person's static trial, before "
            "they are filtered. “Findings” lists the marker set, the distance of the markers from their static "
            "positions and bridged gaps."
        )
    return [
        *markers,
        "The state X contains joint angles and, if available, EMG envelopes (Eq. 4.1). Each model uses X, its first "
        "derivative and percent stride φ, and predicts second derivatives of the outputs.",
        f"The Nominal model f is fitted to the walk without the device effect ({run.nominal}; Eq. 4.2). The Exo model "
        f"Y is fitted to the device walk ({run.exo}; Eq. 4.3), which makes it the upper limit for these inputs.",
        "The Discrepancy model g is fitted to the residual of the Nominal model on the device walk, the measured "
        "second derivative minus f (Eq. 4.4). The Augmented model is the sum f + g (Eq. 4.5).",
        f"The last {f'{held_out} s' if held_out else 'part'} of each walk is held out before any fit. R² = 1 − (sum "
        "of squared residuals) / (sum of squares about the mean) on these samples: 1 if all of the variance is "
        "explained, 0 if a model is no better than the mean, negative if it is worse.",
        f"{_filter_sentence(run)} A filter alone makes part of a second derivative predictable from the signal "
        "itself. The null gives this part: R² of band-limited noise that was filtered in the same way.",
    ]


def _filter_sentence(run: ResponseRun) -> str:
    from gaitdisc.signals.butterworth import effective_cutoff_hz  # brings scipy.signal, which takes a second

    settings = run.provenance.settings
    filters = settings.get("filters")
    if not isinstance(filters, Mapping) or not {"kinematics_hz", "order"} <= set(filters):
        rows = [(k, v) for k, v in flatten(settings) if any(word in k.lower() for word in _FILTER_WORDS)]
        text = ", ".join(f"{key} = {value}" for key, value in rows)
        return f"Filters in the settings: {text}." if text else "The settings of the run do not name a filter."
    order, cutoff = int(filters["order"]), float(filters["kinematics_hz"])
    rates = sorted({walk.rate_hz for walk in run.walks})
    together = " or ".join(f"{effective_cutoff_hz(cutoff, rate, order):.2f} Hz at {rate:g} samples/s" for rate in rates)
    emg = ""
    if {"emg_highpass_hz", "emg_lowpass_hz"} <= set(filters) and any(
        channel.quantity == "emg" for walk in run.walks for channel in walk.channels
    ):
        emg = (
            f"; EMG was high-passed at {filters['emg_highpass_hz']:g} Hz, rectified, and low-passed at "
            f"{filters['emg_lowpass_hz']:g} Hz with the same order"
        )
    return (
        f"Angles were low-passed by a Butterworth filter of order {order} per pass, forwards and backwards and "
        f"therefore without lag; cut-off {cutoff:g} Hz at −3 dB of one "
        f"pass{f' (both passes: {together})' if together else ''}{emg}."
    )
