from __future__ import annotations

import dataclasses

import pytest

from gaitdisc.results.clinical_reference import Limits, Score


def test_what_is_read_is_frozen():
    limits = Limits(1.0, 3.0, 2.0, 0.5, 10)
    with pytest.raises(dataclasses.FrozenInstanceError):
        limits.low = 0.0
    assert Score(1.0, 1.0, 1.0, 1, 2.0, 0.5, 10).people == 10
