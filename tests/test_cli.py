import subprocess
import sys

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
    assert all(command.__module__ == f"gaitdisc.commands.{command.__name__}" for command in COMMANDS)


def test_the_help_loads_no_library_that_computes():
    code = "import sys, gaitdisc.cli; print([name for name in ('numpy', 'pandas', 'torch') if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_a_refusal_ends_with_its_code(tmp_path):
    done = called("check", tmp_path / "none")
    assert done.returncode == 1
    assert done.stderr.startswith("SchemaError: a study, ") and done.stderr.endswith(". [gd-schema]\n")
