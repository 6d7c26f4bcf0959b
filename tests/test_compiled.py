import errno
import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import gaitdisc
from gaitdisc import compiled as room
from gaitdisc.compiled import compiled

CODE = "from gaitdisc.models.fused_steps import exponential; import numpy as np; print(exponential(np.float32(1)))"


def test_arguments_of_numba_are_passed_on():
    @compiled(error_model="numpy")
    def inverse(x):
        return 1 / x

    assert inverse(0.0) == float("inf")


def test_a_full_disk_costs_time_and_nothing_else(monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space")

    monkeypatch.setattr(room.FunctionCache, "save_overload", full)

    @compiled
    def tripled(x):
        return 3 * x

    with pytest.warns(UserWarning, match=r"cannot be cached.*No space"):
        assert tripled(2.0) == 6.0


def test_a_changed_function_that_is_called_from_another_file_is_compiled_anew(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    head = "from gaitdisc.compiled import compiled\n"
    outer = "from inner_of_test import inner\n\n\n@compiled\ndef outer(x):\n    return inner(x) + 1\n"
    (tmp_path / "outer_of_test.py").write_text(head + outer)
    found = []
    for factor in (2, 30):
        (tmp_path / "inner_of_test.py").write_text(f"{head}\n\n@compiled\ndef inner(x):\n    return {factor} * x\n")
        for name in ("inner_of_test", "outer_of_test"):
            sys.modules.pop(name, None)
        importlib.invalidate_caches()
        found.append(importlib.import_module("outer_of_test").outer(1.0))
    assert found == [3.0, 31.0]


@pytest.fixture
def installed(tmp_path):
    """The package where nobody may write: its caches are files in the place of folders, which stop root as well."""
    package = Path(gaitdisc.__file__).parent
    shutil.copytree(package, tmp_path / "gaitdisc", ignore=shutil.ignore_patterns("__pycache__"))
    for folder in ("models", "."):
        (tmp_path / "gaitdisc" / folder / "__pycache__").write_text("")
    return tmp_path


def said(installed, **environment):
    known = {
        key: value for key, value in os.environ.items() if key not in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "HOME")
    }
    known |= {"PYTHONPATH": str(installed), "PYTHONDONTWRITEBYTECODE": "1", **environment}
    done = subprocess.run([sys.executable, "-c", CODE], env=known, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


@pytest.mark.slow
def test_an_install_that_nobody_may_write_for_a_user_without_a_home(installed):
    (installed / "no").write_text("")
    assert said(installed, HOME=str(installed / "no" / "home")).startswith("2.71828")


@pytest.mark.slow
def test_an_install_that_nobody_may_write_keeps_its_code_where_it_is_told(installed):
    said(installed, HOME=str(installed), NUMBA_CACHE_DIR=str(installed / "kept"))
    assert list((installed / "kept").rglob("*.nbi"))
    for index in (installed / "kept").rglob("*.nbi"):
        index.write_bytes(b"damaged")
    assert said(installed, HOME=str(installed), NUMBA_CACHE_DIR=str(installed / "kept")).startswith("2.71828")
