"""What a user reads of the files of a walk: by `check` of a study, and by `moments` where there is a static trial."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from faults_of_meaning import Case

import gaitdisc as gd
from gaitdisc.commands.moments import moments
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Quality, Study
from gaitdisc.processing.inspection import inspected_study

TURNED_BACK = ("knee sign", "per body mass")  # notes that say that the reader set a fault right


def said_of(case: Case, planted: bool = True) -> list[str]:
    """Warnings, refusals and notes of what was turned back, of all that a user would run."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, source in case.files.items():
            shutil.copyfile(source, folder / file)
        if planted:
            case.plant(folder)
        walk = [file for file in case.files if not file.startswith("static")]
        static = [file for file in case.files if file.startswith("static")]
        return _checked(case, folder, walk, static) + (_moments(folder, walk, static[0]) if static else [])


def _checked(case: Case, folder: Path, walk: Sequence[str], static: Sequence[str]) -> list[str]:
    trials = [PlannedTrial(condition="walking", files=tuple(walk), crop_s=case.crop_s)]
    trials += [PlannedTrial(condition="static", files=(one,)) for one in static]
    study = Study(
        conditions=Conditions(nominal="walking"),
        participants=(Participant(id="P01", trials=tuple(trials)),),
        quality=Quality(min_strides=1),
    ).placed(folder)
    lines = []
    for seen in inspected_study(study):
        lines += [seen.refusal] * bool(seen.refusal)
        lines += [f.line() for f in seen.findings if f.severity != "note" or f.kind in TURNED_BACK]
    return lines


def _moments(folder: Path, walk: Sequence[str], static: str) -> list[str]:
    lines: list[str] = []
    try:
        for line in _printed(folder, walk, static):
            lines += [line] if line.startswith("warning") or "plate step" in line else []
    except gd.GaitdiscError as error:
        lines.append(str(error))
    return lines


def _printed(folder: Path, walk: Sequence[str], static: str) -> list[str]:
    import contextlib
    import io

    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        mass = None if static.endswith(".c3d") else 72.6
        moments([folder / one for one in walk], folder / static, folder / "moments.mot", mass)
    return text.getvalue().splitlines()
