"""The page of a discovery: the answer first, then the evidence; self-contained, with every number beside it as CSV."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.report.discovery_figure import discovery_figures
from gaitdisc.report.discovery_tables import (
    corrections_table,
    data_findings,
    estimates_table,
    gap_table,
    models_table,
    rivals_table,
    trials_table,
    where_table,
)
from gaitdisc.report.figure import save_figures
from gaitdisc.report.page import write_page
from gaitdisc.report.table import provenance_tables, save_tables
from gaitdisc.results.discovery import Discovery

VERDICTS = {
    "no_gap": "no gap: nothing is added to the simulation",
    "missing_physics": "missing physics: a term is missing in the dynamics",
    "wrong_parameter": "wrong parameter: the structure is right, a number is not",
    "input_error": "input error: a driving signal is late or scaled",
    "sensor_error": "sensor error: the state is right, its measurement is not",
    "wrong_initial_condition": "wrong initial condition: only the start is wrong",
    "process_noise": "process noise: the system is shaken by something random",
    "unnamed": "unnamed: a deterministic term is missing, and no known effect explains it",
}
METHOD = (
    "Trials were cut into short runs. Each run's start was found, so that only the dynamics, the inputs and the "
    "sensors could be wrong; whole trajectories were compared with the measurement, never derivatives of it.",
    "Numbers to which the file gives two bounds were fitted within these, in the simulation as read and in every "
    "explanation alike (half the width is two standard deviations); a wrong parameter is one that has to leave them.",
    "Every explanation was weighed at every place where it may enter: the effects of the catalogue, and beside them "
    "wrong parameters, late or scaled inputs, and errors of the sensors. The best were fitted in full, with the "
    "constants inside them (a threshold, a delay, a frequency).",
    "Evidence is twice the log likelihood, under noise whose memory was learned from what is left, less the logarithm "
    "of the number of samples for each number fitted.",
    "What was found had to make the squared error fall on the held-out data, of which nothing was fitted but the start "
    "of each run: p < .05 in a one-sided signed-rank test over pieces of these data, each a period long or, where "
    "these are few, no shorter than what is left remembers; beside another effect, too. The intervals follow from the "
    "curvature of the likelihood under that noise.",
    "The noise floor is the noise of the sensors, estimated from the record without any model: what a cubic over seven "
    "samples leaves. Where up to four explanations leave no more, they are the answer. Where all leave more, sets of "
    "them were weighed by the share of the gap that they close on runs left out of the fit, less a price for each: 3 % "
    "of the gap for a plain term, up to 10 % for what can imitate anything (a delay, a product, a periodic force). "
    "What closes less than 5 % is listed as small.",
    "What no name explains, and a fitted shape does, has no name.",
)


def write_discovery_report(discovery: Discovery, folder: Path) -> Path:
    """Write the report of a discovery: `report.html`, `figures/` and `tables/`."""
    made = discovery.provenance
    tables = {
        "estimates": estimates_table(discovery),
        "gap": gap_table(discovery),
        "models": models_table(discovery),
        "trials": trials_table(discovery),
        "corrections": corrections_table(discovery),
        "where": where_table(discovery),
        "rivals": rivals_table(discovery),
        "findings": data_findings(discovery),
    }
    if made:
        tables |= provenance_tables(made)
    save_tables(tables.values(), folder)
    shown = {
        "discovery": discovery,
        "title": str(made.settings.get("title", "A simulation")) if made else "A simulation",
        "verdict": VERDICTS[discovery.verdict],
        "terms": [effect for effect in discovery.effects if effect.term],
        "figures": save_figures(discovery_figures(discovery), folder),
        "tables": tables,
        "method": METHOD,
    }
    return write_page("discovery", shown, folder)
