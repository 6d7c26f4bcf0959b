from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import MASS, ONE_SIDED, mass, two_rods

from gaitdisc.discovery.candidate import BENT, FLEXIBLE, Candidate, list_candidates, list_unnamed_terms, saturations
from gaitdisc.discovery.catalogue import Shape, read_shapes
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.places import list_places
from gaitdisc.discovery.scored_model import Part, name_parts
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation

WAVE = Candidate("missing_physics", "port", "load", "wave", ("sin(_w*t)", "cos(_w*t)"), {"w": "frequencies"}, "x")


def _candidates(simulation, shapes=None):
    places = list_places(simulation)
    return list_candidates(simulation, places, read_shapes() if shapes is None else shapes)


def _pieces(simulation, label):
    return {one.pieces for one in _candidates(simulation) if one.label == label}


def test_each_piece_has_a_factor_and_each_constant_a_slot():
    assert ONE_SIDED.slots == ("factor", "x0")
    assert WAVE.slots == ("factor", "factor_1", "w")
    assert WAVE.idle == {"factor": 0.0, "factor_1": 0.0}


def test_a_term_is_written_with_its_numbers():
    assert ONE_SIDED.term({"factor": "-30", "x0": "-0.2"}) == "-30*(max(0, x - (-0.2)))"
    assert WAVE.term({"factor": "1", "factor_1": "2", "w": "3"}) == "1*(sin(3*t)) + 2*(cos(3*t))"
    assert Candidate("missing_physics", "port", "load", "constant_load", ("1",)).term({"factor": "4"}) == "4"


def test_numbers_become_parameters_of_the_fit():
    simulation = ONE_SIDED.in_fit(mass(), ONE_SIDED.named("part0"), {"factor": -30.0, "x0": 0.2})
    assert ONE_SIDED.named("part0") == {"factor": "part0_factor", "x0": "part0_x0"}
    assert simulation.values()["part0_factor"] == -30.0
    assert simulation.effects[-1].term == "part0_factor*(max(0, x - part0_x0))"


def test_a_wrong_number_is_a_parameter_already():
    wrong = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=24.0)
    assert wrong.in_fit(mass(), wrong.named("part0"), {"value": 30.0}) == mass()
    assert wrong.written(mass(), {"value": "31.5"}).values()["k"] == 31.5
    assert (wrong.idle, wrong.named("part0")) == ({"value": 24.0}, {"value": "k"})


@pytest.mark.parametrize(
    ("name", "slot", "number", "seen"),
    [
        ("sensor_gain", "gain", "1.2", "1.2*(x)"),
        ("sensor_offset", "offset", "0.1", "(x) + 0.1"),
        ("sensor_drift", "rate", "0.02", "(x) + 0.02*t"),
        ("sensor_lag", "seconds", "0.05", "delay(x, 0.05)"),
    ],
)
def test_a_sensor_error_is_written_into_the_observation(name, slot, number, seen):
    error = Candidate("sensor_error", "observation", "x", name)
    assert dict(error.written(mass(), {slot: number}).observations) == {"x": seen}


@pytest.mark.parametrize(
    ("definitions", "seen", "late"),
    [
        ((), "x + 0.1*v", "delay(x, 0.05) + 0.1*delay(v, 0.05)"),
        ((("half", "x/2"), ("both", "half + v")), "3*both", "3*(delay(x, 0.05)/2 + delay(v, 0.05))"),
    ],
    ids=["sum", "definition"],
)
def test_a_lagging_sensor_sees_every_signal_late(definitions, seen, late):
    simulation = replace(mass(), definitions=definitions).with_observation("x", seen)
    lag = Candidate("sensor_error", "observation", "x", "sensor_lag")
    assert dict(lag.written(simulation, {"seconds": "0.05"}).observations)["x"] == late


@pytest.mark.parametrize(("name", "slot"), [("input_gain", "gain"), ("input_delay", "seconds")])
def test_an_input_error_at_its_idle_value_changes_nothing(name, slot):
    error = Candidate("input_error", "input", "push", name)
    idle = compile_simulation(error.written(mass(), {slot: str(error.idle[slot])}))
    rng, machine = np.random.default_rng(0), compile_simulation(mass())
    t, x, u = np.zeros(5), rng.normal(size=(5, 2)), rng.normal(size=(5, 1))
    np.testing.assert_allclose(idle.rates(t, x, u, late=u), machine.rates(t, x, u))


def test_a_limit_of_an_input_is_to_either_side_above_below_or_both():
    numbers, u = {"limit": "0.5", "upper_limit": "0.3", "lower_limit": "-0.2"}, np.linspace(-1, 1, 9)[:, None]
    t, x, machine = np.zeros(9), np.zeros((9, 2)), compile_simulation(mass())
    limits = np.array([[-9.0, 0.3], [-0.2, 9.0], [-0.5, 0.5], [-0.2, 0.3]])
    for one, (low, high) in zip(saturations(mass(), {}), limits, strict=True):
        clipped = compile_simulation(one.written(mass(), numbers))
        assert np.array_equal(clipped.rates(t, x, u), machine.rates(t, x, np.clip(u, low, high)))


def test_everything_that_could_be_wrong_is_listed_once():
    found = _candidates(mass())
    assert len({(one.label, one.pieces) for one in found}) == len(found)
    labels = {one.label for one in found}
    assert {f"wrong_parameter@{name}" for name in "mkc"} <= labels
    assert {"input_delay@push", "input_gain@push", "sensor_lag@x", "coulomb_friction@load"} <= labels
    assert "gravity_moment@load" not in labels  # x is no angle
    assert "phase_locked_moment@load" not in labels  # there is no stride


def test_an_input_that_nothing_uses_is_not_suspected():
    idle = parse_simulation(MASS.replace("[parameters.m]", '[inputs.spare]\nunit = "N"\n[parameters.m]'), "idle.toml")
    assert not any(one.place == "spare" for one in _candidates(idle))


def test_a_stride_brings_effects_that_are_locked_to_it_and_does_not_lag():
    text = MASS.replace("[parameters.m]", '[inputs.phase]\nunit = "1"\n[parameters.m]')
    used = text.replace("push + load", "push + load + phase")
    idle, driving = ({one.label for one in _candidates(parse_simulation(one, "stride.toml"))} for one in (text, used))
    assert "phase_locked_moment@load" in idle
    assert "input_delay@phase" in driving and "input_lag@phase" not in driving


def test_in_a_chain_a_spring_acts_on_a_joint_or_their_difference_and_gravity_on_the_joint_itself():
    cubic, linear, coupling, gravity = (
        _pieces(two_rods(), f"{name}@lower_moment")
        for name in ("cubic_stiffness", "linear_stiffness", "linear_coupling", "gravity_moment")
    )
    assert cubic == {("lower**3",), ("(lower - upper)**3",), ("upper**3",)}
    assert linear == {("lower",), ("(lower - upper)",)} and ("upper",) in coupling  # the other state is a coupling
    assert gravity == {("sin(lower)",), ("cos(lower)",)}


def test_a_shape_of_the_users_own_is_one_more_candidate():
    quintic = Shape("quintic", ("x**5",), means="a very stiff spring")
    found = [one for one in _candidates(mass(), (*read_shapes(), quintic)) if one.name == "quintic"]
    assert [(one.label, one.pieces, one.means) for one in found] == [("quintic@load", ("x**5",), "a very stiff spring")]


def test_an_effect_with_a_state_of_its_own_adds_it_under_a_name_that_is_free():
    (bent,) = [one for one in _candidates(mass()) if one.label == "hysteresis@load"]
    once = bent.written(mass(), {"factor": "-25", "width": "0.25"})
    assert [state.name for state in once.states] == ["x", "v", "hysteresis_load"]
    assert once.states[2].unit == "m"
    assert dict(once.equations)["hysteresis_load"] == "v - abs(v)*hysteresis_load/0.25"
    (again,) = [one for one in _candidates(once) if one.label == "hysteresis@load"]
    assert list(again.states) == ["hysteresis_load_2"]


def test_a_lagged_input_replaces_the_input_everywhere_but_in_its_own_equation():
    lag = next(one for one in _candidates(mass()) if one.label == "input_lag@push")
    late = lag.written(mass(), {"seconds": "0.2"})
    v = dict(mass().equations)["v"].replace("push", "push_lagged")
    assert late.equations == (("x", "v"), ("v", v), ("push_lagged", "(push - push_lagged)/0.2"))


def terms(simulation):
    found = list_unnamed_terms(simulation, list_places(simulation))
    return [(one.place, one.pieces[0]) for one in found]


def test_an_input_and_a_state_times_it_may_act_at_a_port():
    assert terms(mass()) == [("load", "push"), ("load", "x*push")]


def test_another_bodys_acceleration_may_act_with_nothing_at_its_port():
    upper, lower = terms(two_rods())
    assert (upper[0], lower[0]) == ("upper_moment", "lower_moment")
    assert "lower_rate" in upper[1] and "upper_rate" in lower[1]
    assert "moment" not in upper[1] + lower[1]


def test_each_compiles_where_it_is_put():
    simulation = two_rods()
    for one in list_unnamed_terms(simulation, list_places(simulation)):
        assert one.name == "unnamed"
        compile_simulation(one.written(simulation, {"factor": "0.5"}))


def penalty(case, label, **values):
    candidate = next(one for one in case.search.candidates if one.label == label)
    return candidate.penalty(dict.fromkeys(candidate.slots, 1.0) | values)


def test_what_imitates_anything_costs_more_than_a_plain_term(case):
    plain = penalty(case, "viscous_damping@load", factor=-0.3)
    assert plain == CRITERIA.plain
    for name in ("delayed_feedback", "product_coupling", "periodic_forcing"):
        assert penalty(case, f"{name}@load") == CRITERIA.plain + CRITERIA.bent > 2 * plain


def test_a_friction_that_drives_costs_more(case):
    resists, drives = (penalty(case, "coulomb_friction@load", factor=one) for one in (-1.0, 1.0))
    assert drives == resists + CRITERIA.matters


def test_every_price_is_of_an_explanation_that_there_is(case):
    limits = saturations(mass(), {"push": (1.0, 0.0, "x")})
    names = {shape.name for shape in read_shapes()} | {one.name for one in (*case.search.candidates, *limits)}
    assert {*BENT, *FLEXIBLE} <= names | {"unnamed"}


WRONG = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=24.0)
DRIFT = Candidate("sensor_error", "observation", "x", "sensor_drift")


def test_parts_are_put_in_one_after_the_other_under_names_of_their_own(as_read):
    parts = (Part(WRONG, {"value": 25.0}), Part(DRIFT, {"rate": 0.1}))
    assert name_parts(parts) == ({"value": "k"}, {"rate": "part1_rate"})
    model = as_read.refitted(as_read.shooting, parts)
    assert dict(model.simulation.observations)["x"] == "(x) + part1_rate*t"


def test_the_true_explanation_is_fitted_to_its_true_number(case, as_read, cubic):
    part = Part(cubic, {"factor": 0.0})
    model = as_read.refitted(as_read.shooting, (part,))
    error = float(np.sqrt(model.fit.covariance[0, 0]))
    assert model.parts[0].values["factor"] == pytest.approx(-14.0, abs=max(4 * error, 0.1))
    assert model.names == ({"factor": "part0_factor"},)
    assert model.fit.misfit < as_read.fit.misfit


def test_a_number_more_costs_the_logarithm_of_what_was_measured(case, as_read, cubic):
    model = as_read.refitted(as_read.shooting, (Part(cubic, {"factor": 0.0}),))
    assert model.size == 1
    assert model.bic - model.fit.misfit == pytest.approx(np.log(model.fit.white.size))


def test_without_explanations_only_the_starts_are_fitted(as_read):
    assert as_read.size == 0
    assert as_read.bic == as_read.fit.misfit
