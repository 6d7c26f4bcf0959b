"""The page of any saved result, drawn again from its folder; one of the very same run is not drawn again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from gaitdisc.errors import SchemaError
from gaitdisc.results.pooled_cycles import PooledCycles
from gaitdisc.results.provenance import Provenance, code_sha256
from gaitdisc.results.response_run import ResponseRun
from gaitdisc.results.saved import load_saved
from gaitdisc.results.sealed_json import OWN, file_sha256, read_sealed, sealed_text
from gaitdisc.results.variants import QUESTIONS
from gaitdisc.whole_file import write_whole

PAGES = {  # what a result is, what draws its page, and the folder of the page in that of the result
    "ResponseRun": ("response_page:write_report", "report"),
    "PooledCycles": ("saved_page:write_lone_cycles", "report"),
    "Discovery": ("discovery_page:write_discovery_report", ""),
    "Mismatch": ("mismatch_page:write_mismatch_report", ""),
    "Reconstruction": ("reconstruction_page:write_reconstruction_report", ""),
    "VariantRun": ("variants:write_variants", ""),
}
DRAWN = "drawn.json"  # in the folder of the report: what it was drawn of, and hashes of all its files


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


def page_of(run_folder: Path, draw: Callable[[], Path]) -> Path:
    """Page of a run that is saved: the one that stands there, or one that is drawn now.

    The page stands for as long as the run's files, this package's code and the report's own files are what they were;
    the time at which a run was looked at again is no part of that, nor are files that came beside, such as PDF.
    """
    report = run_folder / "report"
    rests_on = _rests_on(run_folder)
    try:
        drawn = read_sealed(report / DRAWN)
        if drawn["rests_on"] == rests_on and drawn["sha256"].items() <= _hashes(report).items():
            return report / drawn["page"]
    except (SchemaError, OSError, KeyError):
        pass  # none stands there, or not as it was drawn
    page = draw()
    data = {"rests_on": rests_on, "page": page.relative_to(report).as_posix(), "sha256": _hashes(report)}
    write_whole(report / DRAWN, sealed_text(data))
    return page


def _rests_on(run_folder: Path) -> str:
    """Hash of all sealed files of a run, each by its own seal; of the run itself without the time of its making."""
    parts = [code_sha256()]
    run = json.loads((run_folder / "run.json").read_text(encoding="utf-8"))
    run.pop(OWN, None)
    run.get("provenance", {}).pop("created", None)
    parts.append(json.dumps(run, sort_keys=True))
    beside = (*run_folder.glob("*/**/*.json"), *run_folder.glob("reference/*.csv"), *run_folder.glob("words.csv"))
    for path in sorted(beside):
        if path.parent.name != "report" and "report" not in path.relative_to(run_folder).parts:
            parts += [path.relative_to(run_folder).as_posix(), file_sha256(path)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _hashes(report: Path) -> dict[str, str]:
    files = [path for path in sorted(report.rglob("*")) if path.is_file() and path.name != DRAWN]
    return {path.relative_to(report).as_posix(): file_sha256(path) for path in files}
