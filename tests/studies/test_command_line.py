import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[2]
FILES = sorted([*(PROJECT / "studies").glob("*.py"), *(PROJECT / "benchmarks").glob("*.py")])
# Names of one file each, run as a command with the words given; libraries that take long to load are refused.
CHILD = """
import contextlib, importlib.abc, io, json, runpy, sys
from pathlib import Path

SLOW = {"numpy", "scipy", "pandas", "torch", "matplotlib", "numba", "sklearn", "pysindy", "pydmd", "gaitdisc"}

class Refused(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in SLOW:
            raise ImportError(f"{name} is loaded before the command line is read")
        return None

sys.meta_path.insert(0, Refused())
sys.dont_write_bytecode = True
start, found = list(sys.path), {}
for file, words in json.loads(sys.stdin.read()):
    said, wrong, code = io.StringIO(), io.StringIO(), None
    sys.argv, sys.path[:] = [file, *words], [str(Path(file).parent), *start]
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(wrong):
        try:
            runpy.run_path(file, run_name="__main__")
        except SystemExit as end:
            code = end.code
        except ImportError as error:
            code = str(error)
    found[file] = (code, said.getvalue(), wrong.getvalue())
print(json.dumps(found))
"""


def is_command(file: Path) -> bool:
    return any(word in file.read_text(encoding="utf-8") for word in ("command_line(", "__main__"))


COMMANDS = [file for file in FILES if file.name != "command_line.py" and is_command(file)]


def answers(words, folder):
    """Exit code, output and error output of every command, given these words, in an empty folder."""
    given = json.dumps([[str(file), words] for file in COMMANDS])
    command = [sys.executable, "-c", CHILD]
    done = subprocess.run(command, input=given, cwd=folder, capture_output=True, text=True, timeout=600, check=True)
    return {Path(file): answer for file, answer in json.loads(done.stdout).items()}


@pytest.fixture(scope="module")
def helped(tmp_path_factory):
    folder = tmp_path_factory.mktemp("helped")
    return answers(["--help"], folder), list(folder.rglob("*"))


def test_help_ends_every_command_before_it_loads_or_writes_anything(helped):
    found, written = helped
    assert {file.name: code for file, (code, _, _) in found.items() if code != 0} == {}
    assert written == []


def options_of(words):
    return set(re.findall(r"--[a-z][\w-]*", words)) - {"--one"}  # which a benchmark gives itself


def places_of(words):
    bare = re.sub(r"--\w+ \S+", "", re.sub(r"\[-[^\]]*\]", "", words))
    return [
        word for word in (re.sub(r"\.\w+", "", w).strip("[]{}").lower().replace("|", ",") for w in bare.split()) if word
    ]


def test_usage_has_the_arguments_that_the_first_lines_of_the_file_show(helped):
    for file, (_, said, _) in helped[0].items():
        usage, _, description = said.partition("\n\n")
        shown = re.search(rf"^    \w+ {file.parent.name}/{file.name}(.*)$", description, re.MULTILINE)
        assert shown, file.name
        words, typed = shown[1].partition(">")[0], usage.partition(".py")[2]
        assert (options_of(words) - options_of(typed), places_of(words)) == (set(), places_of(typed)), file.name


def test_every_argument_is_explained_and_every_default_shown(helped):
    for file, (_, said, _) in helped[0].items():
        bare = re.findall(r"^  (-?[\w-]+(?: [A-Z_]+)?)$(?!\n {10,})", said, re.MULTILINE)
        assert not bare, f"{file.name}: {bare}"


def test_a_slip_is_refused_with_the_usage_and_2(tmp_path):
    for file, (code, said, wrong) in answers(["--wrong", "a", "b", "c", "d"], tmp_path).items():
        assert (code, said) == (2, ""), file.name
        assert wrong.startswith("usage: python "), file.name
    assert list(tmp_path.rglob("*")) == []


def test_what_is_no_command_is_loaded_by_one():
    texts = [file.read_text(encoding="utf-8") for file in FILES]
    for file in FILES:
        if is_command(file) or file.stem.startswith(("command_line", "participant_")):
            continue
        assert any(f"from {file.stem} import" in text for text in texts), f"{file.name} does nothing"
