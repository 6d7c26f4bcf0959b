"""What is made ready to run: the equations with their effects, of a file or of a Python object."""

import numpy as np

from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.python_simulation import python_simulation
from gaitdisc.simulation.running import PythonCompiled, compile_simulation


def test_effects_act_at_ports_and_in_equations(ankle):
    both = ankle.with_effect(Term("ankle_moment", "port", "a", "-3*theta")).with_effect(
        Term("omega", "equation", "b", "2*spring")
    )
    both = both.with_effect(Term("ankle_moment", "port", "c", "1.5"))
    t, x, u = np.zeros(1), np.array([[0.1, 0.2]]), np.array([[4.0, 0.3]])
    rates = compile_simulation(both).rates(t, x, u)
    moment = 4.0 - 0.3 + 1.5 - 1.1 * 0.2 - 2.5
    np.testing.assert_allclose(rates, [[0.2, moment / 0.12 + 2 * 2.5]], rtol=1e-14)


def test_the_same_simulation_is_compiled_once(ankle):
    assert compile_simulation(ankle) is compile_simulation(ankle.without_effects())


def test_a_python_object_runs_by_its_own_function(ankle):
    made = python_simulation("fall", lambda t, x, u, p: 0 * x, ankle.states, ankle.inputs, ankle.parameters)
    compiled = compile_simulation(made)
    assert isinstance(compiled, PythonCompiled)
    assert compiled.model is made
    assert compiled.states == compile_simulation(ankle).states
