"""Expressions along trajectories."""

from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.evaluating import Points, evaluate, evaluate_many
from gaitdisc.simulation.parts import Term

RNG = np.random.default_rng(3)
T = np.arange(500) / 100
X, U = RNG.normal(size=(500, 2)), np.column_stack([RNG.normal(size=500), (T * 0.9) % 1])


def test_states_inputs_parameters_definitions_ports_and_time(ankle):
    spring = ankle.with_effect(Term("ankle_moment", "port", "a", "-2*theta"))
    values = evaluate(spring, "tau*phase + spring*ankle_moment + b*t", Points(T, X, U))
    np.testing.assert_allclose(values, U[:, 0] * U[:, 1] - 50 * X[:, 0] ** 2 + 1.1 * T, rtol=1e-12)


def test_many_share_their_work_and_agree_with_one(ankle):
    points = Points(T, X, U, extras={"x0": 0.1, "wide": np.abs(X[:, 1])})
    texts = [f"max(0, theta - {i}*x0)*wide" for i in range(40)]
    many = evaluate_many(ankle, texts, points)
    assert many.shape == (40, 500)
    np.testing.assert_allclose(many[7], np.maximum(0, X[:, 0] - 0.7) * np.abs(X[:, 1]), rtol=1e-12, atol=1e-14)


def test_parameters_for_each_point(ankle):
    values = np.column_stack([np.full(500, 0.12), np.full(500, 1.1), np.arange(500.0)])
    np.testing.assert_allclose(evaluate(ankle, "k", Points(T, X, U, values)), np.arange(500.0))


def test_a_number_alone_has_a_value_at_every_point(ankle):
    assert evaluate(ankle, "-1", Points(T, X, U)).tolist() == [-1.0] * 500


def test_delays_in_a_series(ankle):
    late = evaluate(ankle, "delay(theta, 0.1) + delay(phase, x0)", Points(T, X, U, extras={"x0": 0.05}, rate=100.0))
    wanted = X[np.maximum(np.arange(500) - 10, 0), 0] + U[np.maximum(np.arange(500) - 5, 0), 1]
    np.testing.assert_allclose(late, wanted, atol=1e-9)


def test_a_delay_without_a_series_and_an_unknown_name_are_refused(ankle):
    with pytest.raises(SimulationError, match="the points have no rate"):
        evaluate(ankle, "delay(theta, 0.1)", Points(T, X, U))
    with pytest.raises(SimulationError, match="Did you mean 'theta'"):
        evaluate(ankle, "thetta", Points(T, X, U))


def test_the_delay_of_a_definition_that_does_not_stand_in_it_needs_no_series(ankle):
    delayed = replace(ankle, definitions=(*ankle.definitions, ("late", "delay(theta, 0.1)")))
    np.testing.assert_allclose(evaluate(delayed, "2*theta", Points(T, X, U)), 2 * X[:, 0])
    with pytest.raises(SimulationError, match="the points have no rate"):
        evaluate(delayed, "late", Points(T, X, U))
