"""The page of a discovery: the answer first, then the evidence; self-contained, with every number beside it as CSV."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.discovery.effect_words import (
    amount,
    at_place,
    display_unit,
    estimate_text,
    outside_text,
    spoken,
    would_distinguish,
)
from gaitdisc.discovery.figure import discovery_figures, explanations_figure
from gaitdisc.discovery.method import methods_used
from gaitdisc.discovery.result import TRACKED, VERDICTS, Discovery, Estimate, Explanation, FoundEffect
from gaitdisc.report.figure import save_figures
from gaitdisc.report.page import write_page
from gaitdisc.report.table import Table, provenance_tables, save_tables, tabulate_findings
from gaitdisc.words import NONE, counted, p_cell, with_unit


def estimates_table(discovery: Discovery) -> Table:
    """Every number of what was found, with its interval."""
    rows, records = [], []
    for effect in discovery.effects:
        for name, estimate in effect.estimates.items():
            number = name.replace("_", " ")
            degrees = estimate_text(estimate) if display_unit(estimate.unit)[1] != 1.0 else ""
            rows.append((spoken(effect.name), effect.place, number, *_amounts(estimate), degrees))
            records.append((effect.name, effect.kind, effect.place, name, *asdict(estimate).values(), effect.term))
    caption = "The identified effect, in the units of the simulation file; low and high: 95 % confidence interval."
    headings = ("effect", "place", "number", "value", "low", "high", "in degrees")
    if not any(row[-1] for row in rows):
        headings, rows = headings[:-1], [row[:-1] for row in rows]
    columns = ("effect", "kind", "place", "number", "value", "low", "high", "unit", "term")
    return Table("estimates", caption, headings, tuple(rows), _frame(records, columns))


def gap_table(discovery: Discovery) -> Table:
    """How far the gap shrank, channel by channel, on what was fitted and on what was held out."""
    rows, records = [], []
    for data, size in (("held out", discovery.held_out), ("fitted", discovery.train)):
        for channel, unit in zip(discovery.channels, discovery.units, strict=True):
            if channel not in size.channels:
                continue
            shown, factor = display_unit(unit)
            before, after, floor = size.channels[channel]
            amounts = [with_unit(amount(factor * rms, factor * floor / 10), shown) for rms in (before, after, floor)]
            p = NONE if discovery.effects and before == after else p_cell(size.p)  # the effect changes nothing here
            rows.append((data, channel, *amounts, _percent(share_closed(before, after, floor)), p))
            records.append((data, channel, before, after, floor, unit, share_closed(before, after, floor), size.p))
    moved = " (initial model, its parameters fitted within their bounds)" if discovery.corrections else ""
    held, fitted = (counted(size.pieces, "independent sample") for size in (discovery.held_out, discovery.train))
    caption = (
        f"Root-mean-square residual (measured minus simulated) before{moved} and after the identified effect is added, "
        "compared with noise alone. Closed: share of the squared gap above the noise. p: one-sided test that the added "
        "effect correlates with the residual, over all channels, weighted by the size of the effect and corrected for "
        f"autocorrelation (Newey and West 1987; held out: {held}, fitted: {fitted}). A name requires p below "
        f"{discovery.held_out.alpha:g} on held-out data, the accepted false-positive rate."
    )
    if discovery.rivals and discovery.held_out.pieces and not discovery.effects:
        first = discovery.rivals[0]
        caption += f" No effect is named; p is that of the {spoken(first.name)} {at_place(first.kind, first.place)}."
    headings = ("data", "channel", "before", "after", "noise floor", "closed", "p")
    columns = ("data", "channel", "before", "after", "noise_floor", "unit", "closed", "p")
    return Table("gap", caption, headings, tuple(rows), _frame(records, columns))


def models_table(discovery: Discovery) -> Table:
    """Held-out error of the models of chapter 4, of a device walk, with the named effect among them."""
    channel, unit = (discovery.channels[-1], discovery.units[-1]) if discovery.channels else ("", "")
    rows = tuple((name, with_unit(amount(error, 0.1), unit)) for name, error in discovery.beside.items())
    caption = (
        f"Root mean square error of {channel} on the held-out strides. Nominal: calibrated on the Nominal walk. "
        "Augmented: Nominal, plus a regression of its residual. Exo: calibrated on the device walk itself. Augmented "
        "and Exo are trained on the other strides of the device walk."
    )
    return Table("models", caption, ("model", channel), rows, _frame(list(discovery.beside.items()), ("model", unit)))


def conditions_table(discovery: Discovery) -> Table:
    """Return the conditions of a study side by side: what each was found to change, with its interval."""
    models = ("Nominal", "Nominal + named effect")
    rows, records = [], []
    for condition in discovery.conditions:
        errors = [condition.beside.get(model, math.nan) for model in models]
        cells = [with_unit(amount(error, 0.1), "N m") if math.isfinite(error) else NONE for error in errors]
        for effect in condition.effects:
            rows.append((condition.condition, f"{spoken(effect.name)}, {effect.place}", _numbers(effect), *cells))
            named = (condition.condition, effect.name, effect.place)
            records += [(*named, name, *asdict(value).values(), *errors) for name, value in effect.estimates.items()]
        if not condition.effects:
            why = VERDICTS[condition.verdict] if condition.verdict else f"refused: {condition.sentence}"
            rows.append((condition.condition, why, NONE, *cells))
            records.append((condition.condition, why, "", "", *[math.nan] * 3, "", *errors))
    caption = (
        f"Conditions of the study, n = {len(discovery.conditions)}, each compared with the Nominal walk, which "
        "calibrates one moment model for all. In brackets: 95 % confidence interval. Nominal, Nominal + named effect: "
        "root mean square error of the net moment on the held-out strides of the condition."
    )
    columns = ("condition", "effect", "place", "number", "value", "low", "high", "unit", "nominal_n_m", "named_n_m")
    headings = ("condition", "effect", "its parameters", *models)
    return Table("conditions", caption, headings, tuple(rows), _frame(records, columns))


def trials_table(discovery: Discovery) -> Table:
    """Root mean square error of each held-out trial, before and after, channel by channel."""
    runs, rows, records = discovery.runs, [], []
    errors = [(runs.measured - run) ** 2 for run in (runs.simulated, runs.augmented)]
    for number in np.unique(runs.trial):
        name = runs.names[number] if runs.names else str(number + 1)
        for place, (channel, unit) in enumerate(zip(discovery.channels, discovery.units, strict=True)):
            shown, factor = display_unit(unit)
            of_trial = (error[runs.trial == number][:, :, place] for error in errors)
            before, after = (float(np.sqrt(np.nanmean(squares))) for squares in of_trial)
            amounts = (with_unit(amount(factor * rms, factor * before / 20), shown) for rms in (before, after))
            rows.append((name, channel, *amounts))
            records.append((name, channel, before, after, unit))
    caption = (
        "Root-mean-square residual (measured minus simulated) of each held-out trial, before and after the identified "
        f"effect is added ({counted(len(runs.trial), 'run')}, each with its own initial state)."
    )
    columns = ("trial", "channel", "before", "after", "unit")
    return Table("trials", caption, columns[:-1], tuple(rows), _frame(records, columns))


def where_table(discovery: Discovery) -> Table:
    """Where the gap arises: place, share, part of the stride, region of the states."""
    rows, records = [], []
    for where in discovery.where:
        phase = f"{100 * where.phase[0]:.0f} to {100 * where.phase[1]:.0f} %" if where.phase else NONE
        rows.append((at_place(where.kind, where.place), _percent(where.share_of_gap), phase, where.region or NONE))
        records.append((where.kind, where.place, where.share_of_gap, *(where.phase or (math.nan,) * 2), where.region))
    caption = "Places at which the gap arises. Share: part of the mean squared gap that an effect at the place removes."
    headings = ("place", "share of the gap", "stride", "region")
    if not any(place.phase for place in discovery.where):  # a machine has no stride
        headings, rows = (*headings[:2], headings[3]), [(*row[:2], row[3]) for row in rows]
    columns = ("kind", "place", "share_of_gap", "phase_from", "phase_to", "region")
    return Table("where", caption, headings, tuple(rows), _frame(records, columns))


def corrections_table(discovery: Discovery) -> Table:
    """Numbers of the file that moved within their own bounds."""
    moved = [(correction.parameter, correction.given, correction.found) for correction in discovery.corrections]
    rows = tuple((name, with_unit(f"{given:.6g}", found.unit), *_amounts(found)) for name, given, found in moved)
    records = [(name, given, *asdict(found).values()) for name, given, found in moved]
    caption = (
        "Parameters of the file that changed within their bounds. These are not effects: they were also fitted in the "
        "initial model and in every explanation. Low and high: 95 % confidence interval."
    )
    headings = ("parameter", "in the file", "fitted", "low", "high")
    columns = ("parameter", "from", "to", "low", "high", "unit")
    return Table("corrections", caption, headings, rows, _frame(records, columns))


def explanations_table(discovery: Discovery) -> Table:
    """What explains the gap, what was named first, and what would distinguish the others from it."""
    named = discovery.effects[:1]
    weighed = discovery.explanations or tuple(Explanation((rival,)) for rival in discovery.rivals)
    small = [Explanation((rival,)) for rival in discovery.rivals if rival.small and discovery.explanations]
    rows, records = [], []
    for number, explanation in enumerate((*weighed, *small), 1):
        first, size = explanation.effects[0], explanation.held_out
        is_named = number == 1 and explanation.effects == discovery.effects
        recording = NONE if is_named or not named else would_distinguish(named[0].name, explanation.effects[-1].name)
        closed = share_closed(size.before, size.after, size.noise_floor) if size else math.nan
        tied = "named" if is_named else "small" if first.small else "yes" if explanation.tied else "no"
        numbers = "; ".join(_numbers(effect) for effect in explanation.effects)
        bic = f"{first.bic:.0f}".replace("-", "−") if math.isfinite(first.bic) else NONE
        rows.append((str(number), explanation.as_given, numbers, _percent(closed), bic, tied, recording))
        records.append((number, explanation.as_given, closed, size.p if size else math.nan, first.bic, tied, recording))
    caption = (
        f"Explanations of the gap, n = {len(rows)}. Closed: share of the squared gap above the noise, on held-out "
        "data. Evidence: reduction of the Bayesian criterion compared with the initial model; larger is better. Tied: "
        "these data cannot distinguish the explanation from the named effect; small: it closes too little to be named."
    )
    if not (discovery.provenance and discovery.provenance.section == TRACKED):  # a walk is searched whole
        option = '--effects "effect@place, effect@place".'
        caption += f" To use another explanation, fit it without a search: gaitdisc discover ... {option}"
    headings = ("", "effect@place", "its parameters", "closed", "evidence", "tied", "what would distinguish them")
    columns = ("number", "effects", "closed", "p", "evidence", "tied", "what_would_distinguish_them")
    return Table("rivals", caption, headings, tuple(rows), _frame(records, columns))


def twins_table(discovery: Discovery) -> Table:
    """What the same search answers to simulated records like the user's."""
    rows: list[tuple[str, str, int]] = []
    kinds = (("yes", discovery.twins.with_effects), ("no", discovery.twins.without)) if discovery.twins else ()
    for acts, answers in kinds:
        rows += [(acts, *answer) for answer in sorted(answers.items(), key=lambda answer: (-answer[1], answer[0]))]
    caption = (
        "Answers to simulated records with your inputs, trials and gaps: free runs of the simulation with and without "
        "the identified effect, plus noise of the estimated size. These records contain no unexplained residual, so "
        "answers to measured records are wrong more often."
    )
    shown = tuple((acts, name if "@" in name else name.replace("_", " "), str(count)) for acts, name, count in rows)
    columns = ("acts", "answer", "records")
    return Table("twins", caption, ("the effect acts", *columns[1:]), shown, _frame(rows, columns))


def share_closed(before: float, after: float, floor: float) -> float:
    """Return which share of the squared gap above the noise is closed, at most all of it; NaN where there is none.

    >>> share_closed(2.0, 0.9, 1.0), round(share_closed(3.0, 1.5, 1.0), 2)
    (1.0, 0.84)
    """
    there = before**2 - floor**2
    return min((before**2 - after**2) / there, 1.0) if there > 0.02 * floor**2 else math.nan


def _amounts(estimate: Estimate) -> list[str]:
    """Value, low and high end of an interval, in the unit of the file."""
    value, low, high, unit = asdict(estimate).values()
    return [with_unit(amount(number, (high - low) / 2), unit) for number in (value, low, high)]


def _numbers(effect: FoundEffect) -> str:
    numbers = [f"{name.replace('_', ' ')} {estimate_text(estimate)}" for name, estimate in effect.estimates.items()]
    outside = [text for estimate in effect.estimates.values() if (text := outside_text(effect, estimate))]
    return ", ".join([*numbers[:2], *outside]) + (f", and {len(numbers) - 2} more" if len(numbers) > 2 else "")


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %".replace("-", "−") if math.isfinite(share) else NONE


def _frame(records: Sequence[tuple[object, ...]], columns: Sequence[str]) -> pd.DataFrame:
    return pd.DataFrame([*records], columns=pd.Index(columns))


def write_discovery_report(discovery: Discovery, folder: Path) -> Path:
    """Write the report of a discovery: `report.html`, `figures/` and `tables/`."""
    discovery = discovery.public
    made, how = discovery.provenance, methods_used(discovery)
    tables = {
        "estimates": estimates_table(discovery),
        "gap": gap_table(discovery),
        "models": models_table(discovery),
        "trials": trials_table(discovery),
        "corrections": corrections_table(discovery),
        "where": where_table(discovery),
        "explanations": explanations_table(discovery),
        "twins": twins_table(discovery),
        "findings": tabulate_findings(discovery.findings, f"Findings in the files, n = {len(discovery.findings)}."),
    }
    if discovery.conditions:
        tables["conditions"] = conditions_table(discovery)
    if made:
        tables |= provenance_tables(made)
    save_tables(tables.values(), folder)
    shown = {
        "discovery": discovery,
        "title": str(made.settings.get("title", "A simulation")) if made else "A simulation",
        "verdict": VERDICTS[discovery.verdict],
        "terms": [effect for effect in discovery.effects if effect.term],
        "figures": save_figures(discovery_figures(discovery), folder),
        "left": save_figures(explanations_figure(discovery), folder),
        "tables": tables,
        "method": how.sentences,
        "added_to": how.added_to,
    }
    return write_page("discovery", shown, folder)
