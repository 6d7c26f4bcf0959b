"""Driven walkers as trials, and a study that asks for their angles."""

import pickle

import pytest
from driven_walker import DrivenWalker

from gaitdisc.ingest.study import Conditions, Participant, Study
from gaitdisc.kinematics import motion
from gaitdisc.recording import Trial


@pytest.fixture(scope="module", autouse=True)
def exchanges_are_sought_once_in_the_same_markers():
    """Whatever else tests change in a trial; a third of their time went there."""
    sought, found = motion.exchanged_pairs, {}

    def once(*given):
        key = pickle.dumps(given)
        if key not in found:
            found[key] = sought(*given)
        pairs, broken = found[key]
        return list(pairs), dict(broken)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motion, "exchanged_pairs", once)
        yield


@pytest.fixture(scope="session")
def trial() -> Trial:
    """Forty seconds of walking with angles, EMG and forces, whose right contacts are every whole phase."""
    return DrivenWalker("P01", stride_s=1.1, seed=4).walked(40.0, "nominal")


@pytest.fixture
def study() -> Study:
    return Study(conditions=Conditions(nominal="nominal", device="exo"), participants=(Participant(id="P01"),))
