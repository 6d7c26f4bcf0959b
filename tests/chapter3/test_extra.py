import sys

import pytest
from chapter3.sindy import chapter3_library

from gaitdisc.errors import TrainingError


def test_what_is_missing_is_named_with_its_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "pysindy", None)
    with pytest.raises(TrainingError, match=r"needs the library pysindy; .*gaitdisc\[chapter3\]"):
        chapter3_library("pysindy")
