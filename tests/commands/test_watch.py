"""A laboratory saves trials, slowly; the study takes them up one after the other, and ends by Ctrl-C."""

import itertools
import signal
import subprocess
import sys
import threading
import time

import pytest
from texts import says

from gaitdisc.ingest.study_file import load_study

PIECES, PAUSE_S = 6, 0.25
STILL_S = 4.0  # sixteen pauses: a busy machine may sleep longer than it should


def copied_slowly(source, target):
    """As a network brings a file: a piece, a pause shorter than the one after which files count, another piece."""
    target.parent.mkdir(parents=True, exist_ok=True)
    content = source.read_bytes()
    with target.open("wb") as file:
        for k in range(PIECES):
            file.write(content[k * len(content) // PIECES : (k + 1) * len(content) // PIECES])
            file.flush()
            time.sleep(PAUSE_S)


def waited(true, seconds=300.0):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "waited for nothing"
        time.sleep(0.1)


@pytest.mark.slow
def test_trials_are_taken_up_as_they_are_saved(gait_data, tmp_path):
    people = [gait_data / "young_straight_and_turn" / who for who in ("HC030A", "HC031A")]  # two trials of each
    sources = [next(who.glob(f"{word}/*.c3d")) for who in people for word in ("straight", "turn")]
    names = ("Anna/straight/1.c3d", "Anna/straight/2.c3d", "Zoe/straight/1.c3d")
    lab, clinic = tmp_path / "lab", tmp_path / "clinic"
    lab.mkdir()
    words = [sys.executable, "-m", "gaitdisc", "watch", clinic, "--from", lab, "--still", STILL_S, "--quiet"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    watch = subprocess.Popen([*map(str, words)], **pipes, preexec_fn=_hears_ctrl_c)  # noqa: PLW1509 no thread runs yet
    try:
        index, before = clinic / "run" / "report" / "index.html", {}
        for k, (source, name) in enumerate(zip(sources[:3], names, strict=True)):
            writer = threading.Thread(target=copied_slowly, args=(source, lab / name))
            writer.start()
            while writer.is_alive():  # half a file is in no study
                assert not (clinic / "study.toml").is_file() or name not in (clinic / "study.toml").read_text()
                time.sleep(0.05)
            waited(
                lambda k=k: index.is_file() and _trials(clinic) == k + 1 and index.read_bytes() != before.get("page")
            )
            before["page"] = index.read_bytes()
        anna = next((clinic / "run" / "cycles").glob("P01-*"), None)
        time.sleep(2 * STILL_S)
        unchanged = {path: path.stat().st_mtime_ns for path in anna.iterdir()}
        (lab / "Zoe" / "straight" / "2.c3d").write_bytes(sources[3].read_bytes()[:5000])  # stands still, and is half
        time.sleep(4 * STILL_S)
        copied_slowly(sources[3], lab / "Zoe" / "straight" / "2.c3d")
        waited(lambda: _trials(clinic) == 4 and index.read_bytes() != before["page"])
        assert {path: path.stat().st_mtime_ns for path in anna.iterdir()} == unchanged, "Anna was computed again"
    finally:
        watch.send_signal(signal.SIGINT)
        said, _ = watch.communicate(timeout=60)
    assert watch.returncode == 0, said
    assert "Traceback" not in said and said.rstrip().endswith("Stopped.")
    assert "left out: Zoe/straight/2.c3d" in said and "refused" not in said
    people = {
        one.id: [trial.files[0].split("lab/")[1] for trial in one.trials] for one in load_study(clinic).participants
    }
    assert people == {"P01": list(names[:2]), "P02": ["Zoe/straight/1.c3d", "Zoe/straight/2.c3d"]}


def _hears_ctrl_c():
    """A shell lets what it runs in the background ignore Ctrl-C, these tests too, and they hand it down."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _trials(clinic):
    text = (clinic / "study.toml").read_text() if (clinic / "study.toml").is_file() else ""
    return text.count("[[participants.trials]]")


def test_what_is_refused_and_mended_ends_with_the_code_of_the_last_run(called, tmp_path, monkeypatch):
    """Ctrl-C comes while the folder stands still."""
    lab = tmp_path / "lab"
    (lab / "P01").mkdir(parents=True)
    looks = itertools.count()

    def settled(_):
        if next(looks) > 0:
            raise KeyboardInterrupt
        return {(lab / "P01" / "walk.mot").relative_to(lab): (9, 9)}

    (lab / "P01" / "walk.mot").write_text("half")
    monkeypatch.setattr("gaitdisc.commands.watch.WatchedFolder.settled", settled)
    done = called("watch", tmp_path / "clinic", "--from", lab, ends=1)
    assert "lab must contain recordings" in done.stderr and "[gd-read]" in done.stderr
    assert done.stderr.endswith("Stopped.\n") and not (tmp_path / "clinic" / "study.toml").exists()
    absent = called("watch", tmp_path / "clinic", "--from", tmp_path / "none", ends=1)
    assert says(absent.stderr, "none is not a folder", "Create it")
