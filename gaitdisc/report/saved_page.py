"""The page of any saved result, drawn again from its folder."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from gaitdisc.results import PooledCycles, Provenance, ResponseRun
from gaitdisc.results.saved import load_saved
from gaitdisc.results.variants import QUESTIONS

PAGES = {  # what a result is, what draws its page, and the folder of the page in that of the result
    "ResponseRun": ("response_page:write_report", "report"),
    "PooledCycles": ("saved_page:write_lone_cycles", "report"),
    "Discovery": ("discovery_page:write_discovery_report", ""),
    "Mismatch": ("mismatch_page:write_mismatch_report", ""),
    "Reconstruction": ("reconstruction_page:write_reconstruction_report", ""),
    "VariantRun": ("variants:write_variants", ""),
}


def draw_saved(folder: Path) -> dict[str, Path]:
    """Draw the page of the result that a folder holds, and those of the questions beside a run; nothing is fitted."""
    result = load_saved(folder)
    return {"report": _drawn(result, folder), **(draw_questions(folder) if isinstance(result, ResponseRun) else {})}


def draw_questions(run_folder: Path) -> dict[str, Path]:
    """Draw the pages of modalities and sensitivity of a run, those that are there."""
    places = {question: run_folder / question for question in QUESTIONS}
    there = {question: place for question, place in places.items() if (place / "variant_run.json").is_file()}
    return {question: _drawn(load_saved(place), place) for question, place in there.items()}


def write_lone_cycles(one: PooledCycles, folder: Path) -> Path:
    """Write the page of cycles that stand alone, as a run of nothing else has it."""
    from gaitdisc.report.cycles_page import write_cycles_page

    created = "in the run that they come from, whose run.json has settings and date,"
    made = Provenance({}, 0, one.files, {"gaitdisc": "of the version named there"}, "gait cycles", created)
    return write_cycles_page(ResponseRun(one.name, "", "", (), (), one.refusals, made, cycles=(one,)), folder)


def _drawn(result: Any, folder: Path) -> Path:
    place, inside = PAGES[type(result).__name__]
    module, _, name = place.partition(":")
    write: Callable[[Any, Path], Path] = getattr(import_module(f"gaitdisc.report.{module}"), name)
    return write(result, folder / inside)
