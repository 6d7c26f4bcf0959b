"""ezc3d in a process of its own: what comes back, and what is said where the process dies."""

import io
import json
import os
import signal
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from texts import says

from gaitdisc.ingest import reader_process
from gaitdisc.ingest.c3d_layout import find_layout, read_frames
from gaitdisc.ingest.c3d_parameters import read_c3d_header, read_c3d_parameters
from gaitdisc.ingest.reader_process import ReaderProcess, find_limits
from gaitdisc.ingest.reader_worker import answer, points_in_rows, serve


@pytest.fixture
def process():
    one = ReaderProcess()
    yield one
    one.close()


def _request(path, limit_s=60.0):
    return path, "ezc3d", (50, 3, 4, 500), limit_s, 2**40


def test_limits_grow_with_the_file():
    assert find_limits(100 * 2**20) == {"limit_s": 30.0, "cap_bytes": (512 + 1200) * 2**20}


def test_numbers_come_back_and_the_process_is_used_again(tmp_path, write_c3d, some_points, some_analog, process):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    first = process.read(*_request(path))
    pid = process._process.pid
    again = process.read(*_request(path))
    assert process._process.pid == pid
    np.testing.assert_array_equal(first[1][0], again[1][0])
    np.testing.assert_allclose(again[1][1], some_analog.T, rtol=1e-6)


def test_a_dead_process_is_started_anew(tmp_path, write_c3d, some_points, some_analog, process):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    process.read(*_request(path))
    os.kill(process._process.pid, signal.SIGKILL)
    process._process.wait()
    assert process.read(*_request(path))[1][0].shape == (50, 9)


def test_a_process_is_recycled(tmp_path, write_c3d, some_points, some_analog, process, monkeypatch):
    monkeypatch.setattr(reader_process, "FILES_A_PROCESS", 2)
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    pids = []
    for _ in range(4):
        process.read(*_request(path))
        pids.append(process._process.pid)
    assert pids[0] == pids[1] != pids[2] == pids[3]


def test_a_crash_is_said(playing, process):
    playing("os.kill(os.getpid(), signal.SIGSEGV)")
    assert process.read(*_request("a.c3d"))[0]["said"] == "it crashed (exit code -11)"


def test_what_waits_for_ever_is_ended_by_the_clock(playing, process):
    playing("time.sleep(100)")
    assert says(process.read(*_request("a.c3d", limit_s=0.1))[0]["said"], "within 0.6 s")


@pytest.fixture
def reading(monkeypatch, tmp_path):
    """The true worker, with another reader in the place of ezc3d."""

    def read(script: str) -> None:
        worker = tmp_path / "worker.py"
        real = f"sys.path.insert(0, {str(reader_process.WORKER.parent)!r})"
        lines = ["import sys, time", real, "import reader_worker, numpy as np", "def read(path):", script]
        lines += ["    return np.ones((50, 9)), np.ones((4, 500)), None", "reader_worker.read_with_ezc3d = read"]
        worker.write_text("\n".join([*lines, "reader_worker.serve(sys.stdin.buffer, sys.stdout.buffer)"]))
        monkeypatch.setattr(reader_process, "WORKER", worker)

    return read


@pytest.mark.skipif(sys.platform == "win32", reason="the system ends what takes too much processor time")
def test_what_computes_for_ever_is_ended_by_its_processor_time(reading, process, monkeypatch):
    reading("    while True: pass")
    monkeypatch.setattr(reader_process, "CLOCK", 100)  # others may use the machine
    assert says(process.read(*_request("a.c3d", limit_s=1.0))[0]["said"], "1 s", "processor time")


def test_a_file_is_not_refused_because_others_use_the_machine(reading, process):
    """By the clock it takes longer than the processor time that it may; nearly all of that is waiting."""
    reading("    time.sleep(1.5)")
    assert process.read(*_request("a.c3d", limit_s=1.0))[1][0].shape == (50, 9)


@pytest.mark.parametrize("answer", ["print('{\"reader\": \"x\"}'); sys.stdout.write('abc')", "print('hello')"])
def test_an_answer_that_breaks_off_and_babble_are_a_crash(playing, process, answer):
    playing(answer)
    assert process.read(*_request("a.c3d"))[0]["said"].startswith("it crashed")


@pytest.mark.skipif(sys.platform != "linux", reason="address space is capped on Linux")
def test_the_memory_cap_holds(tmp_path, write_c3d, process):
    path = write_c3d(tmp_path / "a.c3d", np.ones((3, 100, 5000)))
    request = path, "ezc3d", (5000, 100, 0, 0), 60
    assert process.read(*request, 150 * 2**20)[0]["said"]  # out of memory, or dead of it
    assert process.read(*request, 2**34)[1][0].shape == (5000, 300)


def test_threads_that_share_a_process_take_turns(tmp_path, write_c3d, some_points, process):
    """A reader that knows of no other took 66 of 240 sound files for broken ones."""
    paths = [write_c3d(tmp_path / f"{n}.c3d", some_points + n) for n in range(4)]

    def read(path):
        return process.read(path, "ezc3d", (50, 3, 0, 0), **find_limits(4096))

    with ThreadPoolExecutor(8) as threads:
        for number, (head, (points, _)) in enumerate(threads.map(read, paths * 15)):
            assert "said" not in head
            np.testing.assert_allclose(points[0, 0], some_points[0, 0, 0] + number % 4, rtol=1e-6)


def test_a_process_ends_with_its_last_user(tmp_path, write_c3d, some_points, some_analog):
    one = ReaderProcess()
    one.read(*_request(write_c3d(tmp_path / "a.c3d", some_points, some_analog)))
    child = one._process
    assert child is not None
    del one
    assert child.returncode is not None


def _asked(path, **changes):
    limits = {"cap_bytes": 2**40, "limit_s": 600.0, "clock_s": 600.0}
    return {"path": str(path), "reader": "ezc3d", "wanted": [50, 3, 4, 500]} | limits | changes


def test_coordinates_come_with_time_first_and_gaps_are_nan():
    points = np.arange(24.0).reshape(3, 2, 4)
    rows = points_in_rows(points, np.array([[0, 0, -1, 0], [0.0, 0, 0, 0]]))
    assert rows.shape == (4, 6)
    np.testing.assert_array_equal(rows[0], [0, 8, 16, 4, 12, 20])
    assert np.isnan(rows[2, :3]).all()
    assert np.isfinite(rows[2, 3:]).all()


def test_both_readers_hand_back_what_was_written(tmp_path, write_c3d, some_points, some_analog):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    head, (points, analog, _) = answer(_asked(path))
    assert head["reader"].startswith("ezc3d")
    file = (header := read_c3d_header(path)), read_c3d_parameters(path, header)
    for x, y in ((points, analog), read_frames(path, *file, find_layout(*file)[0])):
        np.testing.assert_allclose(x, some_points.transpose(2, 1, 0).reshape(50, 9), rtol=1e-6)
        np.testing.assert_allclose(y.T, some_analog, rtol=1e-6)


def test_other_counts_than_expected_are_said(tmp_path, write_c3d, some_points, some_analog):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    head, arrays = answer(_asked(path, wanted=[51, 3, 4, 500]))
    assert list(head) == ["said"] and says(head["said"], "50 frames", "3 points", "500 samples", "4 analog")
    assert not arrays


def test_what_a_reader_raises_is_its_opinion(tmp_path):
    head, _ = answer(_asked(tmp_path / "none", reader="arrays", wanted=[""]))
    assert head["said"].startswith("it stopped with FileNotFoundError")


def test_serving_ends_with_the_requests(tmp_path, write_c3d, some_points, some_analog, monkeypatch):
    monkeypatch.setattr("gaitdisc.ingest.reader_worker._limit", lambda *_: None)  # would cap this very process
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    answers = io.BytesIO()
    serve(io.BytesIO(json.dumps(_asked(path)).encode() + b"\n"), answers)
    head, _, numbers = answers.getvalue().partition(b"\n")
    assert json.loads(head)["reader"].startswith("ezc3d")
    values = np.frombuffer(numbers)
    np.testing.assert_allclose(values[:450].reshape(50, 9)[:, 0], some_points[0, 0], rtol=1e-6)
    np.testing.assert_allclose(values[450:].reshape(500, 4), some_analog.T, rtol=1e-6)
