"""Saving and loading of results: JSON for what is named, CSV for tables, NPZ for arrays; every file hashed.

A run is a folder::

    run.json                       title, conditions, refusals, provenance, which units there are
    walks/<person>-<condition>/    walk.json  strides.csv  arrays.npz
    responses/<person>/            response.json  r2.csv  fits.csv  arrays.npz
    refused/<person>/              refused.json
    tests/                         tests.json  tests.csv  families.csv
    over/                          over.json  lengths.csv  reductions.csv  reduction_tests.csv  ...
    quantities/<person>/           quantity.json  quantity.csv
    cycles/<person>-<condition>/   cycles.json  cycles.csv  arrays.npz

A unit (one walk, one response) is complete when its JSON file stands, because that is written last and holds the hashes
of the others and its own. A unit of which anything was changed is found by its hashes and computed again.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from gaitdisc.errors import SchemaError
from gaitdisc.own_files import claim_folder
from gaitdisc.results.provenance import Provenance, Refusal
from gaitdisc.results.response_run import ResponseRun
from gaitdisc.results.sealed_json import read_sealed, sealed_text
from gaitdisc.results.stores import CYCLES, OVER, QUANTITY, RESPONSE, TESTS, WALK, cycles_name, unit_name
from gaitdisc.results.unit_folder import FORMAT, read_json
from gaitdisc.results.variants import QUESTIONS
from gaitdisc.whole_file import write_whole, written_together


def claim_run(folder: Path) -> None:
    """Hold the folder of a run, or refuse it; what was changed in its units is found by the run itself."""
    units = ("walks", "responses", "refused", "tests", "over", "quantities", "cycles", *QUESTIONS)
    claim_folder(folder, "run.json", "report/report.html", command="gaitdisc run", mended=("run.json", *units))


@written_together()
def save_run(run: ResponseRun, folder: Path) -> None:
    """Save what a run is, beside the units that were saved as they were computed."""
    if run.tests is not None:
        TESTS.save(run.tests, folder / "tests")
    if run.over is not None:
        OVER.save(run.over, folder / "over")
    write_whole(folder / "run.json", sealed_text(_described(run)))


def save_whole_run(run: ResponseRun, folder: Path) -> None:
    """Save a run with all its units, as it is in memory; `gaitdisc run` in that folder computes the units anew."""
    for walk in run.walks:
        WALK.save(walk, folder / "walks" / unit_name(walk.subject, walk.condition))
    for response in run.responses:
        RESPONSE.save(response, folder / "responses" / response.participant)
    for quantity in run.quantities:
        QUANTITY.save(quantity, folder / "quantities" / quantity.participant)
    for cycles in run.cycles:
        CYCLES.save(cycles, folder / "cycles" / cycles_name(cycles.subject, cycles.session, cycles.condition))
    save_run(run, folder)


def created_before(run: ResponseRun, folder: Path) -> ResponseRun:
    """The run with the time of the one saved there, where it repeats that one: nothing was computed anew."""
    if run.renewed or not (folder / "run.json").is_file():
        return run
    try:
        created = read_sealed(folder / "run.json")["provenance"]["created"]
    except (SchemaError, KeyError):
        return run
    repeated = replace(run, provenance=replace(run.provenance, created=created))
    saved = (folder / "run.json").read_text(encoding="utf-8")
    return repeated if sealed_text(_described(repeated)) == saved else run


def _described(run: ResponseRun) -> dict[str, Any]:
    """What run.json says of a run."""
    return {
        "format": FORMAT,
        "title": run.title,
        "conditions": {"nominal": run.nominal, "exo": run.exo},
        "walks": [unit_name(walk.subject, walk.condition) for walk in run.walks],
        "responses": [response.participant for response in run.responses],
        "refusals": [asdict(refusal) for refusal in run.refusals],
        "provenance": asdict(run.provenance),
        "tests": run.tests is not None,
        "quantities": [quantity.participant for quantity in run.quantities],
        "over": run.over is not None,
        "cycles": [cycles_name(one.subject, one.session, one.condition) for one in run.cycles],
        "unfitted": [asdict(refusal) for refusal in run.unfitted],
    }


def load_run(folder: Path) -> ResponseRun:
    """Load a run with all its units."""
    data = read_json(folder / "run.json")
    return ResponseRun(
        data["title"],
        data["conditions"]["nominal"],
        data["conditions"]["exo"],
        tuple(WALK.load(folder / "walks" / name) for name in data["walks"]),
        tuple(RESPONSE.load(folder / "responses" / name) for name in data["responses"]),
        tuple(Refusal(**refusal) for refusal in data["refusals"]),
        Provenance(**data["provenance"]),
        TESTS.load(folder / "tests") if data.get("tests") else None,
        tuple(QUANTITY.load(folder / "quantities" / name) for name in data.get("quantities", ())),
        OVER.load(folder / "over") if data.get("over") else None,
        (),
        tuple(CYCLES.load(folder / "cycles" / name) for name in data.get("cycles", ())),
        tuple(Refusal(**refusal) for refusal in data.get("unfitted", ())),
    )
