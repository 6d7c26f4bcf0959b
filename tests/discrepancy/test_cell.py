import pytest

from gaitdisc.discrepancy.cell import cell, cell_of
from gaitdisc.discrepancy.methods import MethodSettings
from gaitdisc.discrepancy.record import Conditions


@pytest.mark.parametrize("method", ["sindy", "gp"])
def test_the_hidden_term_is_recovered_without_noise(quiet, method):
    forecast = cell_of(quiet, method, "dynamics").parts["forecast"]
    assert forecast.accuracy().min() > 99
    assert forecast.diverged_s is None


def test_the_published_residual_of_sindy_changes_next_to_nothing_and_the_right_one_does(van_der_pol, quiet):
    published = cell(van_der_pol, "sindy", "state", Conditions(duration_s=20.0, published=True))
    assert published.variant == "as published"
    right = cell_of(quiet, "sindy", "state").parts["reconstruction"].accuracy().max()
    assert right > 20 + published.parts["reconstruction"].accuracy().max()


def test_what_cannot_be_fitted_is_told_and_not_numbered(quiet):
    found = cell_of(quiet, "dmd", "state", MethodSettings(delays=5000))
    assert not found.parts
    assert "3829 too few" in found.refused


def test_a_model_that_diverges_has_no_number(lorenz):
    found = cell(lorenz, "sindy", "dynamics", Conditions(noise=0.1, duration_s=4.0), MethodSettings(degree=5))
    for part in found.parts.values():
        assert (part.diverged_s is None) == bool((part.accuracy() == part.accuracy()).all())
