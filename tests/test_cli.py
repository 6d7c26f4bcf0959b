import os
import signal
import subprocess
import sys
from importlib import import_module

import pytest
from fresh_process import modules_loaded_by

from gaitdisc.cli import COMMANDS

USAGE = 2


def called(*words):
    return subprocess.run(
        [sys.executable, "-m", "gaitdisc", *map(str, words)], capture_output=True, text=True, check=False
    )


def test_a_typo_is_exit_code_2_with_a_suggestion():
    done = called("chekc")
    assert done.returncode == USAGE
    assert "check" in done.stderr


def test_version():
    assert called("--version").stdout.startswith("gaitdisc 0.")


def test_each_command_is_the_file_of_its_name():
    commands = [getattr(import_module(f"gaitdisc.commands.{name}"), name) for name in COMMANDS]
    assert all(command.__module__ == f"gaitdisc.commands.{command.__name__}" for command in commands)


def test_the_help_loads_no_library_that_computes():
    loaded = modules_loaded_by(", ".join(["gaitdisc.cli", *(f"gaitdisc.commands.{name}" for name in COMMANDS)]))
    assert not loaded & {"numpy", "pandas", "torch"}


def test_a_command_is_loaded_when_it_is_called():
    loaded = modules_loaded_by("gaitdisc.cli")
    assert not loaded & {f"gaitdisc.commands.{name}" for name in COMMANDS}


def test_a_refusal_ends_with_its_code(tmp_path):
    done = called("check", tmp_path / "none")
    assert done.returncode == 1
    assert done.stderr.startswith("SchemaError: the path must be a study") and done.stderr.endswith(". [gd-schema]\n")


def _with_command(tmp_path, command, **environment):
    """Outcome of a command line whose only command is the given line of Python."""
    loaded = "import signal\ntry: signal.raise_signal(signal.SIGINT)\nexcept BaseException: pass\n"
    (tmp_path / "swallows.py").write_text(loaded, encoding="utf-8")
    code = f"import gaitdisc.cli, signal, time; gaitdisc.cli.main = lambda: {command}\n"
    code += "from gaitdisc.__main__ import main; main(); time.sleep(5)"
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])} | environment,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a job in the background ignores Ctrl-C
        capture_output=True, check=False, timeout=60,
    )  # fmt: skip


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is another event there")
@pytest.mark.parametrize(
    "command",
    [
        "signal.raise_signal(signal.SIGINT)",
        "(__import__('swallows'), time.sleep(5))",
        "(type('Dying', (), {'__del__': lambda self: signal.raise_signal(signal.SIGINT)})() and 0, time.sleep(5))",
        "__import__('os').kill(__import__('os').getpid(), signal.SIGINT) or time.sleep(5)",
    ],
    ids=["in a command", "in a module that swallows it", "where nothing can be raised", "from outside"],
)
def test_ctrl_c_ends_with_130_and_no_traceback(tmp_path, command):
    done = _with_command(tmp_path, command)
    assert (done.returncode, done.stdout, done.stderr) == (130, b"", b"")


@pytest.mark.parametrize(
    "environment",
    [{"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}],
    ids=["by name", "by locale"],
)
def test_a_terminal_without_a_character_shows_a_question_mark(tmp_path, environment):
    done = _with_command(tmp_path, "(print('R\\u00b2 is 0.9'), exit())", **environment)
    assert (done.returncode, done.stderr) == (0, b"") and done.stdout.rstrip() == b"R? is 0.9"
