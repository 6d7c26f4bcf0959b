"""`gaitdisc discover`, three regressions of the residual and a grey-box fit on the same blind cases, side by side.

    python benchmarks/discover.py BENCH [OUT] [--seed 21] [--cases 30] [--noise 0.05] [--jobs 2] [--made OPTIONS]

BENCH is the folder of make_cases.py and score.py (../shared/bench/hidden_effects), which are run as they are: cases
are made there, every tool is run as a command on them, and score.py alone reads the answers. PySINDy is not among the
package's dependencies (pip install pysindy); regress_residual.py and grey_box.py say what each tool is given.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("bench", "folder of make_cases.py and score.py", type=Path),
    argument("out", "where the cases go", Path("blind")),
    argument("--seed", "of the cases", 21),
    argument("--cases", "how many are kept", 30),
    argument("--noise", "of the sensors, share of the signal", 0.05),
    argument("--jobs", "cases side by side", 2),
    argument("--made", "further options of make_cases.py, in one word", ""),
)  # before the slow imports

import json
import shutil
import subprocess

import numpy as np
import pandas as pd

OURS = "gaitdisc discover {simulation} {measured} --out {out} --no-report --quiet"
BESIDE = f"{sys.executable} {Path(__file__).parent}/{{tool}}.py {{{{simulation}}}} {{{{measured}}}} --out {{{{out}}}}"
REGRESSIONS = {"PySINDy, weak": "weak", "SINDy-PI": "implicit", "regression with BIC": "forward"}
TOOLS = {
    **{name: f"{BESIDE.format(tool='regress_residual')} --how {how}" for name, how in REGRESSIONS.items()},
    "grey box with AIC": BESIDE.format(tool="grey_box"),
    "gaitdisc": OURS,
}
LIMIT_S = 300


def make(bench: Path, out: Path, count: int, options: list[str]) -> None:
    """Make the cases, and keep so many of them, evenly from all."""
    subprocess.run(
        [sys.executable, str(bench / "make_cases.py"), str(out), *options], check=True, stdout=subprocess.DEVNULL
    )
    cases = sorted(path.name for path in (out / "cases").iterdir())
    kept = {cases[i] for i in np.linspace(0, len(cases) - 1, min(count, len(cases))).round().astype(int)}
    for name in set(cases) - kept:
        shutil.rmtree(out / "cases" / name)
        shutil.rmtree(out / "truth" / name)


def scored(bench: Path, out: Path, command: str, jobs: int) -> pd.DataFrame:
    """Run one tool over the cases as score.py does, and return its rows."""
    words = ["--command", command, "--jobs", str(jobs), "--limit", str(LIMIT_S)]
    subprocess.run([sys.executable, str(bench / "score.py"), str(out), *words], check=True, stdout=subprocess.DEVNULL)
    return pd.DataFrame(json.loads((out / "score.json").read_text(encoding="utf-8")))


def line(name: str, rows: pd.DataFrame) -> dict[str, object]:
    """What score.py's rows of one tool come to."""
    nothing = rows[rows["verdict"] == "no_gap"]
    physics = rows[rows["verdict"] == "missing_physics"]
    return {
        "tool": name,
        "cases": len(rows),
        "name_and_place_right_%": 100 * rows["right_name"].mean(),
        "of_missing_physics_%": 100 * physics["right_name"].mean(),
        "named_where_nothing_is": f"{(~nothing['right_verdict'].astype(bool)).sum()} of {len(nothing)}",
        "rhs_error_left": pd.to_numeric(rows["rhs"]).median(),
        "gap_closed": pd.to_numeric(rows["closed"]).median(),
        "seconds": rows["seconds"].median(),
    }


if __name__ == "__main__":
    options = ["--seed", str(GIVEN.seed), "--noise", str(GIVEN.noise), *GIVEN.made.split()]
    make(GIVEN.bench, GIVEN.out, GIVEN.cases, options)
    lines = []
    for tool, command in TOOLS.items():
        rows = scored(GIVEN.bench, GIVEN.out, command, GIVEN.jobs)
        rows.to_json(GIVEN.out / f"{tool.replace(', ', '-')}.json", orient="records", indent=1)
        lines.append(line(tool, rows))
        print(pd.DataFrame(lines).round(3).to_string(index=False), flush=True)
