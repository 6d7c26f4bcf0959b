"""Every number of a mass a little off, with bounds that say so; what was hidden is known."""

from dataclasses import replace

import pytest
from hidden_in_a_mass import MASS, Experiment, mass, record, with_load
from texts import says

from gaitdisc.discovery.answer import corrected, file_bounds
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.discover import discover
from gaitdisc.results.discovery import Correction, Estimate
from gaitdisc.simulation.parts import Parameter
from gaitdisc.simulation.simulation_file import simulation_of

OFF = {"m": (2.0, 2.08), "k": (24.0, 22.9), "c": (0.8, 0.84)}


def within(low, high):
    """The mass, whose stiffness has bounds."""
    return replace(
        mass(), parameters=[replace(k, low=low, high=high) if k.name == "k" else k for k in mass().parameters]
    )


def believed(bounds=0.125):
    """The mass, each number off by about 4 %, within bounds."""
    text = MASS
    for true, off in OFF.values():
        low, high = off * (1 - bounds), off * (1 + bounds)
        text = text.replace(f"value = {true}", f"value = {off}\nlow = {low:.6g}\nhigh = {high:.6g}")
    return simulation_of(text, "believed.toml")


def test_where_only_numbers_are_a_little_off_nothing_is_named_and_they_are_corrected():
    found, augmented = discover(believed(), record(mass(), 3))
    assert (found.verdict, found.effects) == ("no_gap", ())
    moved = {one.parameter: one for one in found.corrections}
    for name, (true, off) in OFF.items():
        assert moved[name].given == off
        assert moved[name].found.value == pytest.approx(true, rel=0.02)
        assert augmented.values()[name] == moved[name].found.value
    assert augmented.effects == ()
    assert "Changed within their bounds" in found.sentence


def test_numbers_that_are_a_little_off_do_not_spoil_the_name_and_value_of_what_is_missing():
    found, augmented = discover(believed(), record(with_load("-14*x**3"), 3))
    assert [(one.name, one.place) for one in found.effects] == [("cubic_stiffness", "load")]
    stiffness = found.effects[0].estimates["stiffness"]
    assert stiffness.value == pytest.approx(14.0, rel=0.03)
    assert stiffness.low < 14.0 < stiffness.high
    assert augmented.values()["k"] == pytest.approx(24.0, rel=0.03)


def test_a_number_that_has_to_leave_its_bounds_is_wrong_and_lies_outside():
    found, _ = discover(within(23.5, 24.5), record(mass().with_values({"k": 27.0}), 3))
    assert (found.verdict, found.effects[0].place, found.effects[0].bounds) == ("wrong_parameter", "k", (23.5, 24.5))
    assert says(found.sentence, "23.5", "24.5 N/m")
    assert not found.corrections


def test_few_samples_do_not_carry_a_number_out_of_its_bounds():
    how = Experiment(trials=2, seconds=4.0, noise=0.3)
    found, augmented = discover(within(23.9, 24.1), record(mass(), 5, how))
    assert found.verdict == "no_gap"
    assert 23.9 <= augmented.values()["k"] <= 24.1


def test_numbers_are_written_into_the_file():
    moved = Correction("k", 24.0, Estimate(25.0, 24.0, 26.0, "N/m"))
    assert corrected(mass(), (moved,)).values()["k"] == 25.0
    assert corrected(mass(), ()) == mass()


def test_a_parameter_with_one_bound_has_none_on_the_other_side():
    wrong = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=24.0)
    assert file_bounds(mass(), wrong) == ()
    bounded = mass().with_parameter(Parameter("k", 24.0, "N/m", high=30.0))
    assert file_bounds(bounded, wrong) == (-float("inf"), 30.0)
    assert file_bounds(bounded, replace(wrong, verdict="sensor_error")) == ()
