from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.ground import STANCE, gate, habitual_force, pressure_centre

PHASE = np.arange(1000) / 1000


def test_the_gate_is_exactly_shut_in_swing():
    assert np.all(gate(PHASE[PHASE >= STANCE]) == 0.0)
    assert gate(np.array([1.3])) == pytest.approx(gate(np.array([0.3])))
    assert 0.0 <= gate(PHASE).min() <= gate(PHASE).max() <= 1.0


@pytest.mark.parametrize("speed", [0.40, 0.45, 0.55])
def test_two_feet_carry_the_body_and_neither_push_nor_brake_on_the_whole(speed):
    force = habitual_force(PHASE, speed)
    assert force.mean(axis=0) == pytest.approx([0.0, 0.5], abs=1e-9)
    assert force[PHASE >= STANCE].max() == 0.0


def test_pressure_rolls_from_heel_to_toe():
    pressure = pressure_centre(PHASE, 0.26)
    stance = pressure[PHASE < STANCE]
    assert np.all(np.diff(stance) >= 0)
    assert stance[0] < 0 < stance[-1] < 0.26 * 0.75
    assert pressure[-1] == pytest.approx(pressure[0], abs=1e-3)
