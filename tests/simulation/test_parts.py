"""The parts are frozen, and phase is the one input that wraps."""

from dataclasses import FrozenInstanceError

import pytest

from gaitdisc.simulation.parts import Input, Parameter


def test_only_phase_wraps():
    assert Input("phase", "1").wraps
    assert not Input("phase", "rad").wraps
    assert not Input("tau", "1").wraps


def test_parts_are_frozen():
    with pytest.raises(FrozenInstanceError):
        Parameter("k", 1.0).value = 2.0  # type: ignore[misc]
