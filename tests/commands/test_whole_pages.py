"""Index and pages are whole files: whatever stops their writing, what stands is whole, and the next time all stands."""

from __future__ import annotations

import errno
import os
import random
import signal
import stat
import subprocess
import sys
import time

import pytest
from made_clinic import made_controls, made_person, made_run

from gaitdisc.commands.clinic_pages import keep_reference, write_people
from gaitdisc.errors import WriteError
from gaitdisc.results.clinical_reference import save_reference
from gaitdisc.results.participant_response import load_run
from gaitdisc.whole_file import PART

KILLS = 12
# Everything imported once; each order draws the pages in a child of its own.
SERVER = """
import os, sys
from pathlib import Path
import gaitdisc.report.clinic.person_pdf, gaitdisc.report.clinic.person_page, gaitdisc.clinic.reading
import matplotlib.backends.backend_pdf
from gaitdisc.commands.clinic_pages import write_people
from gaitdisc.results.participant_response import load_run
for line in sys.stdin:
    count, folder = line.split(maxsplit=1)
    children = []
    for _ in range(int(count)):
        child = os.fork()
        if child == 0:
            write_people(load_run(Path(folder.strip())), Path(folder.strip()), pdf=True)
            os._exit(0)
        children.append(child)
    print(*children, flush=True)
    sys.stdin.readline()
    print(*(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children), flush=True)
"""


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A run of two people, saved beside a reference."""
    folder = tmp_path_factory.mktemp("saved")
    save_reference(made_controls(6), folder / "ref")

    def save(place):
        made_run(*(made_person(f"P{k:02d}", each=2) for k in (1, 2))).save(place)
        keep_reference(folder / "ref", place)
        return load_run(place)

    return save


def pages(folder):
    found = {path.relative_to(folder): path.read_bytes() for path in (folder / "report").rglob("*") if path.is_file()}
    return {path: content for path, content in found.items() if not path.name.startswith(PART)}


def test_a_disk_that_is_full_at_any_write_costs_no_page_for_good(saved, tmp_path, monkeypatch):
    run, plain, writes = saved(tmp_path / "whole"), os.fsync, []

    def counted(handle):
        if stat.S_ISREG(os.fstat(handle).st_mode):  # a folder needs no room
            writes.append(plain(handle))

    monkeypatch.setattr(os, "fsync", counted)
    write_people(run, tmp_path / "whole")
    whole, count = pages(tmp_path / "whole"), len(writes)
    again = saved(tmp_path / "again")
    for k in (0, count // 3, count - 1):
        writes.clear()

        def full(handle, k=k):
            counted(handle)
            if len(writes) == k + 1 and stat.S_ISREG(os.fstat(handle).st_mode):  # once: somebody makes room meanwhile
                raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(WriteError, match="No space left on device"):
            write_people(again, tmp_path / "again")
        there = pages(tmp_path / "again")
        assert there == {path: whole[path] for path in there}, k
        assert not list((tmp_path / "again").rglob(f"{PART}*"))
    monkeypatch.setattr(os, "fsync", plain)
    write_people(again, tmp_path / "again")
    assert pages(tmp_path / "again") == whole


@pytest.fixture
def server():
    one = subprocess.Popen(
        [sys.executable, "-c", SERVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
    )

    def drawn(folder, count=1, killed_after_s=None):
        """Exit codes of processes that draw the same pages, the first killed; and how long they took."""
        one.stdin.write(f"{count} {folder}\n")
        children, begun = list(map(int, one.stdout.readline().split())), time.monotonic()
        if killed_after_s is not None:
            time.sleep(killed_after_s)
            os.kill(children[0], signal.SIGKILL)  # a child that is done waits for its parent: the number is its own
        one.stdin.write("wait\n")
        return [int(code) for code in one.stdout.readline().split()], time.monotonic() - begun

    yield drawn
    one.stdin.close()
    one.wait()


@pytest.mark.slow
def test_pages_drawn_by_killed_and_by_eight_processes_are_whole(saved, server, tmp_path):
    saved(tmp_path / "whole")
    codes, seconds = server(tmp_path / "whole")
    whole = pages(tmp_path / "whole")
    assert codes == [0] and {path.suffix for path in whole} == {".html", ".pdf", ".csv"}
    saved(tmp_path / "killed")
    chance, kills = random.Random(4), 0
    for _ in range(4 * KILLS):
        (code,), _ = server(tmp_path / "killed", killed_after_s=chance.uniform(0, 0.8 * seconds))
        there = pages(tmp_path / "killed")
        assert there == {path: whole[path] for path in there}
        kills += code == -signal.SIGKILL
        if kills == KILLS:
            break
    assert kills == KILLS
    codes, _ = server(tmp_path / "killed", 8)
    assert codes == [0] * 8 and pages(tmp_path / "killed") == whole
