"""Chapter 4 whole: the response of twelve walkers to an ankle spring, from recordings to Figs. 4.2, 4.3 and 4.4.

    python studies/ch4_ankle_exo.py [FOLDER] [--quick] [--jobs 2]

The embedded cohort walks 240 s without and with the spring, its recordings are written as a laboratory's and read back,
and what `gaitdisc ablate` does is done to them. FOLDER/report holds the figures (comparison is Fig. 4.2, reduction and
residual-* Fig. 4.3, quantity Fig. 4.4) with their tables and CSV; FOLDER/printed.csv what the dissertation prints, and
beside it what is found here. Printed are that table, R2 by variable, the tests, the reductions and the lengths.
"""

from __future__ import annotations

from pathlib import Path

from command_line import KEPT, QUICK, argument, command_line

OUT, JOBS = argument("folder", KEPT, Path("ch4")), argument("--jobs", "people side by side", 2)
GIVEN = command_line(__name__, __doc__, OUT, QUICK, JOBS)  # before the slow imports

import os
import time
import tomllib
from dataclasses import dataclass

import pandas as pd
from ch4_ours import OURS
from markdown_table import as_markdown, markdown_table

import gaitdisc as gd
from gaitdisc.cohort.demonstration import write_demonstration
from gaitdisc.ingest.study_file import load_study
from gaitdisc.response.data_quantity_page import length_table
from gaitdisc.response.over_participants_page import baseline_table, reduction_table
from gaitdisc.response.page import write_report
from gaitdisc.response.pair_tests import comparison_tables
from gaitdisc.response.r2_tables import study_r2_table
from gaitdisc.run.vary_study import ablate_study
from gaitdisc.run.workers import Workers

WALK_S, PEOPLE = 240.0, 12
QUICK_S, QUICK_PEOPLE = 60.0, 1
LENGTHS_S = (1.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0)  # and the whole, 210 s
PRINTED = Path(__file__).with_name("ch4_printed.toml")


@dataclass(frozen=True, eq=False)
class Result:
    """The chapter."""

    run: gd.ResponseRun
    printed: pd.DataFrame
    page: Path


def run(quick: bool, folder: Path = Path("ch4"), jobs: int = 2) -> Result:
    """Walk, measure, read, fit, ablate, test, draw, and set what the dissertation prints beside it."""
    if not (folder / "study.toml").exists():
        write_demonstration(folder, QUICK_S if quick else WALK_S, QUICK_PEOPLE if quick else PEOPLE)
    lengths = LENGTHS_S[:2] if quick else LENGTHS_S
    done = ablate_study(load_study(folder), folder / "run", lengths, workers=Workers(jobs))
    page = write_report(done, folder / "report")
    values = pd.DataFrame(tomllib.loads(PRINTED.read_text(encoding="utf-8"))["value"])
    values["ours"] = [OURS[name](done) for name in values["id"]]
    printed = values[["what", "printed", "ours", "source"]]
    printed.to_csv(folder / "printed.csv", index=False)
    return Result(done, printed, page)


def tables(result: Result) -> str:
    """Every table of the chapter, as documents hold it, below its caption."""
    run = result.run
    first = markdown_table(" | dissertation | embedded cohort", result.printed.iloc[:, :3].itertuples(index=False))
    made = (study_r2_table, baseline_table, reduction_table, length_table)
    found = [*(make(run) for make in made), *comparison_tables(run)]
    return "\n\n".join([first, *(f"{one.caption}\n\n{as_markdown(one)}" for one in found if one is not None)])


if __name__ == "__main__":
    begun = time.perf_counter()
    result = run(GIVEN.quick, GIVEN.folder, GIVEN.jobs)
    print(tables(result))
    for refusal in result.run.refusals:
        print(f"left out: {refusal.participant} {refusal.condition}: {refusal.reason}")
    spent = f"{time.perf_counter() - begun:.0f} s with {GIVEN.jobs} jobs, {sum(os.times()[:4]):.0f} s of cores"
    print(f"{spent}; report: {result.page}")
