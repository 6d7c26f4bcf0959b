import numpy as np
import pytest

from gaitdisc.recording import Samples
from gaitdisc.sensing.crossed import crossed_errors, crossed_widths, people_of
from gaitdisc.sensing.intervals import coverage, half_widths
from gaitdisc.sensing.reconstructor import Sensing, fit_reconstructor
from gaitdisc.sensing.splits import split_by_subject
from gaitdisc.sensing.windows import Lags

WHAT = Sensing(("a",), ("b",), Lags(1, 1), 100.0)


def people(count, seed):
    """b is 3 a, plus an offset that differs from person to person, plus noise."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(count):
        a = rng.normal(size=(120, 1))
        y = 3 * a + rng.normal(0.0, 2.0) + 0.3 * rng.normal(size=a.shape)
        time = np.arange(120) / 100
        found.append([Samples(a, y, ("a",), ("b",), time, time, f"P{k}")])
    return found


def test_everybody_but_the_test_person_is_reconstructed_by_models_of_others():
    everybody = people(6, 0)
    errors = crossed_errors("linear", WHAT, split_by_subject(everybody, 0))
    assert errors.shape == (5 * 120, 1)
    assert set(people_of([trial for trials in everybody for trial in trials])) == {f"P{k}" for k in range(6)}
    moved = [[s.with_outputs(s.y + 100.0 * (k == 0)) for s in trials] for k, trials in enumerate(everybody)]
    np.testing.assert_array_equal(crossed_errors("linear", WHAT, split_by_subject(moved, 0)), errors)


def test_one_checked_person_covers_too_little_and_crossing_does_not():
    plain, crossed, by_another = [], [], []
    for seed in range(25):
        parts = split_by_subject(people(9, seed), 0)
        done = fit_reconstructor("linear", WHAT, parts.fitted(), parts.checked())
        missed, errors = (done(part) - part.y for part in (parts.checked(), parts.tested()))
        plain.append(coverage(errors, half_widths(missed))[0])
        crossed.append(coverage(errors, crossed_widths("linear", WHAT, parts, missed))[0])
        scaled = crossed_widths("another kind", WHAT, parts, missed)
        by_another.append(coverage(errors, scaled)[0])
    assert np.mean(plain) < 0.75
    assert np.mean(crossed) == pytest.approx(0.9, abs=0.07)
    np.testing.assert_allclose(by_another, crossed)  # the standard is the same model here


def test_with_three_people_there_is_nothing_to_cross():
    parts = split_by_subject(people(3, 0), 0)
    missed = np.arange(-9.0, 10.0)[:, None]
    np.testing.assert_array_equal(crossed_widths("linear", WHAT, parts, missed), half_widths(missed))
