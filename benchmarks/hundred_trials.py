"""A hundred short trials from file to cycles on one core, and whether memory grows with their number.

    python benchmarks/hundred_trials.py [--trials 25 50 100] [--people 10] [--peer PYTHON] [--no-page]

Trials of 5 s with 40 markers at 100 Hz, two force plates and 16 EMG at 1000 Hz, of a made walker, are written as C3D in
a temporary folder, with a static trial of each person. `gaitdisc new --from` drafts the study. Timed, each in a fresh
process and for each number of trials: from file to cycles (angles and moments from markers, events, cycles, saved in
the run's folder), `gaitdisc run` after that, which draws the page, and a second run; peak memory is that of the
largest process. Once more with all of them those of one person. With --peer, an
interpreter that has kineticstoolkit (pip install kineticstoolkit, which is not among the package's dependencies), the
same files are read, filtered and cut into cycles there: no joint angles, moments, checks, pooling, tables or page.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--trials", "numbers of trials", [25, 50, 100]),
    argument("--people", "who share them", 10),
    argument("--peer", "Python interpreter with kineticstoolkit", ""),
    argument("--no-page", "draw no page", False),
)  # before the slow imports

import json
import os
import platform
import subprocess
import tempfile

import numpy as np
from derivatives import harmonics
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.recording import Recording, Surface

GOAL_S = 60.0
POINT_HZ, ANALOG_HZ, LENGTH_S = 100, 1000, 5.0
STRIDE_S, STANCE, MASS_KG = 1.07, 0.62, 64.0
WIDTH, DEPTH, THIGH, SHANK, HIP_OUT = 0.24, 0.15, 0.40, 0.38, 0.087
MUSCLES = ("ham", "rf", "vas", "gas", "sol", "ta", "gmed", "gmax")
PLATE_M = 0.56, 0.9  # along and across the walkway
PELVIS = {"R.ASIS": (0, 0, WIDTH / 2), "L.ASIS": (0, 0, -WIDTH / 2), "V.Sacral": (-DEPTH, 0, 0)}
LEG = {  # of a right leg, from the joint above
    "thigh": {"Thigh": (0, -0.2, 0.12), "Knee": (0, -THIGH, 0.057), "Knee.Medial": (0, -THIGH, -0.057)},
    "shank": {"Shank": (0, -0.2, 0.1), "Ankle": (0, -SHANK, 0.042), "Ankle.Medial": (0, -SHANK, -0.042)},
    "foot": {"Heel": (-0.06, -0.04, 0.0), "Toe": (0.14, -0.04, 0.0)},
}
ABOVE = {f"Upper{n}": (0.1 * np.cos(n), 0.15 + 0.03 * n, 0.2 * np.sin(n)) for n in range(21)}  # trunk, arms, head

# Time and peak memory of one command, for which a process of its own is needed: both are counted from its start.
COMMAND = """
import json, resource, subprocess, sys, time
start = time.perf_counter()
done = subprocess.run(sys.argv[1:], capture_output=True, text=True)
wall, used = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps([done.returncode, wall, used.ru_utime + used.ru_stime, used.ru_maxrss,
                  (done.stdout + done.stderr)[-2000:]]))
"""
CYCLES = """
import sys
from pathlib import Path
from gaitdisc.run.run_study import run_study
from gaitdisc.ingest.study_file import load_study
run_study(load_study(sys.argv[1]), Path(sys.argv[1]) / "run")
"""
# What kineticstoolkit's own pages do with a trial: read, low-pass, envelope, cycles of a plate and of a heel, 0-100 %.
PEER = """
import sys, warnings
warnings.simplefilter("ignore")
import kineticstoolkit.lab as ktk
cycles = 0
for path in sys.argv[1:]:
    trial = ktk.read_c3d(path)
    points = ktk.filters.butter(trial["Points"], 6.0, order=4)
    plates = ktk.filters.butter(trial["ForcePlatforms"], 20.0, order=4)
    emg = trial["Analogs"].get_subset([key for key in trial["Analogs"].data if key.startswith("emg_")])
    emg = ktk.filters.butter(emg, 40.0, order=4, btype="highpass")
    for key in emg.data:
        emg.data[key] = abs(emg.data[key])
    emg = ktk.filters.butter(emg, 10.0, order=4)
    for side in "RL":
        ahead = points.data[side + ".Heel"][:, 0] - points.data["V.Sacral"][:, 0]
        points.data["ahead" + side] = ahead
        found = ktk.cycles.detect_cycles(points, "ahead" + side, event_names=("back", "ahead"),
                                         thresholds=(ahead.mean() - 0.1, ahead.mean() + 0.1),
                                         directions=("falling", "rising"))
        for stream in (points, emg, plates):
            stream.events = found.events
            try:
                curves = ktk.cycles.time_normalize(stream, "back", "_", n_points=101)
            except ValueError:
                continue
        cycles += sum(event.name == "_" for event in found.events)
print(cycles)
"""


def main() -> None:
    print(f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, one thread")
    for count, people in [*((count, GIVEN.people) for count in GIVEN.trials), *((count, 1) for count in GIVEN.trials)]:
        with tempfile.TemporaryDirectory() as folder:
            files = written(Path(folder) / "recordings", count, people)
            say(Path(folder), files, count, people)


def say(folder: Path, files: list[Path], count: int, people: int) -> None:
    """Draft, run and run again one study; beside it, where there is one, the peer on the same files."""
    study = str(folder / "study")
    parts = {
        "new": ["-m", "gaitdisc", "new", study, "--from", str(folder / "recordings")],
        "cycles": ["-c", CYCLES, study],
        "page": ["-m", "gaitdisc", "run", study, "--quiet"],
        "again": ["-m", "gaitdisc", "run", study, "--quiet"],
    }
    megabytes = sum(file.stat().st_size for file in files) / 1e6
    print(f"{count} trials of {people} people, {megabytes:.0f} MB")
    for name, words in parts.items():
        if GIVEN.no_page and name in ("page", "again"):
            continue
        goal = f"; goal {GOAL_S:.0f} s" if name == "cycles" and count == 100 else ""
        print(f"  {name:15} {timed([sys.executable, *words])[0]}{goal}", flush=True)
    kept = sum(
        line.split(",")[column] == "True"
        for table in sorted((folder / "study" / "run" / "cycles").rglob("cycles.csv"))
        for lines in [table.read_text().splitlines()]
        for column in [lines[0].split(",").index("kept")]
        for line in lines[1:]
    )
    print(f"  cycles kept: {kept}")
    if GIVEN.peer:
        used, said = timed([GIVEN.peer, "-c", PEER, *map(str, files)])
        print(f"  {'kineticstoolkit':15} {used}, cycles {said.split()[-1]}", flush=True)


def timed(command: list[str]) -> tuple[str, str]:
    """Wall and processor time and peak memory of the largest process of a command on one thread, and its output."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    watched = [sys.executable, "-c", COMMAND, *command]
    done = subprocess.run(watched, env=environment, capture_output=True, text=True, check=True)
    status, wall_s, cpu_s, peak, said = json.loads(done.stdout)
    if status:
        sys.exit(said)
    peak_mb = peak * (1.0 if sys.platform == "darwin" else 1024.0) / 1e6
    return f"{wall_s:6.1f} s ({cpu_s:.1f} s of processor), peak {peak_mb:.0f} MB", said


def written(folder: Path, count: int, people: int) -> list[Path]:
    """Trials, shared by people, and a static trial of each; gives the trials."""
    files = []
    folder.mkdir()
    ids = [f"S{1 + person:02d}" for person in range(people)]
    (folder / "participants.csv").write_text("id,mass_kg\n" + "".join(f"{one},{MASS_KG}\n" for one in ids))
    for person in ids:
        (folder / person).mkdir()
        write_c3d([markers_of({name: np.zeros(100) for name in ("r", "l")}, 0.0)], folder / person / "static.c3d")
    for number in range(count):
        path = folder / ids[number % people] / f"walk{1 + number // people:02d}.c3d"
        files.append(write_c3d(*walk(number, path)))
    return files


def walk(seed: int, path: Path) -> tuple[list[Recording], Path, list[Surface]]:
    """One trial: markers, plates under one step of each foot, EMG."""
    rng = np.random.default_rng(seed)
    stride_s = STRIDE_S * rng.normal(1, 0.03)
    begin = rng.uniform(0.3, 0.5)  # phase at which the recording begins, before the second contact of the right foot
    t = np.arange(round(LENGTH_S * POINT_HZ)) / POINT_HZ
    phases = {"r": begin + t / stride_s, "l": begin + 0.5 + t / stride_s}
    contacts = {"r": (2 - begin) * stride_s, "l": (2.5 - begin) * stride_s}
    markers = markers_of(phases, _speed(stride_s), rng.normal(0, 2e-4, (len(t), 120)))
    fast = np.arange(round(LENGTH_S * ANALOG_HZ)) / ANALOG_HZ
    columns, channels, surfaces = [], [], []
    for number, (side, start) in enumerate(contacts.items(), 1):
        at = {part: _path(markers, f"{side.upper()}.{part}", fast) for part in ("Heel", "Toe")}
        share = (fast - start) / (STANCE * stride_s)
        middle = int(np.argmin(np.abs(share - 0.4)))
        centre = np.array([(at["Heel"][middle, 0] + at["Toe"][middle, 0]) / 2, 0.0, 0.0])
        size = np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]) * [PLATE_M[0] / 2, PLATE_M[1] / 2, 0]
        surfaces.append(Surface(f"plate_{number}", centre + size))
        force = _ground_force(share)
        along = np.clip(share, 0, 1)[:, None]
        point = (1 - along) * at["Heel"] + along * at["Toe"]
        point[:, 2] = 0.0
        noise = rng.normal(0, 0.5, (len(fast), 6))
        columns.append(np.hstack([force, np.cross(point - centre, force)]) + noise)
        channels += [Channel(f"plate_{number}_f{axis}", "vertical_force" if axis == "z" else "force", "N")
                     for axis in "xyz"]  # fmt: skip
        channels += [Channel(f"plate_{number}_m{axis}", "moment", "N m") for axis in "xyz"]
    burst = [(1 + np.cos(2 * np.pi * (fast / stride_s + rng.uniform()))) ** 2 for _ in range(2 * len(MUSCLES))]
    emg = 0.05 * np.stack(burst, axis=1) * rng.normal(size=(len(fast), len(burst)))
    names = tuple(Channel(f"emg_{muscle}_{side}", "emg", "V", side) for muscle in MUSCLES for side in "rl")
    return [markers, Recording(fast, np.hstack(columns), tuple(channels)), Recording(fast, emg, names)], path, surfaces


def _ground_force(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Force on the foot [N] over its stance: the weight passes from foot to foot; braking, then propulsion."""
    s, weight = np.clip(share, 0, 1), MASS_KG * 9.81
    passing = (STANCE - 0.5) / STANCE  # share of a stance in which both feet stand
    up = weight * np.minimum(np.minimum(s, 1 - s) / passing, 1)
    return np.stack([-0.15 * weight * np.sin(2 * np.pi * s), 0 * s, up], axis=1)


def _speed(stride_s: float) -> float:
    """At which the foot that stands does not slide [m/s]."""
    phase = np.array([0.1, 0.5])
    hip, knee, _ = (_angle(joint, phase) for joint in ("hip", "knee", "ankle"))
    ahead = THIGH * np.sin(hip) + SHANK * np.sin(hip - knee)
    return float(ahead[0] - ahead[1]) / (0.4 * stride_s)


def _angle(joint: str, phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of a stride that begins with initial contact at whole phases [rad]."""
    turns = np.exp(2j * np.pi * np.outer(phase, np.arange(11)))
    return np.deg2rad((turns * harmonics(joint)).real.sum(axis=1))


def markers_of(phases: dict[str, NDArray[np.float64]], speed: float, noise: float | NDArray = 0.0) -> Recording:
    """40 markers in a laboratory with z up, the walker going along x; who does not go stands straight."""
    count = len(phases["r"])
    places = {name: np.tile(place, (count, 1)) for name, place in (PELVIS | ABOVE).items()}
    for side, sign in (("r", 1), ("l", -1)):
        hip, knee, ankle = (_angle(joint, phases[side]) * (speed > 0) for joint in ("hip", "knee", "ankle"))
        joint = np.tile([-0.05, -0.08, sign * HIP_OUT], (count, 1))
        for part, angle, length in (
            ("thigh", hip, THIGH),
            ("shank", hip - knee, SHANK),
            ("foot", hip - knee + ankle, 0),
        ):
            turn = np.zeros((count, 3, 3))
            turn[:, 0, 0], turn[:, 0, 1], turn[:, 2, 2] = np.cos(angle), -np.sin(angle), 1
            turn[:, 1, 0], turn[:, 1, 1] = np.sin(angle), np.cos(angle)
            for name, place in LEG[part].items():
                places[f"{side.upper()}.{name}"] = joint + turn @ (np.array(place) * [1, 1, sign])
            joint = joint + turn @ np.array([0, -length, 0])
    lowest = np.min([places[f"{side}.{part}"][:, 1] for side in "RL" for part in ("Heel", "Toe")], axis=0)
    way = np.stack([speed * np.arange(count) / POINT_HZ, 0.03 - lowest, np.zeros(count)], axis=1)
    walker = np.hstack([place + way for place in places.values()]) + noise
    laboratory = walker.reshape(count, -1, 3)[:, :, [0, 2, 1]] * [1, -1, 1]
    channels = tuple(Channel(f"{name}.{axis}", "marker", "m") for name in places for axis in "xyz")
    return Recording(np.arange(count) / POINT_HZ, laboratory.reshape(count, -1), channels)


def _path(markers: Recording, name: str, fast: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([np.interp(fast, markers.time, markers[f"{name}.{axis}"]) for axis in "xyz"], axis=1)


if __name__ == "__main__":
    main()
