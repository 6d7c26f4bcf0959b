"""A clinic's pages and references, whole files whatever stops their writing."""

import errno
import os
import random
import shutil
import signal
import stat
import subprocess
import sys
import time
from unittest.mock import patch

import pytest
from made_clinic import SOURCE, made_controls, made_person, made_run, published_table, written_table
from texts import says

from gaitdisc.clinic.clinical_reference import PersonSession, load_reference, save_reference
from gaitdisc.clinic.run_pages import (
    before_and_after,
    cycles_of_people,
    keep_reference,
    load_kept_reference,
    read_session,
    write_people,
)
from gaitdisc.commands.run_report import say_new_recordings
from gaitdisc.errors import SchemaError, WriteError
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.response.participant_response import load_run
from gaitdisc.saved.provenance import Refusal
from gaitdisc.whole_file import PART


def test_a_person_whose_page_fails_costs_nobody_else(tmp_path):
    from gaitdisc.clinic import run_pages

    real = run_pages.write_person_page

    def failing(person, *others, **pdf):
        if person.title == "P02":
            raise ValueError(f"P02: {tmp_path}/cycles/P02")
        return real(person, *others, **pdf)

    run = made_run(made_person("P01"), made_person("P02"), refusals=(Refusal("P03", "", "unread"),))
    with patch.object(run_pages, "write_person_page", failing):
        index = write_people(run, tmp_path)
    text = index.read_text(encoding="utf-8")
    assert index == tmp_path / "report" / "index.html"
    assert str(tmp_path) not in text
    assert says(text, "P02", "run/cycles/P02") and "unread" in text
    assert [path.name for path in sorted((tmp_path / "report" / "people").glob("*.html"))] == ["P01.html"]


def test_new_cycles_of_a_person_cost_the_page_of_that_person(tmp_path):
    first = made_run(made_person("P01"), made_person("P02"))
    longer = made_run(made_person("P01"), made_person("P02", each=5))
    people = tmp_path / "report" / "people"

    def drawn(run):
        pages = []
        index = write_people(run, tmp_path, progress=pages.append)
        assert says(index.read_text(encoding="utf-8"), "2 people", "P01.html", "P02.html")
        return [page.stem for page in pages]

    assert [drawn(run) for run in (first, first, longer)] == [["P01", "P02"], [], ["P02"]]
    (people / "P01.html").write_text("another", encoding="utf-8")
    (tmp_path / "clinic.toml").write_text('[people.P02]\ncomment = "cane"\n', encoding="utf-8")
    assert drawn(longer) == ["P01", "P02"] and "cane" in (people / "P02.html").read_text(encoding="utf-8")


def test_recordings_that_the_study_does_not_name_are_counted_by_pseudonym_and_not_named(tmp_path, capsys):
    for name in ("anna/w1.c3d", "anna/w2.c3d", "anna/w3.C3D", "anna/notes.txt", "bob/w1.c3d"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    people = [
        Participant(id=who, trials=(PlannedTrial(condition="walk", files=(f"{folder}/w1.c3d",)),))
        for who, folder in (("P01", "anna"), ("P02", "bob"))
    ]
    say_new_recordings(Study(conditions=Conditions(nominal="walk"), participants=tuple(people)).placed(tmp_path))
    said = capsys.readouterr().err
    assert says(said, "New recordings", "2 in the folder of P01", "gaitdisc watch") and "P02" not in said
    assert "anna" not in said and "w2" not in said


def test_recordings_of_somebody_new_beside_the_others_are_counted(tmp_path, capsys):
    for name in ("anna/w1.c3d", "anna/later/w4.c3d", "bob/w1.c3d", "carl/w1.c3d"):
        (tmp_path / "recordings" / name).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / "recordings" / name).write_bytes(b"")
    people = [
        Participant(id=who, trials=(PlannedTrial(condition="walk", files=(f"../recordings/{folder}/w1.c3d",)),))
        for who, folder in (("P01", "anna"), ("P02", "bob"))
    ]
    study = Study(conditions=Conditions(nominal="walk"), participants=tuple(people))
    say_new_recordings(study.placed(tmp_path / "study"))
    said = capsys.readouterr().err
    assert says(said, "1 in another folder", "1 in the folder of P01") and "carl" not in said


def test_a_reference_stays_with_the_run(tmp_path):
    save_reference(made_controls(3), tmp_path / "ref")
    assert load_kept_reference(tmp_path / "run") is None
    keep_reference(tmp_path / "ref", tmp_path / "run")
    keep_reference(None, tmp_path / "run")
    assert load_kept_reference(tmp_path / "run").people("walk") == 3


def test_a_run_without_cycles_has_no_pages_of_people(tmp_path):
    assert write_people(made_run(), tmp_path) is None
    assert list(tmp_path.iterdir()) == []


def test_a_published_reference_stays_as_its_table_until_another_takes_its_place(tmp_path):
    run = made_run(made_person("P01"))
    run.save(tmp_path / "run")
    keep_reference(written_table(tmp_path, published_table()), tmp_path / "run")
    index = write_people(run, tmp_path / "run")
    assert SOURCE[2:] in index.read_text() and SOURCE[2:] in (index.parent / "people" / "P01.html").read_text()
    save_reference(made_controls(3), tmp_path / "ref")
    keep_reference(tmp_path / "ref", tmp_path / "run")
    assert load_kept_reference(tmp_path / "run").published == ()


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("controls") / "run"
    made_run(made_person("C1", group="control"), made_person("C2", group="control"), made_person("P1")).save(folder)
    return folder


def test_controls_of_a_run_become_one_file(called, run_folder, tmp_path):
    done = called("reference", run_folder, "--out", tmp_path, "--group", "control", ends=0)
    assert says(done.stdout, "walk: 2 people, 4 legs;", "fewer", "5", "no deviation")
    assert load_reference(tmp_path).people("walk") == 2


def test_a_group_that_nobody_is_of_is_refused(called, run_folder, tmp_path):
    done = called("reference", run_folder, "--out", tmp_path, "--group", "td", ends=1)
    assert says(done.stderr, "controls of group 'td'") and "has control, no group" in done.stderr


KILLS = 12
# Everything imported once; each order draws the pages in a child of its own.
SERVER = """
import os, sys
from pathlib import Path
import gaitdisc.clinic.person_page, gaitdisc.clinic.reading
from gaitdisc.clinic.run_pages import write_people
from gaitdisc.response.participant_response import load_run
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
    assert codes == [0] and {path.suffix for path in whole} == {".html", ".pdf", ".csv", ".json"}
    saved(tmp_path / "killed")
    chance, kills = random.Random(4), 0
    for _ in range(4 * KILLS):
        shutil.rmtree(tmp_path / "killed" / "report", ignore_errors=True)  # parts that stand are not drawn again
        (code,), _ = server(tmp_path / "killed", killed_after_s=chance.uniform(0, 0.8 * seconds))
        there = pages(tmp_path / "killed")
        assert there == {path: whole[path] for path in there}
        kills += code == -signal.SIGKILL
        if kills == KILLS:
            break
    assert kills == KILLS
    codes, _ = server(tmp_path / "killed", 8)
    assert codes == [0] * 8 and pages(tmp_path / "killed") == whole


def test_without_typst_pages_stand_and_one_sentence_names_the_extra(called, run_folder, monkeypatch, caplog):
    monkeypatch.setitem(sys.modules, "typst", None)
    refused = called("report", run_folder, "--pdf", ends=1)
    assert says(refused.stderr, "PDF requires", "typst", "not installed", "pip install 'gaitdisc[pdf]'")
    (run_folder / "clinic.toml").write_text("pdf = true\n", encoding="utf-8")
    write_people(load_run(run_folder), run_folder)
    assert [text for text in caplog.messages if "gaitdisc[pdf]" in text] == [
        "Pages are written without PDF: PDF requires the package typst. Install it: pip install 'gaitdisc[pdf]'."
    ]
    assert {path.suffix for path in (run_folder / "report" / "people").glob("P1*")} == {"", ".html"}


def test_one_page_a_person_and_session_the_first_condition_first():
    run = made_run(made_person(condition="turn"), made_person(), made_person("P02", session="before"))
    people = cycles_of_people(run)
    assert list(people) == ["P01", "P02 before"]
    found = {title: read_session(title, own, run.nominal, made_controls(6)) for title, own in people.items()}
    assert [one.pooled.condition for one in found["P01"].readings] == ["walk", "turn"]
    assert len(found["P01"].contrasts) == 1 and isinstance(found["P02 before"], PersonSession)


def test_before_and_after_are_found_by_their_words():
    run = made_run(made_person(session="s1"), made_person(session="s2"), made_person(session="s2", condition="fast"))
    for words in (("s1", "s2"), ("walk", "fast")):
        found = before_and_after(run, None, "P01", words)
        second, first = found.readings
        assert found.before_after is not None and found.before_after.first is first
        assert words[0] in first.pooled.where and words[1] in second.pooled.where
    with pytest.raises(SchemaError, match=r"s1 walk, s2 walk, s2.*fast"):
        before_and_after(run, None, "P01", ("s1", "s3"))
    with pytest.raises(SchemaError, match=r"kept cycles.*'P07'.*one of: P01"):
        before_and_after(run, None, "P07", ("s1", "s2"))
