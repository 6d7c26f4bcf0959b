"""The page of any saved result, drawn again from its folder; one of the very same run is not drawn again."""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from gaitdisc.errors import SchemaError
from gaitdisc.saved.kind import KINDS, Kind, find_kind
from gaitdisc.saved.provenance import code_sha256
from gaitdisc.saved.unit_folder import OWN, file_sha256, read_sealed, seal_text
from gaitdisc.whole_file import write_whole

DRAWN = "drawn.json"  # in the folder of the report: what it was drawn of, and hashes of all its files


def draw_saved(folder: Path) -> dict[str, Path]:
    """Draw the page of the result that a folder holds, and those of the results beside it; nothing is fitted."""
    kind = find_kind(folder, drawn=True)
    return {"report": kind.draw(kind.load(folder), folder), **draw_beside(kind, folder)}


def draw_beside(kind: Kind[Any], folder: Path) -> dict[str, Path]:
    """Draw the pages of the results that lie in the folder of another, those that are there."""
    places = [folder / name for name in kind.beside if any((folder / name / file).is_file() for file in KINDS)]
    return {place.name: draw_saved(place)["report"] for place in places}


def find_page(run_folder: Path, draw: Callable[[], Path]) -> Path:
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
    write_whole(report / DRAWN, seal_text(data))
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
