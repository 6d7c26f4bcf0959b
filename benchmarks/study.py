"""Wall time and peak memory of a whole study, from recording files to the report, as a user would run it.

    python benchmarks/study.py [FOLDER] [--repeats 3] [--threads 2]

FOLDER holds recordings of people in two conditions; by default the exotendon set of ../shared/data. There is no peer to
set beside this figure: no other tool does the whole job. The goal is 60 s on two cores.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import SHARED, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", "recordings of people in two conditions", SHARED / "gait" / "exotendon_run"),
    argument("--repeats", "runs of the whole study", 3),
    argument("--threads", "of each run", 2),
)  # before the slow imports

import os
import platform
import resource
import shutil
import statistics
import subprocess
import tempfile
import time

GOAL_S = 60.0


def main() -> None:
    if not GIVEN.folder.is_dir():
        sys.exit(f"no recordings at {GIVEN.folder}; name a folder")
    machine = f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    print(f"{machine}, {GIVEN.threads} threads")
    walls = [timed_study(GIVEN.folder, GIVEN.threads) for _ in range(GIVEN.repeats)]
    peak_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"files to report: median {statistics.median(walls):.1f} s of {[round(wall, 1) for wall in walls]}")
    print(f"peak memory of the largest process: {peak_mb:.0f} MB; goal {GOAL_S:.0f} s")


def timed_study(recordings: Path, threads: int) -> float:
    """`gaitdisc new`, then `gaitdisc run` with its report, in fresh processes and a fresh folder; wall time [s]."""
    work = Path(tempfile.mkdtemp())
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    tool = [sys.executable, "-m", "gaitdisc"]
    try:
        started = time.perf_counter()
        for words in (["new", str(work / "study"), "--from", str(recordings)], ["run", str(work / "study"), "--quiet"]):
            done = subprocess.run([*tool, *words], env=environment, capture_output=True, text=True, check=False)
            if done.returncode not in (0, 3):
                sys.exit(done.stdout + done.stderr)
        return time.perf_counter() - started
    finally:
        shutil.rmtree(work)


if __name__ == "__main__":
    main()
