"""Cost of a study against its number of participants: seconds and peak memory of a run and its report.

    python benchmarks/participants.py [--people 12 50 200] [--seconds 16]

One person of the driven walker is recorded in both conditions (ten angles at 100 Hz, forces at 1000 Hz) and copied to
as many pseudonyms as are wanted, for people that differ would cost the same; walks are short so that 200 are
affordable. Each study is run in a fresh process, one participant after the other, one thread; then the run is taken up
again, with everything computed, and then its report is written. Memory is the peak of that process so far.

Linear means that seconds a person stay the same; flat that memory does.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--people", "numbers of participants", [12, 50, 200]),
    argument("--seconds", "length of each walk [s]", 16.0),
)  # before the slow imports

import os
import platform
import shutil
import subprocess
import tempfile

from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from driven_walker import DrivenWalker

SPRING_PER_S2 = {"nominal": 0.0, "exo": 250.0}
PROGRAM = """
import resource, sys, time
from pathlib import Path

def report(since):
    print(time.perf_counter() - since[0], time.process_time() - since[1], end=" ")
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    return time.perf_counter(), time.process_time()

from gaitdisc.run.run_study import run_study
from gaitdisc.ingest.study_file import load_study
from gaitdisc.response.page import write_report
folder = Path(sys.argv[1])
study = load_study(folder)
since = report((time.perf_counter(), 0.0))
run = run_study(study, folder / "run")
since = report(since)
run = run_study(study, folder / "run")
since = report(since)
write_report(run, folder / "run" / "report")
report(since)
"""


def main() -> None:
    print(
        f"{platform.machine()}, {os.cpu_count()} cores; load {os.getloadavg()[0]:.1f}; walks of {GIVEN.seconds:g} s\n"
    )
    parts = ("run", "taken up again", "report")
    head = " | ".join(f"{part} [s, of the core, a person] | peak [MB]" for part in parts)
    print(f"| n | starting [s of the core] | {head} |\n|---|---|{'---|' * 6}")
    for count in GIVEN.people:
        folder = Path(tempfile.mkdtemp())
        try:
            write_people(folder, count, GIVEN.seconds)
            start, *found = measured(folder)
        finally:
            shutil.rmtree(folder)
        cells = [f"{wall:.1f}, {core:.1f}, {core / count:.3f} | {peak:.0f}" for wall, core, peak in found]
        print(f"| {count} | {start[1]:.1f} | {' | '.join(cells)} |", flush=True)


def write_people(folder: Path, count: int, seconds: float) -> None:
    for word, spring in SPRING_PER_S2.items():
        walk = DrivenWalker("P", seed=1, spring_per_s2=spring).walked(seconds, word)
        write_storage(walk.stream("kinematics"), folder / f"{word}.mot")
        write_storage(walk.stream("forces"), folder / f"{word}_forces.mot")
    files = {word: (f"{word}.mot", f"{word}_forces.mot") for word in SPRING_PER_S2}
    trials = tuple(PlannedTrial(condition=word, files=names) for word, names in files.items())
    study = Study(
        title=f"{count} times one walker",
        conditions=Conditions(nominal="nominal", device="exo"),
        models=Models(outputs=("hip_flexion_r", "knee_angle_r", "ankle_angle_r")),
        participants=tuple(Participant(id=f"P{number:03d}", trials=trials) for number in range(count)),
    )
    write_study(study.placed(folder), folder / "study.toml")


def measured(folder: Path) -> list[tuple[float, ...]]:
    """Seconds by the clock and of the core, and peak memory so far [MB], of starting and of each part."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-c", PROGRAM, str(folder)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)
    return [tuple(map(float, line.split())) for line in done.stdout.splitlines()]


if __name__ == "__main__":
    main()
