"""Wall time and peak memory of a whole study, from recording files to the report, as a user would run it.

    python benchmarks/study.py [FOLDER] [--repeats 3] [--threads 2]

FOLDER holds recordings of people in two conditions; by default the exotendon set of ../shared/data. There is no peer to
set beside this figure: no other tool does the whole job. The goal is 60 s on two cores.
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

GOAL_S = 60.0


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    data = Path(os.environ.get("GAITDISC_DATA", Path(__file__).parents[2] / "shared" / "data"))
    arguments.add_argument("folder", nargs="?", type=Path, default=data / "gait" / "exotendon_run")
    arguments.add_argument("--repeats", type=int, default=3)
    arguments.add_argument("--threads", type=int, default=2)
    options = arguments.parse_args()
    if not options.folder.is_dir():
        sys.exit(f"no recordings at {options.folder}; name a folder")
    machine = f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    print(f"{machine}, {options.threads} threads")
    walls = [timed_study(options.folder, options.threads) for _ in range(options.repeats)]
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
