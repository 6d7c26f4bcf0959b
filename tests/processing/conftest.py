"""Driven walkers as trials, and a study that asks for their angles."""

import pytest
from driven_walker import DrivenWalker

from gaitdisc.ingest.study import Conditions, Participant, Study
from gaitdisc.recording import Trial


@pytest.fixture(scope="session")
def trial() -> Trial:
    """Forty seconds of walking with angles, EMG and forces, whose right contacts are every whole phase."""
    return DrivenWalker("P01", stride_s=1.1, seed=4).walked(40.0, "nominal")


@pytest.fixture
def study() -> Study:
    return Study(conditions=Conditions(nominal="nominal", device="exo"), participants=(Participant(id="P01"),))
