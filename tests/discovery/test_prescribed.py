"""What is left of a joint's moment: named where it repeats itself, not named where it is noise."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.prescribed import ResidualMoment, joint_finding

RATE, SECONDS = 25.0, 4.0
TIME = np.arange(0, SECONDS, 1 / RATE)
ANGLE = 0.2 * np.sin(2 * np.pi * 0.9 * TIME) + 0.06 * np.sin(2 * np.pi * 1.8 * TIME + 1)
SPEED = np.gradient(ANGLE, TIME)
MUSCLES = -60 * np.clip(np.sin(2 * np.pi * 0.9 * TIME + 0.5), 0, None) ** 2


def missing(name, piece, role="x", constants=None):
    return Candidate("missing_physics", "port", "ankle_moment", name, (piece,), constants or {}, role)


SHAPES = (
    missing("linear_stiffness", "x"),
    missing("one_sided_spring", "max(0, x - _x0)", constants={"x0": "quantiles of x"}),
    missing("viscous_damping", "v"),
    Candidate("wrong_parameter", "parameter", "muscles_strength", "wrong_parameter", value=1.0, bounds=(0.94, 1.06)),
    Candidate("wrong_parameter", "parameter", "muscles_delay", "wrong_parameter", value=0.0),
)


def columns(candidate, constants):
    if candidate.place == "muscles_strength":
        return MUSCLES[:, None]
    if candidate.place == "muscles_delay":
        return (np.interp(TIME - constants["value"], TIME, MUSCLES) - MUSCLES)[:, None]
    made = {
        "linear_stiffness": lambda: ANGLE,
        "one_sided_spring": lambda: np.maximum(0, ANGLE - constants["x0"]),
        "viscous_damping": lambda: SPEED,
    }
    return made[candidate.name]()[:, None]


def noise(seed, count=1):
    """Moments of the noise of angles: differentiated twice, so that what is slow is small."""
    white = np.random.default_rng(seed).normal(size=(count, len(TIME) + 200))
    fast = np.asarray(sosfiltfilt(butter(2, [2, 6], "bandpass", fs=RATE, output="sos"), white, axis=1))[:, 100:-100]
    return 3.0 * fast / fast.std()


def found(left, seed=1, columns_of=lambda mine: mine):
    def seen(candidate, constants):
        return columns_of(columns(candidate, constants))

    joint = ResidualMoment("ankle_moment", TIME, left + noise(seed)[0], MUSCLES + left, noise(99, 4), ANGLE, seen)
    return joint_finding(joint, SHAPES)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_mere_noise_has_no_name(seed):
    assert found(np.zeros(len(TIME)), seed).named is None


def test_a_one_sided_spring_is_named_with_its_numbers_and_predicts_time_held_out():
    one = found(-150 * np.maximum(0, ANGLE - 0.05))
    assert one.named is not None and one.named.candidate.name == "one_sided_spring"
    assert one.named.values["factor"] == pytest.approx(-150, rel=0.15)
    assert one.named.values["x0"] == pytest.approx(0.05, abs=0.02)
    rest = one.joint.left - one.named.predicted
    assert np.sqrt(np.mean(rest**2)) < 1.2 * one.joint.floor


def test_late_muscles_are_named_with_their_delay():
    one = found(columns(SHAPES[4], {"value": 0.04})[:, 0])
    assert one.named is not None and one.named.candidate.place == "muscles_delay"
    assert one.named.values["value"] == pytest.approx(0.04, abs=0.008)


def test_weak_muscles_are_named_and_a_strength_within_its_bounds_is_not():
    one = found(-0.3 * MUSCLES)
    assert one.named is not None and one.named.candidate.place == "muscles_strength"
    assert one.named.values["value"] == pytest.approx(0.7, abs=0.05)
    assert found(-0.03 * MUSCLES).named is None


def test_the_smallest_factor_that_shows_shrinks_with_the_size_of_its_column():
    one = found(np.zeros(len(TIME)))
    assert one.least(2 * ANGLE) == pytest.approx(one.least(ANGLE) / 2)
    assert one.least(0 * ANGLE) == float("inf")


def test_what_acts_in_one_part_of_the_time_alone_is_predicted_from_the_rest_of_that_part():
    late = TIME > 0.6 * SECONDS
    one = found(np.where(late, -0.4 * MUSCLES, 0.0), columns_of=lambda mine: np.where(late[:, None], mine, 0.0))
    assert one.named is not None and one.named.candidate.place == "muscles_strength"
    assert one.named.values["value"] == pytest.approx(0.6, abs=0.05)


def test_of_two_that_explain_the_record_that_stands_which_predicts_what_was_held_out():
    one = found(-150 * np.maximum(0, ANGLE - 0.05))
    spring, *others = one.rivals
    assert spring.candidate.name == "one_sided_spring"
    assert all(other.held_out <= spring.held_out for other in others)


def test_blocks_hold_out_every_sample_once_and_keep_their_distance():
    blocks = found(np.zeros(len(TIME))).joint.blocks
    assert np.array_equal(np.concatenate([held for held, _ in blocks]), np.arange(len(TIME)))
    assert len(blocks) == 10
    for held, learned in blocks:
        assert min(np.abs(learned[:, None] - held).min(axis=1)) == 3  # two samples between them
