"""Reading a C3D trial: `C3DReader` against plain ezc3d, time and peak memory.

    python benchmarks/read_c3d.py [--repeats 5] [--seconds 240]

The trial is written to a temporary folder: 60 markers at 100 Hz and 26 analog channels at 2000 Hz. Each side runs in a
process of its own, the two take turns, and the medians are printed. "Warm" is a second and later file of one reader or
of one process; "cold" is the first one, with starting Python and importing everything. The memory of our side is that
of the process that reads and of the isolated one that it starts, each at its own peak.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--repeats", "processes of each side", 5),
    argument("--seconds", "length of the trial [s]", 240),
)  # before the slow imports

import json
import multiprocessing
import os
import platform
import statistics
import subprocess
import tempfile
import time
from importlib.metadata import version

import numpy as np

MARKERS, POINT_HZ, ANALOG, ANALOG_HZ = 60, 100, 26, 2000
READS = 3

PLAIN = """
import json, resource, sys, time
import ezc3d
times = []
for _ in range({reads}):
    start = time.perf_counter()
    trial = ezc3d.c3d(sys.argv[1])
    points, analog = trial["data"]["points"], trial["data"]["analogs"]
    times.append(time.perf_counter() - start)
    del trial, points, analog
print(json.dumps([times, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, 0]))
"""

OURS = """
import json, resource, sys, time
from gaitdisc.ingest.c3d import C3DReader
times = []
with C3DReader() as reader:
    for _ in range({reads}):
        start = time.perf_counter()
        trial = reader.read(sys.argv[1])
        times.append(time.perf_counter() - start)
        del trial
usage = [resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
print(json.dumps([times, *usage]))
"""


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "trial.c3d"
        # In a process of its own: Linux lets a new process inherit the peak memory of the one that starts it.
        writing = multiprocessing.get_context("spawn").Process(target=write_trial, args=(path, GIVEN.seconds))
        writing.start()
        writing.join()
        megabytes = path.stat().st_size / 1e6
        print(f"{machine()}; ezc3d {version('ezc3d')}, numpy {np.__version__}, OMP_NUM_THREADS=1")
        print(f"{GIVEN.seconds} s, {MARKERS} markers, {ANALOG} analog channels: {megabytes:.0f} MB")
        runs: dict[str, list[dict[str, float]]] = {"plain ezc3d": [], "gaitdisc": []}
        for _ in range(GIVEN.repeats):
            for side, code in (("plain ezc3d", PLAIN), ("gaitdisc", OURS)):
                runs[side].append(run(code, path))
    print(f"{'':12} {'warm s':>8} {'cold s':>8} {'peak MB':>8} {'child MB':>9}   medians of {GIVEN.repeats}")
    middle = {
        side: {key: statistics.median(one[key] for one in several) for key in several[0]}
        for side, several in runs.items()
    }
    for side, numbers in middle.items():
        print(
            f"{side:12} {numbers['warm']:8.2f} {numbers['cold']:8.2f} {numbers['peak']:8.0f} {numbers['child']:9.0f}"
            f"   warm in each run: {', '.join(format(one['warm'], '.2f') for one in runs[side])}"
        )
    ratios = {key: middle["gaitdisc"][key] / middle["plain ezc3d"][key] for key in ("warm", "cold")}
    print(f"gaitdisc takes {ratios['warm']:.2f} times as long warm, {ratios['cold']:.2f} times cold")


def run(code: str, path: Path) -> dict[str, float]:
    """Run one process: seconds of its warm reads (median) and of all from the start to the first, peaks in MB."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", code.format(reads=READS), str(path)],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    wall = time.perf_counter() - start
    times, peak, child = json.loads(done.stdout)
    kilobytes = 1e6 if sys.platform == "darwin" else 1e3
    cold = wall - sum(times[1:])
    return {"warm": statistics.median(times[1:]), "cold": cold, "peak": peak / kilobytes, "child": child / kilobytes}


def write_trial(path: Path, seconds: int) -> None:
    import ezc3d

    rng = np.random.default_rng(0)
    frames = seconds * POINT_HZ
    trial = ezc3d.c3d()
    for group, name, value in (
        ("POINT", "RATE", [float(POINT_HZ)]),
        ("POINT", "UNITS", ["mm"]),
        ("POINT", "LABELS", [f"M{number}" for number in range(MARKERS)]),
        ("ANALOG", "RATE", [float(ANALOG_HZ)]),
        ("ANALOG", "UNITS", ["V"] * ANALOG),
        (
            "ANALOG",
            "LABELS",
            [f"EMG{number}" for number in range(16)] + [f"CH{number}" for number in range(16, ANALOG)],
        ),
    ):
        trial.add_parameter(group, name, value)
    points = rng.normal(800, 300, (3, MARKERS, frames))
    trial["data"]["points"] = np.concatenate([points, np.ones((1, MARKERS, frames))])
    trial["data"]["analogs"] = rng.normal(0, 1e-3, (1, ANALOG, seconds * ANALOG_HZ))
    trial.write(str(path))


def machine() -> str:
    """What it runs on, in words that name no machine."""
    return f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"


if __name__ == "__main__":
    main()
