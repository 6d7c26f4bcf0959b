import json
import os
import socket
import subprocess
import sys

import pytest

from gaitdisc.batch.run_lock import run_lock
from gaitdisc.errors import WriteError


def test_the_folder_is_free_again_afterwards(tmp_path):
    for _ in range(2):
        with run_lock(tmp_path / "run"):
            assert (tmp_path / "run" / ".lock").exists()
    assert not (tmp_path / "run" / ".lock").exists()


def test_a_second_run_is_told_who_holds_the_folder(tmp_path):
    with run_lock(tmp_path), pytest.raises(WriteError, match=f"held by process {os.getpid()}"), run_lock(tmp_path):
        pass


def test_the_lock_of_a_dead_process_is_taken_over(tmp_path):
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    (tmp_path / ".lock").write_text(json.dumps({"pid": dead.pid, "host": socket.gethostname()}))
    with run_lock(tmp_path):
        assert json.loads((tmp_path / ".lock").read_text())["pid"] == os.getpid()


def test_a_lock_from_another_machine_is_respected(tmp_path):
    (tmp_path / ".lock").write_text(json.dumps({"pid": 1, "host": "elsewhere"}))
    with pytest.raises(WriteError, match="process 1 on elsewhere"), run_lock(tmp_path):
        pass


def test_a_lock_that_was_never_finished_is_taken_over(tmp_path):
    (tmp_path / ".lock").write_text("")
    with run_lock(tmp_path):
        pass


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match="--out"), run_lock(tmp_path / "file" / "run"):
        pass
