"""A part runs as a program of its own; here studies of a few lines stand in for the real ones."""

import json

import pytest
from texts import says

from gaitdisc.batch import chapter_run
from gaitdisc.batch.chapter_parts import OUT, Part
from gaitdisc.batch.chapter_run import lack_of, run_part
from gaitdisc.errors import SchemaError, TrainingError, WriteError

WORKS = """
import os, sys
from pathlib import Path
out = Path(sys.argv[1])
(out / "count.txt").open("a").write("x")
if (out / "stop.txt").exists():
    raise ValueError("walk.mot has no strides")
print("| a table |", sys.argv[2:], Path(os.environ["GAITDISC_DATA"]).name)
"""
ONE = Part(3, "one", "made", "a table", 0.1, 0.1)


@pytest.fixture
def studies(tmp_path, monkeypatch):
    folder = tmp_path / "made" / "studies"
    folder.mkdir(parents=True)
    (folder / "made.py").write_text(WORKS)
    monkeypatch.setattr(chapter_run, "studies_folder", lambda: folder)
    return folder


def counted(out):
    return len((out / "one" / "count.txt").read_text())


def test_a_part_is_computed_once_and_kept(studies, tmp_path):
    out, ticks = tmp_path / "out", []
    made = run_part(ONE, out, True, tmp_path / "lab", ticks.append)
    assert (made, ticks != []) == ((out / "one", False), True)
    assert says((made.folder / "printed.md").read_text(), "| a table |", "['--quick'] lab\n")
    assert run_part(ONE, out, True, None) == (out / "one", True)
    assert counted(out) == 1
    assert sorted(path.name for path in made.folder.iterdir()) == ["chapter.json", "count.txt", "printed.md"]


def test_a_part_that_failed_says_why_and_goes_on_in_its_folder(studies, tmp_path):
    out = tmp_path / "out"
    run_part(ONE, out, True, None)
    state = json.loads((out / "one" / "chapter.json").read_text())
    assert state["seconds"] >= 0
    (tmp_path / "two" / "one").mkdir(parents=True)
    with pytest.raises(TrainingError, match=r"ValueError: walk.mot.*no strides.*said.txt"):
        broken = Part(3, "one", "made", "a table", 0.1, 0.1, quick_words=(OUT, "--quick"))
        (studies / "made.py").write_text(WORKS.replace('(out / "stop.txt").exists()', "True"))
        run_part(broken, tmp_path / "two", True, None)
    assert "Traceback" in (tmp_path / "two" / "one" / "said.txt").read_text()
    assert not (tmp_path / "two" / "one" / "printed.md").exists()
    with pytest.raises(TrainingError):  # begun and not finished: it runs again, in what stands there
        run_part(broken, tmp_path / "two", True, None)
    assert counted(tmp_path / "two") == 2


def test_quick_and_whole_and_other_code_never_share_a_folder(studies, tmp_path):
    run_part(ONE, tmp_path, True, None)
    with pytest.raises(SchemaError, match=r"quick.*another folder"):
        run_part(ONE, tmp_path, False, None)
    (studies / "made.py").write_text(WORKS + "\n# another line\n")
    with pytest.raises(SchemaError, match="was begun by other code"):
        run_part(ONE, tmp_path, True, None)


def test_a_folder_of_something_else_is_left_alone(studies, tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "mine.txt").write_text("")
    with pytest.raises(SchemaError, match=r"holds mine\.txt and no chapter\.json"):
        run_part(ONE, tmp_path, True, None)
    assert [path.name for path in (tmp_path / "one").iterdir()] == ["mine.txt"]


def test_what_a_machine_lacks_is_said_with_what_to_do(studies, tmp_path):
    lack = lack_of(ONE._replace(libraries=("json", "nosuchlibrary")), None)
    assert says(str(lack), "chapter 3", "nosuchlibrary", "pip install 'gaitdisc[chapter3]'")
    sea = ONE._replace(data="fields/sea")
    with pytest.raises(SchemaError, match=r"fields/sea.*--data"):
        run_part(sea, tmp_path, True, tmp_path)
    (tmp_path / "fields" / "sea").mkdir(parents=True)
    assert lack_of(sea, tmp_path) is None


def test_two_at_once_do_not_write_into_one_folder(studies, tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / ".lock").write_text('{"pid": 1, "host": "elsewhere"}')
    with pytest.raises(WriteError, match=r"Process 1 on elsewhere"):
        run_part(ONE, tmp_path, True, None)
