"""A folder of recordings taken through the command line: what is said of it, and which numbers its page makes."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

NUMBER = re.compile(r"[-+]?\d[\d.,]*(e[-+]?\d+)?")
MOVED = 0.01  # share of a number by which it is another one
PERSON = "run/report/people/P01"


class Answer(NamedTuple):
    """What came of a folder: lines of findings as `severity: ...`, values by rule and side, kept cycles, people."""

    lines: list[str]
    numbers: dict[str, tuple[float, str]]  # rule and side -> value, words where the page says that it stands out
    cycles: int
    people: int
    emg: list[str]
    pages: list[str]  # kinematics, kinetics, emg: what the page draws

    def spoken(self, clean: Answer | None = None) -> list[str]:
        """Clinical sentences, side and words; beside an answer without the fault, those that it does not have.

        Limits depend on how many values a page has: words of a number that did not move are not made of the fault.
        """
        found = []
        for key, (value, words) in self.numbers.items():
            before, had = clean.numbers.get(key, (float("nan"), "")) if clean else (float("nan"), "")
            moved = not abs(value - before) <= MOVED * abs(before)
            if words and words != had and moved:
                found.append(f"{key.rsplit(' ', 1)[1]} {words}")
        return sorted(found)


def answer_of(folder: Path, reference: Path, angles: str = "file", pages: bool = True) -> Answer:
    """Take `folder`/rec through new, check and run, as its own laboratory would.

    pages: or call the functions that `run` calls, which draw none; the numbers are the same
    """
    study = folder / "study"
    printed = told("new", study, "--from", folder / "rec")
    settings = study / "study.toml"
    if angles == "markers" and settings.exists():
        text = settings.read_text(encoding="utf-8")
        settings.write_text(text.replace("# [kinematics]\n# angles", "[kinematics]\nangles"), encoding="utf-8")
    trials = listed(told("check", study, "--json"))
    lines = [f"refused: {trial['file']}: {trial['refusal']}" for trial in trials if trial["refusal"]]
    lines += [written(one) for trial in trials for one in trial["findings"]]
    people = len({trial["participant"] for trial in trials})
    if not pages:
        return undrawn(study, reference, Answer(lines, {}, 0, people, [], []))
    printed += told("run", study, "-q", "--reference", reference)
    shown = (line.replace(f"{folder}/", "") for line in printed)
    lines += [f"printed: {line}" for line in shown if line and not line.startswith("note:")]
    lines += [written(one) for one in rows_of(study / "run/report/tables/findings.csv")]
    kept = sum(row["kept"] == "True" for row in rows_of(study / "run/report/tables/cycles.csv"))
    outstanding = rows_of(study / PERSON / "outstanding.csv")
    numbers = {f"{one['rule']} {one['side']}": (float(one["value"]), one["words"]) for one in outstanding}
    drawn = [name for name in ("kinematics", "kinetics", "emg") if (study / PERSON / f"{name}.csv").exists()]
    emg = sorted({name.split("_mean")[0] for row in rows_of(study / PERSON / "emg.csv")[:1] for name in row})
    return Answer(lines, numbers, kept, people, [name for name in emg if name.startswith("emg_")], drawn)


def undrawn(study: Path, reference: Path, checked: Answer) -> Answer:
    """Add what `run` finds to what `check` said."""
    import gaitdisc as gd
    from gaitdisc.clinic.clinical_reference import load_reference
    from gaitdisc.clinic.reading import read_beside
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.run.run_study import run_study

    try:
        run = run_study(load_study(study), study / "run")
    except gd.GaitdiscError as error:
        return checked._replace(lines=[*checked.lines, f"refused: {error}"])
    lines = [f"refused: {one.condition}: {one.reason}" for one in run.refusals]
    lines += [f"{one.severity}: {one.kind}: {one.channel}, {one.what}" for own in run.cycles for one in own.findings]
    first = [own for own in run.cycles if own.subject == run.cycles[0].subject] if run.cycles else []
    noted = [one for own in first for one in read_beside(own, load_reference(reference)).numbers]
    numbers = {f"{one.rule} {one.side}": (one.value, one.words) for one in noted}
    held = {channel.name: channel.quantity for own in first for channel in own.channels}
    kinds = {"kinematics": "angle", "kinetics": "moment", "emg": "emg"}
    emg = sorted(name for name, quantity in held.items() if quantity == "emg")
    pages = [page for page, quantity in kinds.items() if quantity in held.values()]
    kept = sum(len(own.kept) for own in run.cycles)
    return Answer(checked.lines + lines, numbers, kept, checked.people, emg, pages)


def told(*words: object) -> list[str]:
    """Lines that a command prints, errors included; folders are named as they lie beside each other."""
    from gaitdisc.cli import main

    text, argv = io.StringIO(), sys.argv
    sys.argv = ["gaitdisc", *map(str, words)]
    os.environ["COLUMNS"] = "4000"
    try:
        with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
            main()
    except SystemExit as end:
        if end.code not in (0, None):
            text.write(f"\nexit code {end.code}\n")
    except Exception as error:  # a traceback is the worst answer, and is one
        text.write(f"\ntraceback: {type(error).__name__}: {error}\n")
    finally:
        sys.argv = argv
    return [line.rstrip() for line in text.getvalue().splitlines()]


def listed(printed: Sequence[str]) -> list[dict[str, Any]]:
    """JSON among printed lines; nothing where the command was refused."""
    text = "\n".join(printed)
    try:
        return json.loads(text[text.index("[") : text.rindex("]") + 1])
    except ValueError:
        return []


def rows_of(path: Path) -> list[dict[str, Any]]:
    """Rows of a CSV, none without it."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def written(finding: dict[str, Any]) -> str:
    """A finding as one line."""
    words = [finding["file"], finding["channel"], finding["what"], finding["spoils"]]
    return f"{finding['severity']}: {finding['kind']}: " + ", ".join(word for word in words if word)


def new_lines(planted: Answer, clean: Answer, notes: bool = False) -> list[str]:
    """Warnings and refusals, and notes where they count, that the recordings without the fault do not have.

    A line that only counts differently is the same.
    """
    known = {NUMBER.sub("#", line) for line in clean.lines}
    lines = [line for line in dict.fromkeys(planted.lines) if notes or not line.startswith("note")]
    return [line for line in lines if NUMBER.sub("#", line) not in known]
