from __future__ import annotations

from unittest.mock import patch

from texts import says

from gaitdisc.batch import installation
from gaitdisc.batch.installation import Check


def test_it_says_that_this_installation_works(called):
    done = called("doctor")
    assert done.returncode == 0, done.stderr
    assert "This installation works." in done.stdout and "reads C3D" in done.stdout and "fonts" in done.stdout


def test_what_is_wrong_is_named_and_the_exit_code_says_so(called):
    with patch.object(installation, "checks", lambda: iter([Check("reads C3D", "wrong", "ReadError: no")])):
        done = called("doctor")
    assert done.returncode == 1 and says(done.stderr, "wrong", "C3D")
