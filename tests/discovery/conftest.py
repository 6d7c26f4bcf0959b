"""A case into a mass on a spring, whose missing cubic spring is known."""

import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.forward_selection import select_forward


@pytest.fixture(scope="package")
def case():
    measured = record(with_load("-14*x**3"), 3, Experiment(seconds=12.0))
    return set_up_case(mass(), measured)


@pytest.fixture(scope="package")
def as_read(case):
    return case.as_read()


@pytest.fixture(scope="package")
def labelled(case):
    """Return all explanations by name and place; of several shapes of one name the first."""
    return {one.label: one for one in reversed(case.search.candidates)}


@pytest.fixture(scope="package")
def cubic(labelled):
    """Return the explanation that is true."""
    return labelled["cubic_stiffness@load"]


@pytest.fixture(scope="package")
def named(case, as_read):
    """Return the simulation with what the search selected, and the rivals."""
    return select_forward(case.search, as_read, 2)
