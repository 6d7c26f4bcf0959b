"""Two short walks of one calibration person, shared by the tests of the cohort."""

import pytest

from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.person import Spring
from gaitdisc.cohort.walk import walked


@pytest.fixture(scope="session")
def person():
    return the_twelve(calibration=True)[1]


@pytest.fixture(scope="session")
def nominal(person):
    return walked(person, None, 40.0, seed=5)


@pytest.fixture(scope="session")
def exo(person):
    return walked(person.adapt_to(Spring()), Spring(), 40.0, seed=5)
