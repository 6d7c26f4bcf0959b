"""No command and no `.save` writes onto an input, onto a file of somebody else, or onto one that a user changed."""

import errno
import json
import os
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from made_cycles import made_cycles
from manufactured_discovery import manufactured

import gaitdisc as gd
from gaitdisc.channel import Channel
from gaitdisc.cli import COMMANDS
from gaitdisc.commands.options import ENDED, REFUSED
from gaitdisc.discovery.folder import load_discovery, save_discovery
from gaitdisc.errors import WriteError
from gaitdisc.own_files import KINDS, LIST
from gaitdisc.recording import Recording, Source
from gaitdisc.saved import kind as kinds
from gaitdisc.saved.kind import Saved
from gaitdisc.saved.provenance import Provenance
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation_file import parse_simulation
from gaitdisc.whole_file import whole_file, write_together, write_whole

MINE = "a file of my own\n"
STUDY = """[conditions]
nominal = "nominal"
device = "exo"
[[participants]]
id = "P1"
[[participants.trials]]
condition = "nominal"
files = ["w.mot"]
"""
UNITS = ("run.json", "walks", "responses", "tests", "report/report.html")
DISCOVERED = ("discovery.json", "held_out.csv", "augmented.toml", "report.html")
WRITE_NOTHING = {"check", "doctor"}
for _reader in kinds.KINDS.values():
    import_module(_reader.partition(":")[0])

# command -> words, with OUT where an output stands, and what it writes there: a name in OUT, or OUT itself
WRITE = {
    "new": (("new", "OUT", "--from", "recordings"), ("study.toml",)),
    "new MODEL": (("new", "OUT.toml", "--from", "leg.xml"), (".",)),
    "angles": (("angles", "w.mot", "--static", "s.mot", "--out", "OUT.csv"), (".",)),
    "moments": (("moments", "w.mot", "--static", "s.mot", "--out", "OUT.mot"), (".",)),
    "compare": (("compare", "w.mot", "s.mot", "--out", "OUT"), ("mismatch.json", "regions.csv", "report.html")),
    "discover": (("discover", "m.toml", "t.csv", "--out", "OUT"), DISCOVERED),
    "discover STUDY": (("discover", "study", "--participant", "P1", "--out", "OUT"), DISCOVERED),
    "discover ALL": (("discover", "study", "--participant", "all", "--out", "OUT"), ("people.csv",)),
    "reconstruct": (("reconstruct", "study", "--out", "OUT"), ("reconstruction.json", "errors.csv", "models")),
    "apply": (("apply", "model", "w.mot", "--out", "OUT.mot"), (".",)),
    "run": (("run", "study", "--out", "OUT"), UNITS),
    "watch": (("watch", "study", "--from", "recordings"), tuple(f"../study/run/{name}" for name in UNITS)),
    "ablate": (("ablate", "study", "--out", "OUT"), UNITS),
    "modalities": (("modalities", "study", "--out", "OUT"), (*UNITS, "modalities/report.html")),
    "sensitivity": (("sensitivity", "study", "--out", "OUT"), (*UNITS, "sensitivity/report.html")),
    "reference": (("reference", "study", "--out", "OUT"), ("reference.json",)),
    "report": (("report", "found"), ("../found/report.html",)),
    "export": (("export", "w.mot", "--out", "OUT.csv"), (".",)),
    "export RUN": (("export", "run", "--out", "OUT"), ("cycles.csv", "means.csv")),
    "export MODEL": (("export", "model", "--out", "OUT.onnx"), (".",)),
    "cite": (("cite", "found", "--out", "OUT.bib"), (".",)),
    "demo": (("demo", "OUT"), ("study.toml", "raw", "truth", "run/run.json", "run/report/report.html")),
    "demo --clinic": (("demo", "OUT", "--clinic"), ("planted.json", "controls/study.toml", "week")),
    "chapter": (("chapter", "3", "OUT", "--part", "tables", "--quick"), ("tables/chapter.json",)),
}
# command -> words in which one file is input and output, and that file
ONTO_AN_INPUT = {
    "angles": (("angles", "w.mot", "--static", "s.mot", "--out", "s.mot"), "s.mot"),
    "moments": (("moments", "w.mot", "--static", "s.mot", "--out", "w.mot"), "w.mot"),
    "compare": (("compare", "w.mot", "regions.csv", "--out", "."), "regions.csv"),
    "discover DATA": (("discover", "m.toml", "held_out.csv", "--out", "."), "held_out.csv"),
    "discover MODEL": (("discover", "augmented.toml", "t.csv", "--out", "."), "augmented.toml"),
    "apply": (("apply", "model", "w.mot", "--out", "w.mot"), "w.mot"),
    "apply MODEL": (("apply", "model", "w.mot", "--out", "model/model.json"), "model/model.json"),
    "export": (("export", "w.mot", "s.mot", "--out", "s.mot", "--rate", "10"), "s.mot"),
    "cite": (("cite", "found", "--out", "found/discovery.json"), "found/discovery.json"),
}


@pytest.fixture
def lab(tmp_path, monkeypatch):
    """A folder of small inputs; none of them is read before an output is refused, but for those that say where."""
    monkeypatch.chdir(tmp_path)
    for name in ("w.mot", "s.mot", "m.toml", "t.csv", "leg.xml", "held_out.csv", "augmented.toml", "regions.csv"):
        Path(name).write_text(f"input {name}\n")
    for name in ("recordings", "study", "model", "run"):
        Path(name).mkdir()
    Path("recordings/w.mot").write_text("input\n")
    Path("study/study.toml").write_text(STUDY)
    write_whole("model/model.json", "{}")
    manufactured().save("found")
    return tmp_path


def run_once(_):
    yield [Path("w.mot")]


@pytest.fixture
def refused_words(monkeypatch, called):
    """The one line that a command prints which is refused; `watch` looks once."""
    monkeypatch.setattr("gaitdisc.commands.watch.WatchedFolder.changes", run_once)
    monkeypatch.setattr("gaitdisc.commands.watch._grow_study", lambda *_: [])
    return lambda *words: " ".join(called(*words, ends=REFUSED).stderr.split())


def contents(folder):
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_every_command_stands_in_the_table():
    assert set(COMMANDS) == {name.split()[0] for name in WRITE} | WRITE_NOTHING


FOREIGN = [(name, file) for name, (_, files) in WRITE.items() for file in files]


@pytest.mark.parametrize(("name", "file"), FOREIGN, ids=map(" ".join, FOREIGN))
def test_a_file_of_somebody_else_is_left_as_it_is(lab, refused_words, name, file):
    words = WRITE[name][0]
    out = next((word for word in words if word.startswith("OUT")), "OUT")
    mine = Path(os.path.normpath(Path(out) / file))
    if not mine.suffix:  # a folder
        mine /= "notes.txt"
    if name == "export RUN":
        shutil.rmtree("run")
        gd.ResponseRun("", "", "", (), Provenance({}, 0, {}, {}, "", ""), {"cycles.json": (made_cycles(),)}).save("run")
    mine.parent.mkdir(parents=True, exist_ok=True)
    mine.write_text(MINE)
    before = contents(lab)
    said = refused_words(*words)
    assert contents(lab) == before
    assert mine.name in said or mine.parent.name in said, said
    if name != "chapter":  # which has a rule of its own: its folder is another one, or deleted
        assert "was not written by gaitdisc" in said and "or use --overwrite." in said


@pytest.mark.parametrize("name", ONTO_AN_INPUT)
@pytest.mark.parametrize("by", ["its name", "..", "a hard link", "a symbolic link"])
def test_an_input_is_left_as_it_is_whatever_is_said(lab, refused_words, name, by):
    words, file = ONTO_AN_INPUT[name]
    if by == "..":
        words = [f"../{lab.name}/{word}" if word == file else word for word in words]
    elif by != "its name":
        Path("true").mkdir()
        true = shutil.copy(file, "true")
        Path(file).unlink()
        (os.link if by == "a hard link" else os.symlink)(Path(true).absolute(), file)
        given = words.index(file)
        words = [true if k == given and words.count(file) > 1 else word for k, word in enumerate(words)]
    before = contents(lab)
    said = refused_words(*words, "--overwrite")
    assert contents(lab) == before
    assert f"{Path(file).name} is an input of gaitdisc" in said or "another kind of result" in said


def test_what_the_same_command_wrote_is_replaced_until_a_user_changes_it(tmp_path, monkeypatch, called):
    monkeypatch.chdir(tmp_path)
    gd.write(wave(), "w.mot")
    shutil.copy("w.mot", "mine.mot")
    for words in (
        ["export", "mine.mot", "--out", "x.csv"],
        ["new", "study", "--from", "."],
        ["export", "mine.mot", "--out", "x.csv"],
    ):
        called(*words, ends=0)
    called("new", "study", "--from", ".", ends=0)
    Path("x.csv").write_text(Path("x.csv").read_text() + "0\n")
    called("export", "mine.mot", "--out", "x.csv", ends=REFUSED)
    called("export", "mine.mot", "--out", "x.csv", "--overwrite", ends=0)
    called("export", "x.csv", "--out", "x.csv", "--overwrite", ends=REFUSED)
    called("angles", "mine.mot", "--out", "x.csv", ends=REFUSED)


def test_a_page_is_drawn_again_by_report_until_a_user_changes_it(tmp_path, monkeypatch, called, unpainted):
    monkeypatch.chdir(tmp_path)
    save_discovery(manufactured(), Path("found"))  # as before there were lists
    for _ in range(2):
        called("report", "found", ends=0)
    page = Path("found/report.html")
    page.write_text(page.read_text() + MINE)
    called("report", "found", ends=REFUSED)
    assert page.read_text().endswith(MINE)


def wave():
    time = np.arange(200) / 100.0
    channel = Channel("knee_angle_r", "angle", "deg", "r")
    return Recording(time, 30 * np.sin(6 * time)[:, None], (channel,), "", "", Source("", "", ""))


def test_each_kind_of_result_has_its_json_file():
    assert set(kinds.KINDS) == set(KINDS)


@pytest.mark.parametrize("kind", Saved.__subclasses__(), ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("name", KINDS)
def test_save_replaces_nothing_that_save_did_not_write(tmp_path, monkeypatch, kind, name):
    def write(_, folder):
        write_whole(folder / "table.csv", "new")
        write_whole(folder / name, "{}")

    monkeypatch.setitem(kinds.KINDS, kind._file, "planted:KIND")
    monkeypatch.setattr(kinds, "load_word", lambda _: kinds.Kind(kind, name, write=write))
    result = object.__new__(kind)
    for _ in range(2):
        result.save(tmp_path / "own")
    for file in ("table.csv", name):
        folder = tmp_path / f"foreign {file}"
        folder.mkdir()
        (folder / file).write_text(MINE)
        with pytest.raises(WriteError, match=r"not written by \.save.*overwrite=True"):
            result.save(folder)
        assert {path.name for path in folder.iterdir()} == {file}
        assert (folder / file).read_text() == MINE
        result.save(folder, overwrite=True)
        assert (folder / file).read_text() != MINE
    other = next(one for one in KINDS if one != name)
    folder = tmp_path / "another kind"
    folder.mkdir()
    (folder / other).write_text("{}")
    for overwrite in (False, True):
        with pytest.raises(WriteError, match=f"another kind of result \\({other}\\)"):
            result.save(folder, overwrite=overwrite)
    assert [path.name for path in folder.iterdir()] == [other]


def write_walks(path, **how):
    gd.example_files(path.parent, 5.0, **how)
    return path.with_name("exo.c3d")


@pytest.mark.parametrize(
    ("write", "name"),
    [
        (lambda path, **how: gd.write(wave(), path, **how), "w.mot"),
        (lambda path, **how: gd.write(wave(), path, **how), "w.parquet"),
        (lambda path, **how: gd.write_simulation(decay(), path, **how), "m.toml"),
        (write_walks, "exo.c3d"),
    ],
)
def test_what_writes_in_python_replaces_its_own_files_alone(tmp_path, write, name):
    path = write(tmp_path / "own" / name)
    assert write(tmp_path / "own" / name) == path
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(WriteError, match=rf"{name} .*changed after gd\.\w+.*overwrite=True"):
        write(path)
    write(path, overwrite=True)
    other = tmp_path / "other" / name
    other.parent.mkdir()
    other.write_text(MINE)
    with pytest.raises(WriteError, match=rf"{name} .*not written by gd\.\w+"):
        write(other)
    assert contents(other.parent) == {other: MINE.encode()}


def decay():
    model = parse_simulation('[states.x]\nunit = "1"\n[equations]\nx = "-x"\n')
    return model.with_effect(Term("x", "equation", "constant_load", "0.5"))


def test_after_a_full_disk_the_earlier_result_stands_whole(tmp_path, monkeypatch):
    def save(text, **changes):
        with write_together():
            name = write_whole(tmp_path / "augmented.toml", text).name
            save_discovery(manufactured(**changes), tmp_path, [name])

    save("old")
    before, plain = contents(tmp_path), os.fsync
    assert set(json.loads((tmp_path / "discovery.json").read_text())["sha256"]) == {"held_out.csv", "augmented.toml"}
    for room in range(3):
        left = iter(range(room))

        def full(handle, left=left):
            if next(left, None) is None:
                raise OSError(errno.ENOSPC, "No space left on device")
            plain(handle)

        with monkeypatch.context() as disk:
            disk.setattr(os, "fsync", full)
            with pytest.raises(WriteError, match="No space left on device"):
                save("new", sentence="Another answer.")
        assert contents(tmp_path) == before
    save("new", sentence="Another answer.")
    assert load_discovery(tmp_path).sentence == "Another answer."
    (tmp_path / "augmented.toml").write_text("changed")
    with pytest.raises(gd.GaitdiscError, match=r"augmented\.toml has changed"):
        load_discovery(tmp_path)


def test_a_command_that_is_ended_leaves_no_half_file(tmp_path):
    code = (
        "import sys, time; from pathlib import Path; from gaitdisc import cli\n"
        "from gaitdisc.whole_file import whole_file\n"
        "def slow(out: Path) -> None:\n"
        "    with whole_file(out) as part:\n"
        "        part.write_text('half'); print('writing', flush=True); time.sleep(60)\n"
        "cli.app.command()(cli._guard(slow)); sys.argv = ['gaitdisc', 'slow', sys.argv[1]]; cli.main()"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "new" / "x.csv")], stdout=-1, text=True)
    assert process.stdout and process.stdout.readline() == "writing\n"
    process.terminate()
    assert process.wait(30) == ENDED
    assert not list(tmp_path.iterdir())


def test_files_are_never_open_to_more_people_than_the_mask_says(tmp_path, monkeypatch):
    """The mask of a process is that of all its threads."""
    monkeypatch.setattr(os, "umask", lambda _: pytest.fail("the mask was changed"))
    with whole_file(tmp_path / "a.csv") as part:
        part.write_text("1")
        (tmp_path / "plain").touch()
        assert part.stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_a_list_that_cannot_be_read_makes_no_file_ours(tmp_path):
    path = gd.write(wave(), tmp_path / "w.mot")
    (tmp_path / LIST).write_bytes(b"\xff no list\n")
    with pytest.raises(WriteError, match="was not written by"):
        gd.write(wave(), path)
