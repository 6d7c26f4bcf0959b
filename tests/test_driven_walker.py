import numpy as np
import pytest
from driven_walker import DrivenWalker


@pytest.fixture(scope="module")
def pair():
    person = {"name": "P01", "stride_s": 1.0, "seed": 3}
    return (
        DrivenWalker(**person).walked(30.0, "nominal"),
        DrivenWalker(**person, spring_per_s2=250.0).walked(30.0, "exo"),
    )


def test_the_spring_acts_one_sided_and_in_proportion():
    walker = DrivenWalker("P01", spring_per_s2=250.0, engaged_deg=1.0)
    np.testing.assert_allclose(walker.spring(np.array([-5.0, 1.0, 3.0])), [0.0, 0.0, -500.0])


def test_the_spring_takes_dorsiflexion_away_and_nothing_else(pair):
    nominal, exo = (trial.stream("kinematics") for trial in pair)
    assert exo["ankle_angle_r"].max() < nominal["ankle_angle_r"].max() - 2.0
    assert np.std(exo["knee_angle_r"]) == pytest.approx(np.std(nominal["knee_angle_r"]), rel=0.05)


def test_stride_time_is_what_was_asked_for(pair):
    smooth = np.convolve(pair[0].stream("forces")["ground_force_r_vy"], np.ones(25) / 25, "same")
    contacts = np.flatnonzero(np.diff((smooth > 100.0).astype(int)) == 1) / 1000
    assert np.mean(np.diff(contacts)) == pytest.approx(1.0, abs=0.02)
    assert 0.005 < np.std(np.diff(contacts)) < 0.03


def test_left_is_half_a_stride_later(pair):
    kinematics = pair[0].stream("kinematics")
    right, left = kinematics["knee_angle_r"], kinematics["knee_angle_l"]
    lags = range(20, 80)
    best = max(lags, key=lambda lag: np.corrcoef(right[:-lag], left[lag:])[0, 1])
    assert best == pytest.approx(50, abs=3)


def test_the_same_seed_walks_the_same_walk():
    first, second = (DrivenWalker("P01", seed=5).walked(2.0, "nominal").stream("emg") for _ in range(2))
    np.testing.assert_array_equal(first.values, second.values)
