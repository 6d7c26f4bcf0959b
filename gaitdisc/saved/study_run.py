"""A run of a study: what was kept of everybody, by kind, who was refused, and what all of it rests on.

A run is a folder: `run.json` (title, conditions, refusals, provenance, which units there are), and a folder for each
kind of unit, in which each unit has a folder of its own (tests/ and over/ hold one). A unit is complete when its JSON
file stands, because that is written last and holds the hashes of the others and its own. A unit of which anything was
changed is found by its hashes and computed again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar

from gaitdisc.errors import SchemaError
from gaitdisc.own_files import claim_folder
from gaitdisc.saved.kind import Kind, Saved, load_word
from gaitdisc.saved.provenance import Provenance, Refusal
from gaitdisc.saved.unit_folder import FORMAT, read_json, read_sealed, seal_text
from gaitdisc.whole_file import write_together, write_whole

if TYPE_CHECKING:
    import pandas as pd

T = TypeVar("T")
R = TypeVar("R", bound="StudyRun")
FINDING_COLUMNS = ("participant", "condition", "severity", "kind", "file", "channel", "what", "spoils", "spans_s")
UNITS = {  # folder of the units of a kind, which is also their key in run.json, and the kind
    "walks": "gaitdisc.processing.pooled_cycles:WALK",
    "responses": "gaitdisc.response.participant_response:RESPONSE",
    "tests": "gaitdisc.response.participants_result:TESTS",
    "quantities": "gaitdisc.response.participant_response:QUANTITY",
    "over": "gaitdisc.response.participants_result:OVER",
    "cycles": "gaitdisc.processing.pooled_cycles:CYCLES",
}
OTHERS = ("refused", "modalities", "sensitivity")  # folders that a run also writes, and mends


@dataclass(frozen=True, eq=False)
class StudyRun(Saved, file="run.json"):
    """All that a report needs; nothing is computed again to draw it."""

    title: str  # of the study
    nominal: str  # the study's words for the two conditions
    exo: str  # empty where no device is compared
    refusals: tuple[Refusal, ...]  # everybody and everything left out
    provenance: Provenance
    units: Mapping[str, tuple[Any, ...]]  # by the file of their kind
    # participants whose cycles are pooled and to whom no models are fitted, and why, in a study with a device
    unfitted: tuple[Refusal, ...] = ()
    # files of an earlier run that were found changed or unreadable, and were computed again; said once, not saved
    renewed: tuple[str, ...] = ()

    def of(self, kind: Kind[T]) -> tuple[T, ...]:
        """Units of a kind."""
        return self.units.get(kind.file, ())

    def with_units(self, kind: Kind[T], units: tuple[T, ...]) -> Self:
        """The run with other units of a kind."""
        return replace(self, units={**self.units, kind.file: units})

    def findings_table(self) -> pd.DataFrame:
        """Every finding of every walk and of pooled trials, one row each, the severest first."""
        import pandas as pd

        units = [unit for group in self.units.values() for unit in group if hasattr(unit, "findings")]
        rows = [
            {
                "participant": unit.subject,
                "condition": unit.where,
                **{name: getattr(finding, name) for name in ("severity", "kind", "file", "channel", "what", "spoils")},
                "spans_s": "; ".join(f"{start:.2f}-{end:.2f}" for start, end in finding.spans),
            }
            for unit, finding in sorted(
                ((unit, finding) for unit in units for finding in unit.findings), key=lambda both: both[1].rank
            )
        ]
        return pd.DataFrame(rows, columns=pd.Index(FINDING_COLUMNS))


def claim_run(folder: Path) -> None:
    """Hold the folder of a run, or refuse it; what was changed in its units is found by the run itself."""
    places = ("run.json", *UNITS, *OTHERS)
    claim_folder(folder, "run.json", "report/report.html", command="gaitdisc run", mended=places)


@write_together()
def save_run(run: StudyRun, folder: Path) -> None:
    """Save what a run is, beside the units that were saved as they were computed."""
    for place, kind in _kinds().items():
        if kind.unit is None:
            for unit in run.of(kind):
                kind.save(unit, folder / place)
    write_whole(folder / "run.json", seal_text(_describe(run)))


def save_whole_run(run: StudyRun, folder: Path) -> None:
    """Save a run with all its units, as it is in memory; `gaitdisc run` in that folder computes the units anew."""
    for place, kind in _kinds().items():
        if kind.unit is not None:
            for unit in run.of(kind):
                kind.save(unit, folder / place / kind.unit(unit))
    save_run(run, folder)


def keep_creation(run: R, folder: Path) -> R:
    """The run with the time of the one saved there, where it repeats that one: nothing was computed anew."""
    if run.renewed or not (folder / "run.json").is_file():
        return run
    try:
        created = read_sealed(folder / "run.json")["provenance"]["created"]
    except (SchemaError, KeyError):
        return run
    repeated = replace(run, provenance=replace(run.provenance, created=created))
    saved = (folder / "run.json").read_text(encoding="utf-8")
    return repeated if seal_text(_describe(repeated)) == saved else run


def _kinds() -> dict[str, Kind[Any]]:
    return {place: load_word(word) for place, word in UNITS.items()}


def _describe(run: StudyRun) -> dict[str, Any]:
    """What run.json says of a run."""
    units = {
        place: len(run.of(kind)) > 0 if kind.unit is None else [kind.unit(unit) for unit in run.of(kind)]
        for place, kind in _kinds().items()
    }
    return {
        "format": FORMAT,
        "title": run.title,
        "conditions": {"nominal": run.nominal, "exo": run.exo},
        "walks": units.pop("walks"),
        "responses": units.pop("responses"),
        "refusals": [asdict(refusal) for refusal in run.refusals],
        "provenance": asdict(run.provenance),
        **units,
        "unfitted": [asdict(refusal) for refusal in run.unfitted],
    }


def load_run_as(noun: type[R], folder: Path) -> R:
    """Load a run with all its units; noun: `StudyRun` or a class of it."""
    data = read_json(folder / "run.json")
    units = {}
    for place, kind in _kinds().items():
        there = data.get(place, ())
        names = ([""] if there else []) if kind.unit is None else there
        units[kind.file] = tuple(kind.load(folder / place / name) for name in names)
    return noun(
        title=data["title"],
        nominal=data["conditions"]["nominal"],
        exo=data["conditions"]["exo"],
        refusals=tuple(Refusal(**refusal) for refusal in data["refusals"]),
        provenance=Provenance(**data["provenance"]),
        units=units,
        unfitted=tuple(Refusal(**refusal) for refusal in data.get("unfitted", ())),
    )
