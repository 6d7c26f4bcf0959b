"""What changes nothing of what is measured is said, or refused where nothing else is left to find."""

import numpy as np
import pytest
from hidden_in_a_mass import MASS, Experiment, mass, record, with_load
from texts import says

from gaitdisc.discovery.answer import nearly_off
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.places import list_places
from gaitdisc.discovery.process_noise import rank_process_noise
from gaitdisc.discovery.result import Estimate, FoundEffect
from gaitdisc.errors import SimulationError
from gaitdisc.simulation.simulation_file import parse_simulation

PORT = '[ports.load]\nunit = "N"\n'
MUTED = MASS.replace("push + load", "push + load + 0*wind").replace(PORT, PORT + '[ports.wind]\nunit = "N"\n')
HEAT = MASS.replace("[inputs.push]", '[states.heat]\nunit = "J"\n[inputs.push]').replace(
    "[observations]", 'heat = "c*v**2 + warmth"\n[observations]'
)
HEAT = HEAT.replace(PORT, PORT + '[ports.warmth]\nunit = "J/s"\n')


@pytest.fixture(scope="module")
def measured():
    return record(with_load("-14*x**3"), 3, Experiment(trials=3, seconds=6.0))


def findings_of(text, measured):
    found, _ = discover(parse_simulation(text), measured)
    assert [(one.place, one.name) for one in found.effects] == [("load", "cubic_stiffness")]
    return [one.line() for one in found.findings if one.kind == "no influence"]


def test_a_port_times_0_is_said_and_the_others_are_searched(measured):
    [said] = findings_of(MUTED, measured)
    assert says(said, "warning: A mass", "no influence", "port 'wind'")


def test_a_state_that_nothing_sees_and_the_port_that_moves_it_are_said(measured):
    port, state = findings_of(HEAT, measured)
    assert says(port, "'warmth'", "no", "measured channels")
    assert says(state, "no", "'heat'", "no")


def test_a_parameter_without_influence_is_no_candidate(measured):
    more = MASS.replace("[ports.load]", "[parameters.colour]\nvalue = 3.0\n[ports.load]")
    case = set_up_case(parse_simulation(more), measured)
    assert says(case.measured.findings[-1].what, "'colour'", "no", "measured channels")
    assert all(one.place != "colour" for one in case.search.candidates)
    assert any(one.place == "k" for one in case.search.candidates)


def test_where_no_port_shows_the_simulation_is_refused(measured):
    with pytest.raises(SimulationError, match=r"\[ports\].*'load': no effect on"):  # fmt: skip
        discover(parse_simulation(MASS.replace("push + load", "push + 0*load")), measured)


@pytest.mark.parametrize("expression", ["0*x", "k", "3.5"])
def test_an_observation_that_never_changes_is_refused(measured, expression):
    text = MASS.replace('[observations]\nx = "x"', f'[observations]\nx = "{expression}"')
    with pytest.raises(SimulationError, match=r"\[observations\].*measured channel must depend.*'x'"):  # fmt: skip
        discover(parse_simulation(text), measured)


def test_a_port_that_shows_only_late_has_influence():
    slow = MASS.replace("k*x", "k*delay(x, 5)")
    case = set_up_case(parse_simulation(slow), record(mass(), 3, Experiment(trials=2, seconds=8.0)))
    assert [place.name for place in case.search.places] == ["load"]
    assert case.measured.findings == ()


def test_all_has_influence_where_all_is_as_it_should_be(measured):
    assert set_up_case(mass(), measured).measured.findings == ()


def test_pushes_that_show_nowhere_explain_nothing(measured):
    case = set_up_case(parse_simulation(MUTED), measured)
    now = case.as_read()
    places = list_places(case.search.base)
    best, muted = rank_process_noise(now, places)
    assert (best.place.name, muted.place.name) == ("load", "wind")
    assert np.isfinite(best.bic) and np.isinf(muted.bic)


def test_an_answer_that_takes_two_inputs_nearly_away_is_said():
    """A balance of recorded moments holds best where none is left; one gain near 0 may be a unit."""
    found = {"net": 0.13, "others": -0.2, "plantarflexors": 0.9}
    effects = tuple(
        FoundEffect("input", name, "input_gain", "", {"gain": Estimate(gain, gain - 0.1, gain + 0.1, "1")})
        for name, gain in found.items()
    )
    (said,) = nearly_off(effects, "walk.csv")
    assert (said.severity, said.kind) == ("warning", "inputs switched off")
    assert said.line().startswith("warning: walk.csv")
    assert says(said.what, "'net' (gain 0.13)", "'others' (gain -0.2)")
    assert says(said.spoils, "one recording into one input")
    assert nearly_off(effects[1:], "walk.csv") == ()
