"""The parts are frozen, and phase is the one input that wraps."""

from dataclasses import FrozenInstanceError

import pytest

from gaitdisc.simulation.parts import Input, Parameter, Sensor


def test_only_phase_wraps():
    assert Input("phase", "1").wraps
    assert not Input("phase", "rad").wraps
    assert not Input("tau", "1").wraps


def test_parts_are_frozen():
    with pytest.raises(FrozenInstanceError):
        Parameter("k", 1.0).value = 2.0  # type: ignore[misc]


def test_a_sensor_of_which_nothing_is_said_is_not_known():
    assert not Sensor("x").known
    assert all(one.known for one in (Sensor("x", "deg"), Sensor("x", sd=0.3), Sensor("x", lowpass=6.0)))
