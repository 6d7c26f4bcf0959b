"""An inquiry into a mass on a spring, whose missing cubic spring is known."""

import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.growth import grown
from gaitdisc.discovery.inquiry import begin_inquiry


@pytest.fixture(scope="package")
def inquiry():
    measured = record(with_load("-14*x**3"), 3, Experiment(seconds=12.0))
    return begin_inquiry(mass(), measured)


@pytest.fixture(scope="package")
def as_read(inquiry):
    return inquiry.as_read()


@pytest.fixture(scope="package")
def cubic(inquiry):
    """Return the explanation that is true."""
    return next(one for one in inquiry.search.candidates if one.label == "cubic_stiffness@load")


@pytest.fixture(scope="package")
def named(inquiry, as_read):
    """Return the simulation with what the search let in, and the rivals."""
    return grown(inquiry.search, as_read, 2)
