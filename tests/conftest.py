"""A command line as a person calls it; where real recordings lie, and the skip where they do not."""

import gc
import hashlib
import io
import os
import pickle
import signal
import sys
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from functools import cache, partial
from pathlib import Path
from subprocess import CompletedProcess
from unittest.mock import patch

import jinja2
import pytest
import typer.main
from hypothesis import settings

from gaitdisc.cli import main
from gaitdisc.ingest import array_file, c3d, hdf5, reader_process

# An example may take as long as it does: no test rests on how busy this machine is.
# By default few are drawn; `make elsewhere` draws as many as hypothesis does.
settings.register_profile("few", deadline=None, max_examples=30)
settings.register_profile("many", deadline=None)
settings.load_profile("few")

PROJECT = Path(__file__).parents[1]
gc.disable()  # while tests are collected: what is imported stays


def pytest_collection_finish():
    """Look for garbage seldom, and never in what was imported: else a tenth of the time goes there."""
    gc.freeze()
    gc.enable()
    gc.set_threshold(20_000, 20, 20)


class _LastingReader(reader_process.ReaderProcess):
    def close(self) -> None:
        """The next test reads with it too."""


@pytest.fixture(scope="session", autouse=True)
def one_reader_for_all_files():
    """To start a process takes longer than to read most files; another program or folder gets its own."""
    started, lasting = reader_process.ReaderProcess, _LastingReader()
    usual = reader_process.WORKER, Path.cwd()

    def given():
        return lasting if usual == (reader_process.WORKER, Path.cwd()) else started()

    with pytest.MonkeyPatch.context() as patch:
        for module in (array_file, c3d, hdf5):
            patch.setattr(module, "ReaderProcess", given)
        yield
    started.close(lasting)


def _remembered(compute):
    """What a function of these very values gave before; a caller may change the lists and dicts of its own copy."""
    known = {}

    def once(*given):
        key = hashlib.sha256(pickle.dumps(given)).digest()
        if key not in known:
            known[key] = pickle.dumps(compute(*given))
        return pickle.loads(known[key])

    return once


@pytest.fixture(scope="session", autouse=True)
def what_all_tests_share_is_made_once(tmp_path_factory):
    """The tree of commands, templates, what a simulated leg has learnt, exchanged labels, the period of an angle.

    A disk and chance are asked less: no test ends the power, and groups of people are held against 39 clouds.
    """
    from gaitdisc.cohort import walk
    from gaitdisc.kinematics import motion
    from gaitdisc.response import over_participants
    from gaitdisc.signals import contact_movement, strides

    period = _remembered(strides.stride_period)
    compiled = jinja2.FileSystemBytecodeCache(str(tmp_path_factory.mktemp("templates")))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(typer.main, "get_command", cache(typer.main.get_command))
        patch.setattr(os, "fsync", lambda _: None)
        patch.setattr(over_participants, "find_groups", partial(over_participants.find_groups, clouds=39))
        patch.setattr(jinja2, "Environment", partial(jinja2.Environment, bytecode_cache=compiled))
        patch.setattr(walk, "learnt_table", _remembered(walk.learnt_table))
        patch.setattr(motion, "find_exchanged_pairs", _remembered(motion.find_exchanged_pairs))
        patch.setattr(strides, "stride_period", period)
        patch.setattr(contact_movement, "stride_period", period)
        yield


@pytest.fixture(scope="session")
def called():
    """Exit code and everything printed, with refusals printed as `main` prints them; tests/test_cli.py starts anew.

    ends: exit code that the command must end with; any where absent
    """

    def call(*words, ends=None):
        arguments, out, err = ["gaitdisc", *map(str, words)], io.StringIO(), io.StringIO()
        before = signal.getsignal(signal.SIGTERM)
        with patch.object(sys, "argv", arguments), redirect_stdout(out), redirect_stderr(err):
            try:
                main()
                code = 0
            except SystemExit as end:
                code = end.code
            finally:
                signal.signal(signal.SIGTERM, before)
        done = CompletedProcess(arguments, code, out.getvalue(), err.getvalue())
        assert ends in (None, code), (done.stdout, done.stderr)
        assert "Traceback" not in done.stdout + done.stderr
        return done

    return call


@pytest.fixture(scope="session")
def said(called):
    """All that a command prints that ends with this code, on one line."""

    def say(*words, ends):
        done = called(*words, ends=ends)
        return " ".join(f"{done.stdout} {done.stderr}".split())

    return say


@pytest.fixture(scope="session")
def gait_data() -> Path:
    """Folder of real gait recordings: ../shared/data/gait, or GAITDISC_DATA/gait."""
    data = Path(os.environ.get("GAITDISC_DATA", PROJECT.parent / "shared" / "data"))
    folder = data / "gait"
    if not folder.is_dir():
        pytest.skip(f"real recordings are absent: {folder} (set GAITDISC_DATA)")
    return folder


@pytest.fixture(scope="session")
def briefly():
    """Return a context in which networks take two passes over their samples: for what several tests share."""

    @contextmanager
    def brief(painted=True):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("gaitdisc.models.training_settings.count_epochs", lambda *_: 2)
            if not painted:
                _unpaint(patch, drawn=False)
            yield

    return brief


@pytest.fixture
def trained_briefly(briefly):
    """Networks take two passes over their samples: for tests of what is made of a network, not of what it learns.

    In this process only: one that is started beside it trains whole.
    """
    with briefly():
        yield


def _unpaint(patch, drawn=True):
    patch.setattr("gaitdisc.report.figure._svg", lambda _: b"<svg/>")
    patch.setattr("gaitdisc.report.figure._png", lambda _: b"")
    for figures in () if drawn else ("draw_held_out", "residual_figures", "curves_figures"):
        patch.setattr(f"gaitdisc.response.page.{figures}", lambda *_: [])


@pytest.fixture
def unpainted(monkeypatch):
    """Figures are laid out and not painted, most of the time of a report: for tests of what a page says."""
    _unpaint(monkeypatch)


@pytest.fixture
def undrawn(monkeypatch):
    """Nor are those of a participant laid out: for tests of what becomes of a run, not of its page."""
    _unpaint(monkeypatch, drawn=False)
