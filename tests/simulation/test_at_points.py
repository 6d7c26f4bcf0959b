"""Programs at points: one number serves all of them, late signals are asked for."""

import numpy as np
import pytest

from gaitdisc.simulation.expression import parsed
from gaitdisc.simulation.program import at_points, compiled_program, leaf_columns
from gaitdisc.simulation.refusal import SimulationError


def test_columns_are_in_the_order_of_a_program():
    columns = leaf_columns(np.zeros(3), np.ones((3, 2)), np.full((3, 1), 2.0), np.array([7.0, 8.0]))
    assert [np.shape(column) for column in columns] == [(3,), (3,), (3,), (3,), (), ()]


def test_one_number_serves_all_points():
    program = compiled_program([parsed("a*b"), parsed("b")], ["a", "b", "unused"])
    found = at_points(program, [np.arange(200.0), np.array(3.0), np.array(np.nan)])
    np.testing.assert_array_equal(found, [3 * np.arange(200.0), np.full(200, 3.0)])


def test_late_signals_are_asked_for():
    program = compiled_program([parsed("delay(a, 0.1) + a")], ["a"])
    assert at_points(program, [np.ones(2)], np.array([[5.0], [6.0]]))[0].tolist() == [6.0, 7.0]
    with pytest.raises(SimulationError, match="signals must be given"):
        at_points(program, [np.ones(2)])
