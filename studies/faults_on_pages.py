"""Which faults, planted into recordings of real people, are said, and of which a page makes a clinical sentence.

    python studies/faults_on_pages.py OUT [--half develop] [--people WHO ...] [--kinds WORD] [-j 2] [--fast] [--quick]
    python studies/faults_on_pages.py OUT --healthy | --made 200

Each person's recordings are laid out as a laboratory has them, one fault is planted into the files' own bytes, and the
command line runs: new, check, run beside made controls. Said: a warning or refusal that the same person without the
fault does not have names what is faulty. Clinical: no sentence stands out that the person does not have without it.
People: six of ../shared/data, and of other laboratories whatever lies in OTHERS/<half>/<who>/<static|walk>/*.c3d.
--healthy writes what is said of the same people without faults, with all their trials; --made of made people.
"""

from __future__ import annotations

from command_line import QUICK, SHARED, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "folder of the tables and of every case", type=str, metavar="OUT"),
    argument("--half", "develop, kept or both", "develop"),
    argument("--people", "only these", nargs="+", type=str, default=None),
    argument("--kinds", "only kinds of fault whose name has one of these words, separated by commas", ""),
    argument("--others", "people of other laboratories", str(SHARED / "people")),
    argument("-j", "processes", 1),
    argument("--healthy", "no faults: what is said of the people at hand", False),
    argument("--made", "no faults: what is said of so many made people", 0),
    argument("--fast", "call what `run` calls, and draw no pages", False),
    QUICK,
)  # before the slow imports

import csv
import json
import multiprocessing
import re
import shutil
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from as_a_user import Answer, answer_of, new_lines, rows_of, told
from false_alarms import COLUMNS as SEEN
from false_alarms import Files, Made, laid_out, made_reference, of_made, of_person, table
from faults_in_people import KINDS, Kind, NotHereError, Recorded
from markdown_table import markdown_table

SEED = 27_000_000  # of the made people
SHARED_HALVES = {"develop": ("HC030A", "HC031A", "HC002D"), "kept": ("HC032A", "HC033A", "HC036A")}
QUICK_KINDS = ("1 static heel and toe", "5 gain of a plate 1.3", "9 zeros, angle")
COLUMNS = ("kind", "person", "half", "skipped", "said", "line", "sentences")
COLUMNS += ("moved", "cycles", "cycles_clean", "seconds")


class Job(NamedTuple):
    """One kind of fault in one person."""

    kind: str
    who: str
    half: str
    files: Files
    out: Path
    other: str  # somebody else, laid out
    pages: bool = True


def people(half: str, others: Path) -> dict[str, Files]:
    """Recordings of the people of a half."""
    gait, found = SHARED / "gait", {}
    for who in SHARED_HALVES[half]:
        own = gait / "young_straight_and_turn" / who
        static = [*own.glob("static/*.c3d"), *(gait / "young_static" / who).glob("*.c3d")]
        found[who] = {"static": static, "walk": [*own.glob("straight/*.c3d")], "turn": [*own.glob("turn/*.c3d")]}
    for own in sorted((others / half).glob("*/walk")):
        found[own.parent.name] = {kind: sorted((own.parent / kind).glob("*.c3d")) for kind in ("static", "walk")}
    return {who: files for who, files in found.items() if files["walk"]}


def reference(out: Path) -> Path:
    """Made controls, walked once."""
    if not (out / "ref" / "reference.json").exists():
        shutil.rmtree(out / "made_week", ignore_errors=True)
        told("demo", out / "made_week", "--clinic")
        told("reference", out / "made_week" / "controls", "--out", out / "ref")
    return out / "ref"


def without_fault(job: Job, angles: str) -> Answer:
    """Answer of the person without faults, kept."""
    folder = job.out / "clean" / f"{job.who} {angles}"
    kept = folder / "answer.json"
    if not kept.exists():
        answer = answer_of(laid_out(folder, job.who, job.files), job.out / "ref", angles, job.pages)
        kept.write_text(json.dumps(answer), encoding="utf-8")
    return Answer(*json.loads(kept.read_text(encoding="utf-8")))


def clean_both(job: Job) -> str:
    """Both answers without faults, computed."""
    for angles in ("file", "markers"):
        without_fault(job, angles)
    return job.who


def tried(job: Job) -> dict[str, Any]:
    """Plant a fault, ask, and hold the answer against the one without it."""
    began, kind = time.monotonic(), next(one for one in KINDS if one.name == job.kind)
    clean = without_fault(job, kind.angles)
    row: dict[str, Any] = {"kind": kind.name, "person": job.who, "half": job.half, "skipped": ""}
    if kind.needs and kind.needs not in clean.pages:
        return row | {"skipped": f"no {kind.needs} on the page, angles of {kind.angles}"}
    folder = laid_out(job.out / "cases" / job.who / re.sub(r"\W+", "_", kind.name), job.who, job.files)
    other = job.out / "clean" / f"{job.other} file" / "rec" / job.other
    try:
        kind.plant(Recorded(folder / "rec", job.who, other, tuple(clean.emg)))
    except NotHereError as error:
        return row | {"skipped": str(error)}
    answer = answer_of(folder, job.out / "ref", kind.angles, job.pages)
    new = new_lines(answer, clean, kind.notes)
    (folder / "new_lines.txt").write_text("\n".join(new), encoding="utf-8")
    hits = [line for line in new if re.search(kind.words, line, re.IGNORECASE)]
    moved = [abs(value - clean.numbers[key][0]) for key, (value, _) in answer.numbers.items() if key in clean.numbers]
    row["said"] = said(kind, answer, clean, bool(hits))
    row["line"] = (hits or [f"other words: {line}" for line in new] or [""])[0][:300]
    row |= {"sentences": "; ".join(answer.spoken(clean)), "moved": round(max(moved, default=0.0), 1)}
    row |= {"cycles": answer.cycles, "cycles_clean": clean.cycles}
    return row | {"seconds": round(time.monotonic() - began, 1)}


def said(kind: Kind, answer: Answer, clean: Answer, named: bool) -> bool:
    """Whether the fault is named, or its people are told apart, and no cycle is lost or doubled."""
    many = {"": True, "==": answer.cycles == clean.cycles, ">=": answer.cycles >= clean.cycles}
    return (named or 1 < kind.people == answer.people) and many[kind.cycles]


def written_rows(path: Path, columns: Sequence[str], rows: Iterable[dict[str, Any]], count: int) -> None:
    """Add rows to a table as they come, with progress."""
    fresh = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, columns)
        if fresh:
            table.writeheader()
        for number, row in enumerate(rows, 1):
            table.writerow(row)
            file.flush()
            words = row.get("skipped") or f"said {row.get('said')} {row.get('sentences', '')} | {row.get('line', '')}"
            print(f"{number}/{count} {row.get('kind', '')} {row['person']}: {words}"[:240], flush=True)


def mapped(work: Callable[[Any], Any], jobs: Sequence[Any], processes: int) -> Iterable[Any]:
    """Results as they come, of one process or several."""
    if processes < 2:
        yield from map(work, jobs)
        return
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from pool.imap_unordered(work, jobs)


def jobs_of(out: Path, half: str, only: Sequence[str] | None, others: Path, pages: bool) -> list[Job]:
    """A job for each person, without a kind."""
    found = []
    for part in ("develop", "kept") if half == "both" else (half,):
        own = people(part, others)
        names = list(own)
        for place, who in enumerate(names):
            if not only or who in only:
                found.append(Job("", who, part, own[who], out, names[place - 1], pages))
                # somebody else has to lie there for the kind that needs two people
                if not (out / "clean" / f"{names[place - 1]} file" / "rec").exists():
                    laid_out(out / "clean" / f"{names[place - 1]} file", names[place - 1], own[names[place - 1]])
    return found


def tables(rows: Sequence[dict[str, str]]) -> str:
    """Said and clinical by kind, then what was missed."""
    lines = []
    for kind in dict.fromkeys(one.name for one in KINDS):
        own = [row for row in rows if row["kind"] == kind and not row["skipped"]]
        quiet = [row for row in own if row["said"] != "True"]
        spoke = [row for row in own if row["sentences"]]
        if own:
            lines.append((kind, len(own), len(own) - len(quiet), len(own) - len(spoke)))
    total = ("all", *(sum(int(line[i]) for line in lines) for i in (1, 2, 3)))
    text = [markdown_table("fault | n | said | no sentence made of it", [*lines, total])]
    for row in rows:
        if not row["skipped"] and (row["said"] != "True" or row["sentences"]):
            what = "missed" if row["said"] != "True" else "said"
            text.append(f"{what}: {row['kind']}, {row['person']}: {row['line'][:160]} | {row['sentences']}")
    return "\n".join(text)


def main() -> None:
    """Plant, ask, write and print."""
    out = Path(GIVEN.out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    reference(out)
    if GIVEN.healthy or GIVEN.made:
        jobs = jobs_of(out, GIVEN.half, GIVEN.people, Path(GIVEN.others), not GIVEN.fast) if GIVEN.healthy else []
        if GIVEN.made:
            made_reference(out, SEED)
        made = [Made(number, SEED, out) for number in range(GIVEN.made)]
        name = "healthy.csv" if GIVEN.healthy else "made.csv"
        (out / name).unlink(missing_ok=True)
        work, chosen = (of_person, jobs) if GIVEN.healthy else (of_made, made)
        rows = (row for rows in mapped(work, chosen, GIVEN.j) for row in rows)
        written_rows(out / name, SEEN, rows, 0)
        print(table(rows_of(out / name)))
        return
    everybody = jobs_of(out, GIVEN.half, GIVEN.people, Path(GIVEN.others), not GIVEN.fast)[: 1 if GIVEN.quick else None]
    words = QUICK_KINDS if GIVEN.quick else [word.strip() for word in GIVEN.kinds.split(",")]
    done = {(row["kind"], row["person"]) for row in rows_of(out / "faults.csv")}
    names = [kind.name for kind in KINDS if any(word in kind.name for word in words)]
    jobs = [one._replace(kind=kind) for one in everybody for kind in names if (kind, one.who) not in done]
    for who in mapped(clean_both, everybody, GIVEN.j):
        print(f"without faults: {who}", flush=True)
    written_rows(out / "faults.csv", COLUMNS, mapped(tried, jobs, GIVEN.j), len(jobs))
    chosen = {one.who for one in everybody}
    print(tables([row for row in rows_of(out / "faults.csv") if row["person"] in chosen and row["kind"] in names]))


if __name__ == "__main__":
    main()
