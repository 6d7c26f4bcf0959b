"""A problem into a mass on a spring, whose missing cubic spring is known."""

import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.forward_selection import select_forward
from gaitdisc.discovery.problem import set_up_problem


@pytest.fixture(scope="package")
def problem():
    measured = record(with_load("-14*x**3"), 3, Experiment(seconds=12.0))
    return set_up_problem(mass(), measured)


@pytest.fixture(scope="package")
def as_read(problem):
    return problem.as_read()


@pytest.fixture(scope="package")
def cubic(problem):
    """Return the explanation that is true."""
    return next(one for one in problem.search.candidates if one.label == "cubic_stiffness@load")


@pytest.fixture(scope="package")
def named(problem, as_read):
    """Return the simulation with what the search selected, and the rivals."""
    return select_forward(problem.search, as_read, 2)
