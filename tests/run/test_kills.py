"""Kill -9 at 50 random moments of a run and of an ablation: the same tables to the last byte, one unit lost at most."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time

import pytest

from gaitdisc.ingest.study_file import write_study

KILLS, ROUNDS_AT_MOST, SEED = 50, 400, 3

# Starts once with everything imported, then does each order in a child of its own: a killed run costs no new import.
SERVER = """
import os, sys
from pathlib import Path
import gaitdisc.models.trainer, gaitdisc.models.fused_steps, gaitdisc.statistics.signed_rank
from gaitdisc.run.vary_study import ablate_study
from gaitdisc.run.run_study import run_study
from gaitdisc.ingest.study_file import load_study
for line in sys.stdin:
    word, folder = line.split(maxsplit=1)
    child = os.fork()
    if child == 0:
        study, out = load_study(Path(folder.strip())), Path(folder.strip()) / "run"
        run_study(study, out) if word == "run" else ablate_study(study, out, (5.0,))
        os._exit(0)
    print(child, flush=True)
    sys.stdin.readline()
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""


class Runs:
    """Runs of one study, started and perhaps killed."""

    def __init__(self) -> None:
        self._server = subprocess.Popen(
            [sys.executable, "-c", SERVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )

    def done(self, word, folder, killed_after_s=None):
        """Whether a run came to its end, and the seconds that it took."""
        self._server.stdin.write(f"{word} {folder}\n")
        pid, begun = int(self._server.stdout.readline()), time.monotonic()
        if killed_after_s is not None:
            time.sleep(killed_after_s)
            os.kill(pid, signal.SIGKILL)  # a child that is done waits for its parent: the number is nobody else's
        self._server.stdin.write("wait for it\n")
        code = int(self._server.stdout.readline())
        assert code in (0, -signal.SIGKILL)
        return code == 0, time.monotonic() - begun

    def close(self):
        self._server.stdin.close()
        self._server.wait()


@pytest.fixture(scope="module")
def runs():
    runs = Runs()
    yield runs
    runs.close()


def tables(folder):
    """Every file of a run but its lock, the moment of its making, and the seal that holds this moment too."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name not in (".lock", ".lock-held", "run.json"):
            found[str(path.relative_to(folder))] = path.read_bytes()
    run = json.loads((folder / "run.json").read_text())
    run["provenance"].pop("created")
    run.pop("own_sha256")
    return found, run


def apart(one, other):
    """Names of the files that differ."""
    (files, run), (others, other_run) = one, other
    names = sorted(name for name in files.keys() | others.keys() if files.get(name) != others.get(name))
    return names + [f"run.json: {key}" for key in run if run[key] != other_run.get(key)]


def units(folder):
    """What stands whole: folder of the unit -> when its last file was written."""
    return {
        path.parent: path.stat().st_mtime_ns
        for part in ("responses", "quantities", "refused")
        for path in (folder / part).glob("*/*.json")
        if not path.name.startswith(".")
    }


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("word", ["run", "ablate"])
def test_a_run_killed_at_random_moments_gives_the_same_bytes(word, runs, study, tmp_path):
    people = [one.model_copy(update={"id": f"{one.id}{letter}"}) for one in study.participants for letter in "ab"]
    people[0] = people[0].model_copy(update={"trials": (people[0].trials[0], people[1].trials[0])})  # not a pair
    study = study.model_copy(update={"participants": tuple(people)})
    write_study(study, tmp_path / "whole" / "study.toml")
    whole, seconds = runs.done(word, tmp_path / "whole")
    assert whole
    wanted = tables(tmp_path / "whole" / "run")
    chance, kills, finished = random.Random(SEED), 0, 0
    shutil.copytree(tmp_path / "whole", tmp_path / "killed", ignore=shutil.ignore_patterns("run"))
    run = tmp_path / "killed" / "run"
    for _ in range(ROUNDS_AT_MOST):
        before = units(run)
        ended, _ = runs.done(word, tmp_path / "killed", chance.uniform(0, 0.6 * seconds))
        after = units(run)
        assert {unit: after.get(unit) for unit in before} == before  # what stood is not computed again
        if not ended:
            kills += 1
            continue
        assert apart(tables(run), wanted) == []
        finished += 1
        if kills >= KILLS // 2:
            break
        shutil.rmtree(run)
    ended, _ = runs.done(word, tmp_path / "killed")
    assert ended
    assert apart(tables(run), wanted) == []
    assert not [path for path in run.rglob(".*") if path.is_file()]  # parts of files that were never finished
    assert kills >= KILLS // 2
    print(f"{word}: {kills} kills, {finished} runs finished under them, {seconds:.1f} s unkilled")
