import pytest
from chapter3.record import Conditions, recorded, system_of

from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation_file import bundled


@pytest.fixture(scope="session")
def van_der_pol():
    return system_of(bundled("van_der_pol"), Term("y", "equation", "cubic_stiffness", "-0.01*x**3"))


@pytest.fixture(scope="session")
def lorenz():
    return system_of(bundled("lorenz"), Term("x", "equation", "cubic", "0.01*x**3"))


@pytest.fixture(scope="session")
def quiet(van_der_pol):
    return recorded(van_der_pol, Conditions(duration_s=20.0))
