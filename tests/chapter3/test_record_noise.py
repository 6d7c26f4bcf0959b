import numpy as np
import pytest
from chapter3.record import FARTHER, NOISE_KINDS, drawn_noise

SIZE = np.array([0.5, 2.0])


def _noise(kind, clean):
    return drawn_noise(kind, clean, SIZE, 0.01, np.random.default_rng(3))


@pytest.fixture
def clean():
    t = np.arange(200_000) / 100
    return np.column_stack([np.sin(t), 3 * np.cos(1.7 * t)])


@pytest.mark.parametrize("kind", NOISE_KINDS)
def test_every_kind_has_the_standard_deviation_that_is_wanted(kind, clean):
    # the fourth moment of Student's t with three degrees is infinite: its sample variance converges slowly
    assert _noise(kind, clean).std(axis=0) == pytest.approx(SIZE, rel=0.1 if kind == "student_t" else 0.02)


def test_students_noise_has_the_tails_of_its_law(clean):
    scaled = np.abs(_noise("student_t", clean)) / SIZE * np.sqrt(3)
    assert np.mean(scaled > 3.182) == pytest.approx(0.05, rel=0.05)  # the tables' 97.5 % quantile, both sides


def test_outliers_are_two_in_a_hundred_and_ten_times_as_far(clean):
    narrow = SIZE / np.sqrt(1 + 0.02 * (FARTHER**2 - 1))
    far = np.abs(_noise("outliers", clean)) > 5 * narrow  # of the narrow law 6e-7, of the wide one .617 are beyond
    assert far.mean() == pytest.approx(0.02 * 0.617, rel=0.1)


def test_coloured_noise_is_stationary_and_forgets_within_its_memory(clean):
    runs = np.array([
        drawn_noise("coloured", np.zeros((30, 1)), np.ones(1), 0.01, np.random.default_rng(k))[:, 0]
        for k in range(4000)
    ])  # fmt: skip
    assert runs[:, 0].std() == pytest.approx(1.0, abs=0.05)
    assert runs[:, -1].std() == pytest.approx(1.0, abs=0.05)
    assert np.corrcoef(runs[:, 0], runs[:, 10])[0, 1] == pytest.approx(np.exp(-1), abs=0.06)


def test_multiplicative_noise_grows_with_the_signal_and_vanishes_with_it(clean):
    noise = np.abs(_noise("multiplicative", clean)[:, 0])
    large, small = np.abs(clean[:, 0]) > 0.9, np.abs(clean[:, 0]) < 0.1
    ratio = np.mean(np.abs(clean[large, 0])) / np.mean(np.abs(clean[small, 0]))
    assert noise[large].mean() / noise[small].mean() == pytest.approx(ratio, rel=0.1)
