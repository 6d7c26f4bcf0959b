"""Both ways of running agree, also with delays, the past, trial ends and divergences."""

import numpy as np
import pytest

from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.python_simulation import python_simulation
from gaitdisc.simulation.running import compile_simulation


def _joint(t, x, u, values, ports):
    theta, omega = x.T
    inertia, b, k = values[:, :3].T
    return np.column_stack([omega, (u[:, 0] + ports[:, 0] - b * omega - k * theta) / inertia])


EFFECTS = {
    "none": lambda s: s,
    "spring": lambda s: s.with_effect(Term("ankle_moment", "port", "a", "-30*max(0, theta - 0.01)")),
    "equation": lambda s: s.with_effect(Term("omega", "equation", "a", "5*sin(9*t) + phase")),
    "feedback": lambda s: s.with_effect(Term("ankle_moment", "port", "a", "-0.5*delay(omega, 0.07)")),
    "late input": lambda s: s.with_input("tau", "1.2*delay(tau, 0.04)"),
    "late phase": lambda s: s.with_effect(Term("ankle_moment", "port", "a", "3*delay(phase, 0.033)")),
    "number": lambda s: s.with_values({"k": 31.0}),
}


@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("before", [False, True])
def test_a_function_and_a_file_agree(ankle, effect, before):
    python = EFFECTS[effect](
        python_simulation("joint", _joint, ankle.states, ankle.inputs, ankle.parameters, ankle.ports)
    )
    file = EFFECTS[effect](ankle)
    rng = np.random.default_rng(4)
    t = np.arange(61) / 100
    trials = [np.column_stack([np.sin(9 * t + k), (1.7 * t + 0.3 * k) % 1]) for k in range(2)]
    drive = Drive.of([trials[0][:45], trials[1]], 100.0, [0.0, 2.0])
    rows = Rows(np.array([0, 1, 1]), np.array([5, 0, 17]), rng.uniform(-0.1, 0.1, (3, 2)))
    past = rng.uniform(-0.1, 0.1, (2, 61, 2)) if before else None
    one, ok_one = compile_simulation(python).run(drive, rows, 43, past=past)
    other, ok_other = compile_simulation(file).run(drive, rows, 43, past=past)
    assert ok_one.all() and ok_other.all()
    np.testing.assert_allclose(one, other, atol=1e-12)
    seen = [compile_simulation(each).observe(drive, rows, one, past) for each in (python, file)]
    np.testing.assert_allclose(*seen, atol=1e-12)


def test_a_divergence_is_told_by_row(ankle):
    python = python_simulation("joint", _joint, ankle.states, ankle.inputs, ankle.parameters, ankle.ports)
    values = np.array([[0.12, 1.1, 25.0], [0.12, -30.0, 25.0]])
    rows = Rows(np.zeros(2, int), np.zeros(2, int), np.full((2, 2), 0.1), values)
    states, ok = compile_simulation(python).run(Drive.of([np.zeros((61, 2))], 100.0), rows, 60)
    assert ok.tolist() == [True, False]
    assert np.isfinite(states[0]).all() and np.isnan(states[1, -1]).all()


def test_expressions_of_its_names_are_evaluated(ankle):
    python = python_simulation("joint", _joint, ankle.states, ankle.inputs, ankle.parameters, ankle.ports)
    points = Points(np.zeros(2), np.array([[1.0, 2.0], [3.0, 4.0]]), np.zeros((2, 2)))
    assert evaluate(python, "k*theta - omega", points).tolist() == [23.0, 71.0]
