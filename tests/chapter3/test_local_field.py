import numpy as np
import pytest
from chapter3.burgers import burgers, fit_local_field, local_cell, recorded_field, slope_and_bend
from chapter3.methods import MethodSettings
from chapter3.record import Conditions, error_samples, recorded


@pytest.fixture(scope="module")
def decaying():
    return recorded(burgers(0.1), Conditions(duration_s=2.0))


def test_the_cubic_is_found_at_every_point_and_nothing_else(decaying):
    learned = fit_local_field(error_samples(decaying, "dynamics"), "sindy", MethodSettings())
    fields = decaying.truth[[0, 150]]
    assert learned.said == "error: -0.1*u**3"
    assert learned(fields) == pytest.approx(-0.1 * fields**3, abs=1e-4)


def test_slope_and_bend_are_read_where_they_stand(decaying):
    samples = error_samples(decaying, "dynamics")
    slope, bend = slope_and_bend(samples.x)
    learned = fit_local_field(samples.with_outputs(2.0 * slope - bend), "sindy", MethodSettings())
    assert learned(samples.x[:3]) == pytest.approx((2.0 * slope - bend)[:3], abs=1e-6)


def test_a_cell_holds_what_was_found_and_both_parts(decaying):
    cell = local_cell(decaying, "sindy")
    assert (cell.method, cell.variant, cell.terms) == ("sindy", "at each point", "error: -0.1*u**3")
    assert np.median(cell.parts["oracle forecast"].accuracy()) > 99


def test_noise_is_taken_out_over_space_as_well_as_over_time():
    made = Conditions(0.01, duration_s=2.0)
    by_time, by_both = recorded(burgers(0.1), made), recorded_field(burgers(0.1), made)
    over_time, over_both = ((each.filtered - each.truth[: each.split]).std() for each in (by_time, by_both))
    assert over_both < 0.7 * over_time
