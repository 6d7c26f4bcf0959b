"""Which files a command may replace; every command and every `.save`: tests/promises/test_nothing_is_lost.py."""

import json
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import pytest
from manufactured_discovery import manufactured

from gaitdisc.errors import WriteError
from gaitdisc.own_files import LIST, claim_file, claim_folder, guarded, note_inputs, under_this_guard
from gaitdisc.results.discovery_folder import save_discovery
from gaitdisc.results.sealed_json import sealed_text
from gaitdisc.whole_file import remove_file, write_whole

EXPORT, REPORT = "gaitdisc export", "gaitdisc report"


def write(path, text="x", command=EXPORT, **how):
    with guarded(command, **how):
        write_whole(path, text)


def test_the_list_names_each_file_with_its_hash_and_command(tmp_path):
    write(tmp_path / "a b.csv", "abc")
    write(tmp_path / "a b.csv", "abc")
    line = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  gaitdisc export  a b.csv\n"
    assert (tmp_path / LIST).read_text() == line
    assert {path.name for path in tmp_path.iterdir()} == {LIST, "a b.csv"}


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
    with (
        pytest.raises(WriteError, match=r"a\.csv.*Choose another output"),
        guarded(EXPORT),
    ):
        note_inputs([tmp_path / "a.csv"])
        claim_file(tmp_path / "a.csv")


def test_a_file_is_taken_away_only_where_it_may_be_replaced(tmp_path):
    (tmp_path / "a.csv").write_text("mine")
    with pytest.raises(WriteError, match="was not written"), guarded(EXPORT):
        remove_file(tmp_path / "a.csv")
    with guarded(EXPORT, overwrite=True):
        remove_file(tmp_path / "a.csv")
        remove_file(tmp_path / "none.csv")
    assert not (tmp_path / "a.csv").exists()


def test_a_folder_in_which_nothing_came_to_stand_is_not_left(tmp_path):
    with pytest.raises(ZeroDivisionError), guarded(EXPORT):
        claim_folder(tmp_path / "a" / "b", "x.csv", mended=("units",))
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())


def test_units_are_replaced_where_the_command_began_them_and_their_page_is_not(tmp_path):
    for text in ("one", "two"):
        with guarded("gaitdisc run"):
            claim_folder(tmp_path, mended=("walks",))
            write_whole(tmp_path / "walks" / "walk.json", text)
            write_whole(tmp_path / "walks" / "report.html", text)
        (tmp_path / "walks" / "walk.json").write_text("damaged")
    (tmp_path / "walks" / "report.html").write_text("edited")
    with guarded("gaitdisc run"):
        claim_folder(tmp_path, mended=("walks",))
        with pytest.raises(WriteError, match=r"report\.html.*changed since gaitdisc run"):
            write_whole(tmp_path / "walks" / "report.html", "three")


def test_units_of_somebody_else_are_refused_at_once(tmp_path):
    (tmp_path / "walks").mkdir()
    with pytest.raises(WriteError, match=r"walks.*not written by gaitdisc"), guarded("gaitdisc run"):
        claim_folder(tmp_path, mended=("walks",))


def test_a_result_saved_before_there_were_lists_is_written_again_but_for_what_was_changed(tmp_path):
    save_discovery(manufactured(), tmp_path)
    (tmp_path / "report.html").write_text("page")
    names = ("discovery.json", "held_out.csv", "report.html")
    with guarded("gaitdisc discover"):
        claim_folder(tmp_path, *names)
    (tmp_path / LIST).unlink()
    (tmp_path / "held_out.csv").write_text("changed")
    (tmp_path / "augmented.toml").write_text("changed")
    for name in ("held_out.csv", "augmented.toml"):
        with pytest.raises(WriteError, match=f"{name} exists and was"), guarded("gaitdisc discover"):
            claim_folder(tmp_path, "discovery.json", name)


@pytest.mark.parametrize("text", ['{"own_sha256": "0"}', "{", "[]", sealed_text({"sha256": {}})[:-5]])
def test_a_json_file_that_is_not_as_it_was_saved_is_somebody_elses(tmp_path, text):
    (tmp_path / "discovery.json").write_text(text)
    with pytest.raises(WriteError, match=r"discovery\.json exists and was not"), guarded("gaitdisc discover"):
        claim_folder(tmp_path, "discovery.json")


def test_another_process_writes_as_this_command_does(tmp_path):
    (tmp_path / "mine.csv").write_text("mine")
    with guarded(EXPORT), ProcessPoolExecutor(1, get_context("spawn")) as pool:
        claim_folder(tmp_path)
        pool.submit(under_this_guard(write_whole), tmp_path / "a.csv", "x").result()
        with pytest.raises(WriteError, match=r"mine\.csv.*not written by gaitdisc"):
            pool.submit(under_this_guard(partial(write_whole)), tmp_path / "mine.csv", "x").result()
    write(tmp_path / "a.csv", "y")


def test_while_a_command_holds_a_folder_another_is_refused(tmp_path):
    (tmp_path / ".lock").write_text(json.dumps({"pid": 1, "host": "elsewhere"}))
    with pytest.raises(WriteError, match="is writing to"), guarded(EXPORT):
        claim_folder(tmp_path)


def test_a_link_that_leads_nowhere_is_no_file_of_ours(tmp_path):
    (tmp_path / "a.csv").symlink_to(tmp_path / "none")
    with pytest.raises(WriteError, match=r"a\.csv exists and was not"):
        write(tmp_path / "a.csv")
