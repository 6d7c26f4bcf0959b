"""The exoskeleton's spring is named in gait, from files and in the hidden-effects study."""

import device_from_files
import hidden_effects_in_gait
import pytest

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def row():
    return hidden_effects_in_gait.run(1, ("spring",), hidden_effects_in_gait.Setting()).iloc[0]


def test_the_exoskeletons_spring_is_named_at_the_ankle_and_nothing_else(row):
    assert row["named"] == "one_sided_spring at ankle_moment"


def test_its_stiffness_and_engagement_are_those_of_the_device(row):
    assert row["value"] == pytest.approx(row["truth"], rel=0.05)
    assert row["engaged_rad"] == pytest.approx(row["engaged_truth_rad"], abs=0.01)


def test_the_held_out_error_falls_near_the_noise(row):
    """Real angles hold what neither the device nor white noise explains."""
    assert row["after"] < 1.6 * row["floor"] < 0.5 * row["before"]


@pytest.fixture(scope="module")
def files():
    return device_from_files.run(1, 777101, True).iloc[0]


def test_the_exoskeletons_spring_is_named_from_the_files(files):
    assert files["right"]


def test_the_named_effect_leaves_less_of_the_moment_than_the_device_walks_own_muscle_model(files):
    assert files["Nominal + named effect"] < files["Exo"] < files["Nominal"]
