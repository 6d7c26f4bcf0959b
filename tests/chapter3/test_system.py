import numpy as np
from chapter3.record import system_of

from gaitdisc.simulation.simulation_file import bundled


def test_what_is_hidden_is_in_the_true_rates_only(van_der_pol):
    x = np.array([[2.0, 1.0]])
    assert (van_der_pol.true(x) - van_der_pol.known(x)).round(12).tolist() == [[0.0, -0.08]]


def test_a_gain_leaves_the_other_states_unmeasured():
    system = system_of(bundled("mass_spring_damper"), gain=(1.01,))
    assert system.channels == ("x",)
    assert system.observation.tolist() == [[1.01, 0.0]]
