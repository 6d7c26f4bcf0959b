import errno
import json
import os
import socket
import subprocess
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor

import pytest

from gaitdisc.errors import WriteError
from gaitdisc.write_lock import write_lock


def test_the_folder_is_free_again_afterwards(tmp_path):
    for _ in range(2):
        with write_lock(tmp_path / "run"):
            assert (tmp_path / "run" / ".lock").exists()
    assert not (tmp_path / "run" / ".lock").exists()


def test_another_thread_reads_who_holds_the_folder(tmp_path):
    words = rf"\(pid {os.getpid()}\) .*{tmp_path}/.*--out"
    with write_lock(tmp_path), ThreadPoolExecutor(1) as pool, pytest.raises(WriteError, match=words):
        pool.submit(taken, tmp_path).result()


def test_within_itself_a_folder_is_held_once(tmp_path):
    with write_lock(tmp_path):
        taken(tmp_path)
        assert (tmp_path / ".lock").exists()
    assert not list(tmp_path.iterdir())


def test_a_file_is_held_beside_others_of_its_folder(tmp_path):
    with write_lock(tmp_path, ".lock-a.csv"), ThreadPoolExecutor(1) as pool:
        pool.submit(taken, tmp_path, ".lock-b.csv").result()
        with pytest.raises(WriteError, match=rf"is writing to {tmp_path}/a\.csv\. Wait.*delete \.lock-a\.csv"):
            pool.submit(taken, tmp_path, ".lock-a.csv").result()


def taken(*where):
    with write_lock(*where):
        pass


def test_the_lock_of_a_dead_process_is_taken_over(tmp_path):
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    (tmp_path / ".lock").write_text(json.dumps({"pid": dead.pid, "host": socket.gethostname()}))
    with write_lock(tmp_path):
        assert json.loads((tmp_path / ".lock").read_text())["pid"] == os.getpid()


def test_a_lock_from_another_machine_is_respected(tmp_path):
    (tmp_path / ".lock").write_text(json.dumps({"pid": 1, "host": "elsewhere"}))
    with pytest.raises(WriteError, match=r"1.*elsewhere"), write_lock(tmp_path):
        pass


def test_a_lock_that_was_never_finished_is_taken_over(tmp_path):
    (tmp_path / ".lock").write_text("")
    with write_lock(tmp_path):
        pass


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match="--out"), write_lock(tmp_path / "file" / "run"):
        pass


def test_a_number_that_another_process_has_by_now_holds_nothing(tmp_path):
    """A container that is started again gives the same numbers to its processes, this one's own among them."""
    for pid in (os.getpid(), os.getppid()):
        (tmp_path / ".lock").write_text(json.dumps({"pid": pid, "host": socket.gethostname()}))
        with write_lock(tmp_path):
            pass


def test_of_many_that_start_at_once_one_gets_the_folder_until_it_is_killed(tmp_path):
    code = (
        "import sys, time; from pathlib import Path; from gaitdisc.write_lock import write_lock\n"
        "from gaitdisc.errors import WriteError\n"
        "try:\n    with write_lock(Path(sys.argv[1])): print('held', flush=True); sys.stdin.read()\n"
        "except WriteError as error: print(error)"
    )
    started = [
        subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdin=-1, stdout=-1, text=True) for _ in range(3)
    ]
    said = [process.stdout.readline() for process in started if process.stdout]
    for process in started:
        process.kill()
        process.communicate()
    assert said.count("held\n") == 1
    assert all("is writing to" in line for line in said if line != "held\n")
    assert (tmp_path / ".lock").exists()
    with write_lock(tmp_path):
        pass


def test_what_a_killed_run_left_unfinished_is_cleared_away(tmp_path):
    unit = tmp_path / "responses" / "P01"
    unit.mkdir(parents=True)
    (unit / ".part-r2-abc.csv").write_text("half")
    (unit / "r2.csv").write_text("whole")
    with write_lock(tmp_path, run=True):
        assert [file.name for file in unit.iterdir()] == ["r2.csv"]


def test_a_disk_without_locks_is_refused_and_keeps_no_mark(tmp_path, monkeypatch):
    """A mere file in place of a lock would stay when its run is killed."""

    def unknown(*_):
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr("fcntl.flock", unknown)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with (
            pytest.raises(WriteError, match=r"write and lock.*no.*--out"),
            write_lock(tmp_path, run=True),
        ):
            pass
        taken(tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_run_that_fails_frees_its_folder(tmp_path):
    with pytest.raises(ZeroDivisionError), write_lock(tmp_path):
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())
