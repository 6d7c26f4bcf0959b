import numpy as np
import pytest
from chapter3.record import Conditions, error_samples, one_after_another, recorded, refined_samples, system_of
from chapter3.sindy import fit_sindy

from gaitdisc.errors import ShapeError
from gaitdisc.simulation.simulation_file import bundled


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
