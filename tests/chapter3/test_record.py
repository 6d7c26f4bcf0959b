"""A system's record, its noise, its error signal, and the effect that is hidden in it."""

from dataclasses import replace

import numpy as np
import pytest
from chapter3.methods import MethodSettings
from chapter3.naming import HiddenEffect, method_answer
from chapter3.record import (
    FARTHER,
    NOISE_KINDS,
    Conditions,
    drawn_noise,
    error_samples,
    one_after_another,
    recorded,
    refined_samples,
    system_of,
)
from chapter3.sindy import fit_sindy
from texts import says

from gaitdisc.errors import SamplingError, ShapeError
from gaitdisc.simulation.simulation_file import bundled


def test_noise_is_a_share_of_each_channel_or_absolute(lorenz):
    for absolute in (False, True):
        record = recorded(lorenz, Conditions(noise=0.1, absolute=absolute, duration_s=20.0))
        wanted = 0.1 * (np.ones(3) if absolute else record.truth.std(axis=0))
        assert (record.measured - record.truth).std(axis=0) == pytest.approx(wanted, rel=0.1)


def test_the_published_variant_starts_and_compares_from_the_last_measured_sample(van_der_pol):
    record = recorded(van_der_pol, Conditions(noise=0.05, published=True, absolute=True, duration_s=10.0))
    assert np.array_equal(record.start(forecast=True), record.filtered[-1])
    assert np.array_equal(record.target(forecast=True)[0], record.filtered[-1])
    right = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0))
    assert np.array_equal(right.target(forecast=True), right.truth[right.split - 1 :])


def test_a_record_too_short_says_by_how_much(van_der_pol):
    with pytest.raises(SamplingError, match=r"60 samples.*0.01 s.*31, 29"):
        recorded(van_der_pol, Conditions(duration_s=0.5))


def test_a_start_that_is_assumed_wrongly_is_the_known_models_and_not_the_forecasts(van_der_pol):
    wrong = replace(van_der_pol, assumed=np.array([0.6, 4.0]))
    record = recorded(wrong, Conditions(duration_s=5.0))
    assert record.start(forecast=False).tolist() == [0.6, 4.0]
    assert np.array_equal(record.start(forecast=True), record.truth[record.split - 1])
    assert record.truth[0].tolist() == [0.1, 5.0]


def test_further_records_start_where_the_first_one_went_with_noise_of_their_own(van_der_pol):
    record = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0, trajectories=3))
    low, high = record.truth.min(axis=0), record.truth.max(axis=0)
    starts = [each.truth[0] for each in record.others]
    assert len(starts) == 2
    assert all(((low <= start) & (start <= high)).all() for start in starts)
    noises = [each.measured - each.truth for each in (record, *record.others)]
    assert max(abs(np.corrcoef(noises[0].ravel(), other.ravel())[0, 1]) for other in noises[1:]) < 0.1
    alone = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0))
    assert np.array_equal(alone.measured, record.measured)


def test_what_is_sacrificed_is_the_beginning_of_the_forecast(van_der_pol):
    record = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0, sacrificed_s=2.0))
    part = record.beginning_of_forecast(np.array([0.3, 0.4]))
    assert part.split == len(part.time) == 201
    assert np.array_equal(part.measured, record.measured[record.split - 1 : record.split + 200])
    assert part.start(forecast=False).tolist() == [0.3, 0.4]


def test_sacrificing_all_of_a_forecast_or_next_to_nothing_is_refused(van_der_pol):
    for seconds, count in ((4.0, 401), (0.2, 21)):
        record = recorded(van_der_pol, Conditions(duration_s=10.0, sacrificed_s=seconds))
        with pytest.raises(SamplingError, match=rf"{seconds:g} s have {count} of the forecast's 401"):
            record.beginning_of_forecast(record.truth[0])


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


def test_the_dynamical_error_is_the_hidden_term(quiet):
    samples = error_samples(quiet, "dynamics")
    assert np.abs(samples.y[:, 1] + 0.01 * samples.x[:, 0] ** 3).max() < 1e-4
    assert samples.time[0] == pytest.approx(0.01)


def test_the_flow_errs_less_than_a_central_difference_and_less_again_when_refined(lorenz):
    worst = []
    for published in (True, False):
        record = recorded(lorenz, Conditions(duration_s=10.0, published=published))
        samples = error_samples(record, "dynamics")
        worst.append(np.abs(samples.y[5:-5, 0] - 0.01 * samples.x[5:-5, 0] ** 3).max())
    again = refined_samples(record, samples, fit_sindy(samples))
    worst.append(np.abs(again.y[5:-5, 0] - 0.01 * again.x[5:-5, 0] ** 3).max())
    assert worst[0] > 1.5 * worst[1] > 15 * worst[2]


def test_the_residual_is_what_the_known_model_misses(quiet):
    samples = error_samples(quiet, "state")
    assert np.allclose(samples.x + samples.y, quiet.truth[: quiet.split])


def test_the_residual_keeps_the_noise_white_and_is_low_passed_only_as_published(van_der_pol):
    for published in (False, True):
        record = recorded(van_der_pol, Conditions(0.01, duration_s=20.0, published=published))
        samples = error_samples(record, "state")
        run = van_der_pol.known.run(record.start(forecast=False)[None], 0.01, record.split - 1)[0]
        noise = samples.y + run - record.truth[: record.split]
        neighbours = [np.corrcoef(noise[1:, k], noise[:-1, k])[0, 1] for k in range(2)]
        assert len(samples) == record.split
        assert np.all(np.array(neighbours) > 0.5) if published else np.all(np.abs(neighbours) < 0.1)


def test_rates_of_states_that_are_not_measured_are_refused():
    record = recorded(system_of(bundled("mass_spring_damper"), gain=(1.01,)), Conditions(duration_s=5.0))
    with pytest.raises(ShapeError, match=r"2 states.*1 are: x"):
        error_samples(record, "dynamics")


def test_records_that_are_learned_from_as_one_keep_their_samples_and_a_seam(van_der_pol):
    record = recorded(van_der_pol, Conditions(duration_s=10.0, trajectories=3))
    parts = [error_samples(each, "dynamics") for each in (record, *record.others)]
    whole = one_after_another(parts)
    assert len(whole) == sum(map(len, parts))
    assert np.array_equal(whole.y[len(parts[0]) : 2 * len(parts[0])], parts[1].y)
    assert np.sort(np.diff(whole.time))[-2:] == pytest.approx([1.0, 1.0])
    assert one_after_another(parts[:1]) is parts[0]


CUBIC = {"y": {"x**3": -0.01}}


@pytest.fixture(scope="module")
def hidden(van_der_pol):
    return HiddenEffect("van der Pol", "−0.01 x³", van_der_pol, ("y", "cubic_stiffness"), 0.01, CUBIC)


def test_sindy_names_the_term_and_its_number(hidden, quiet):
    found = method_answer(hidden, quiet, "sindy")
    assert (found.answer, found.right, found.said) == ("named", True, "y: -0.01*x**3")
    assert found.amount == pytest.approx(1.0, abs=1e-3)
    assert found.accuracy > 99


def test_another_term_beside_it_and_another_one_alone_are_distinguished(hidden, quiet):
    sought = replace(hidden, terms={"y": {"x": 1.0}})
    assert method_answer(sought, quiet, "sindy").answer == "wrong name"
    many = method_answer(hidden, quiet, "sindy", MethodSettings(threshold=1e-9))
    assert many.answer == "among others"


def test_a_curve_is_described_by_how_far_it_is_off(hidden, quiet):
    found = method_answer(hidden, quiet, "dmd")
    assert found.answer == "curve"
    assert found.said.startswith("a curve of time, ")
    assert found.said.endswith("% off what is missing")


def test_where_nothing_is_hidden_sindy_says_so_and_a_curve_stays_a_curve():
    alike = HiddenEffect("van der Pol", "", system_of(bundled("van_der_pol")))
    record = recorded(alike.system, Conditions(0.001, duration_s=20.0))
    assert method_answer(alike, record, "sindy").right
    curve = method_answer(alike, record, "dmd")
    assert not curve.right
    assert curve.said.endswith("where nothing is missing")


def test_one_measured_state_is_refused_in_words(hidden, van_der_pol):
    only = replace(van_der_pol, observation=np.eye(2)[:1])
    found = method_answer(replace(hidden, system=only), recorded(only, Conditions(duration_s=20.0)), "gp")
    assert found.answer == "refused"
    assert says(found.said, "2 states", "1 are: x")


def test_what_is_hidden_is_in_the_true_rates_only(van_der_pol):
    x = np.array([[2.0, 1.0]])
    assert (van_der_pol.true(x) - van_der_pol.known(x)).round(12).tolist() == [[0.0, -0.08]]


def test_a_gain_leaves_the_other_states_unmeasured():
    system = system_of(bundled("mass_spring_damper"), gain=(1.01,))
    assert system.channels == ("x",)
    assert system.observation.tolist() == [[1.01, 0.0]]
