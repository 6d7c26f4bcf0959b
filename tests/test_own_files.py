"""Files written whole, those that a command may replace, and one that writes at a time."""

import errno
import json
import os
import socket
import subprocess
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from multiprocessing import get_context

import pytest
from manufactured_discovery import manufactured

from gaitdisc.discovery.folder import save_discovery
from gaitdisc.errors import WriteError
from gaitdisc.own_files import LIST, claim_file, claim_folder, guard, note_inputs, under_this_guard
from gaitdisc.saved.unit_folder import seal_text
from gaitdisc.whole_file import remove_file, whole_file, write_whole
from gaitdisc.write_lock import write_lock

EXPORT, REPORT = "gaitdisc export", "gaitdisc report"


def write(path, text="x", command=EXPORT, **how):
    with guard(command, **how):
        write_whole(path, text)


def test_the_list_names_each_file_with_its_hash_and_command(tmp_path):
    write(tmp_path / "a b.csv", "abc")
    write(tmp_path / "a b.csv", "abc")
    line = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  gaitdisc export  a b.csv\n"
    assert (tmp_path / LIST).read_text() == line
    assert {path.name for path in tmp_path.iterdir()} == {LIST, "a b.csv"}


def test_a_new_file_with_the_number_of_one_that_was_read_and_replaced_is_no_input(tmp_path, monkeypatch):
    write(tmp_path / "part.csv")
    write(tmp_path / "page.html")
    os.utime(tmp_path / "page.html", ns=(1, 1))
    monkeypatch.setattr(os.path, "samestat", lambda one, other: True)  # as a disk does that gives numbers again
    write(tmp_path / "page.html", "y", inputs=[tmp_path / "part.csv"])
    with pytest.raises(WriteError, match="is an input of gaitdisc export"):
        write(tmp_path / "part.csv", "y", inputs=[tmp_path / "part.csv"])


def test_another_command_replaces_it_no_more_than_another_program(tmp_path):
    write(tmp_path / "a.csv")
    with pytest.raises(WriteError, match=r"a\.csv.*not written by gaitdisc"):
        write(tmp_path / "a.csv", command="gaitdisc angles")


@pytest.mark.parametrize(("first", "then"), [(EXPORT, REPORT), (REPORT, EXPORT)])
def test_report_and_what_drew_a_page_first_replace_it_in_turn(tmp_path, first, then):
    for command in (first, then, first):
        write(tmp_path / "report.html", command, command)


def test_a_killed_command_knows_its_file_again(tmp_path, monkeypatch):
    """Between its line and its place a file may be either the earlier one or the new one."""
    write(tmp_path / "a.csv", "old")
    with monkeypatch.context() as killed, pytest.raises(KeyboardInterrupt):
        killed.setattr("pathlib.Path.replace", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        write(tmp_path / "a.csv", "new")
    write(tmp_path / "a.csv", "newer")
    assert (tmp_path / "a.csv").read_text() == "newer"


def test_what_is_read_on_the_way_is_an_input(tmp_path):
    write(tmp_path / "a.csv")
    with pytest.raises(WriteError, match=r"a\.csv.*Choose another output"), guard(EXPORT):
        note_inputs([tmp_path / "a.csv"])
        claim_file(tmp_path / "a.csv")


def test_a_file_is_taken_away_only_where_it_may_be_replaced(tmp_path):
    (tmp_path / "a.csv").write_text("mine")
    with pytest.raises(WriteError, match="was not written"), guard(EXPORT):
        remove_file(tmp_path / "a.csv")
    with guard(EXPORT, overwrite=True):
        remove_file(tmp_path / "a.csv")
        remove_file(tmp_path / "none.csv")
    assert not (tmp_path / "a.csv").exists()


def test_a_folder_in_which_nothing_came_to_stand_is_not_left(tmp_path):
    with pytest.raises(ZeroDivisionError), guard(EXPORT):
        claim_folder(tmp_path / "a" / "b", "x.csv", mended=("units",))
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())


def test_units_are_replaced_where_the_command_began_them_and_their_page_is_not(tmp_path):
    for text in ("one", "two"):
        with guard("gaitdisc run"):
            claim_folder(tmp_path, mended=("walks",))
            write_whole(tmp_path / "walks" / "walk.json", text)
            write_whole(tmp_path / "walks" / "report.html", text)
        (tmp_path / "walks" / "walk.json").write_text("damaged")
    (tmp_path / "walks" / "report.html").write_text("edited")
    with guard("gaitdisc run"):
        claim_folder(tmp_path, mended=("walks",))
        with pytest.raises(WriteError, match=r"report\.html.*gaitdisc run"):
            write_whole(tmp_path / "walks" / "report.html", "three")


def test_units_of_somebody_else_are_refused_at_once(tmp_path):
    (tmp_path / "walks").mkdir()
    with pytest.raises(WriteError, match=r"walks.*not written by gaitdisc"), guard("gaitdisc run"):
        claim_folder(tmp_path, mended=("walks",))


def test_a_result_saved_before_there_were_lists_is_written_again_but_for_what_was_changed(tmp_path):
    save_discovery(manufactured(), tmp_path)
    (tmp_path / "report.html").write_text("page")
    names = ("discovery.json", "held_out.csv", "report.html")
    with guard("gaitdisc discover"):
        claim_folder(tmp_path, *names)
    (tmp_path / LIST).unlink()
    (tmp_path / "held_out.csv").write_text("changed")
    (tmp_path / "augmented.toml").write_text("changed")
    for name in ("held_out.csv", "augmented.toml"):
        with pytest.raises(WriteError, match=f"{name} already exists and was"), guard("gaitdisc discover"):
            claim_folder(tmp_path, "discovery.json", name)


@pytest.mark.parametrize("text", ['{"own_sha256": "0"}', "{", "[]", seal_text({"sha256": {}})[:-5]])
def test_a_json_file_that_is_not_as_it_was_saved_is_somebody_elses(tmp_path, text):
    (tmp_path / "discovery.json").write_text(text)
    with pytest.raises(WriteError, match=r"discovery\.json"), guard("gaitdisc discover"):
        claim_folder(tmp_path, "discovery.json")


def test_another_process_writes_as_this_command_does(tmp_path):
    (tmp_path / "mine.csv").write_text("mine")
    with guard(EXPORT), ProcessPoolExecutor(1, get_context("spawn")) as pool:
        claim_folder(tmp_path)
        pool.submit(under_this_guard(write_whole), tmp_path / "a.csv", "x").result()
        with pytest.raises(WriteError, match=r"mine\.csv.*not written by gaitdisc"):
            pool.submit(under_this_guard(partial(write_whole)), tmp_path / "mine.csv", "x").result()
    write(tmp_path / "a.csv", "y")


def test_while_a_command_holds_a_folder_another_is_refused(tmp_path):
    (tmp_path / ".lock").write_text(json.dumps({"pid": 1, "host": "elsewhere"}))
    with pytest.raises(WriteError, match="is writing to"), guard(EXPORT):
        claim_folder(tmp_path)


def test_a_link_that_leads_nowhere_is_no_file_of_ours(tmp_path):
    (tmp_path / "a.csv").symlink_to(tmp_path / "none")
    with pytest.raises(WriteError, match=r"a\.csv"):
        write(tmp_path / "a.csv")


def test_an_interrupted_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("old")
    with pytest.raises(KeyboardInterrupt), whole_file(path) as part:
        part.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["table.csv"]


def test_a_full_disk_is_told_and_loses_nothing(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("old")
    with pytest.raises(WriteError, match=r"table.csv.*cannot be written.*left"), whole_file(path):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert path.read_text() == "old"


def test_missing_folders_are_made(tmp_path):
    with whole_file(tmp_path / "a" / "b" / "c.txt") as part:
        part.write_text("new")
    assert (tmp_path / "a" / "b" / "c.txt").read_text() == "new"


def test_a_folder_that_is_a_file_is_told(tmp_path):
    (tmp_path / "a").write_text("")
    with pytest.raises(WriteError, match="choose another folder"), whole_file(tmp_path / "a" / "c.txt"):
        pass


@pytest.mark.parametrize("fails", ["os.fsync", "Path.replace"])
def test_a_disk_that_fills_at_the_last_moment(tmp_path, monkeypatch, fails):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(f"gaitdisc.whole_file.{fails}", full)
    with pytest.raises(WriteError, match=r"a\.txt.*cannot be written.*left"):
        write_whole(path, "new")
    monkeypatch.undo()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_others_may_read_the_file_as_any_other(tmp_path):
    mask = os.umask(0o022)
    try:
        assert write_whole(tmp_path / "a.txt", "x").stat().st_mode & 0o777 == 0o644
    finally:
        os.umask(mask)


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


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match="--out"), write_lock(tmp_path / "file" / "run"):
        pass


def test_a_lock_that_was_never_finished_or_whose_number_another_process_has_by_now_holds_nothing(tmp_path):
    """A container that is started again gives the same numbers to its processes, this one's own among them."""
    numbers = (json.dumps({"pid": pid, "host": socket.gethostname()}) for pid in (os.getpid(), os.getppid()))
    for text in ("", *numbers):
        (tmp_path / ".lock").write_text(text)
        taken(tmp_path)


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
        with pytest.raises(WriteError, match=r"writable and support.*no.*--out"), write_lock(tmp_path, run=True):
            pass
        taken(tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_run_that_fails_frees_its_folder(tmp_path):
    with pytest.raises(ZeroDivisionError), write_lock(tmp_path):
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())
