"""Each verdict on a mass on a spring in which one thing was hidden; the answers are those that were hidden."""

from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, lagging, mass, record, remembering, two_rods, with_load
from made_simulation import system
from texts import says

from gaitdisc.discovery.catalogue import Request, Shape
from gaitdisc.discovery.discover import discover, refuse_blow_up
from gaitdisc.discovery.paired_test import PairedTest
from gaitdisc.errors import SchemaError, SimulationError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.even_time import TrialColumns
from gaitdisc.simulation.measured import Measured, check_measured
from gaitdisc.simulation.parts import Parameter, Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation
from gaitdisc.simulation.writing import simulation_text

SEED = 3
slow = partial(pytest.param, marks=pytest.mark.slow)  # what differs from a quick one in a number, a sign or a name
KNEE = """
title = "A knee that swings"
[states.theta]
unit = "rad"
[states.omega]
unit = "rad/s"
[inputs.push]
unit = "N m"
[parameters.inertia]
value = 0.35
unit = "kg m^2"
[ports.knee]
unit = "N m"
[equations]
theta = "omega"
omega = "(push + knee - omega - 20*sin(theta))/inertia"
[observations]
theta = "theta"
"""
MISSING = {
    "cubic_stiffness": ("-14*x**3", {"stiffness": 14.0}),
    "coulomb_friction": ("-1.5*sign(v)", {"friction": 1.5}),
    "quadratic_drag": ("-0.7*v*abs(v)", {"drag": 0.7}),
    "one_sided_spring": ("-30*max(0, x - 0.25)", {"stiffness": 30.0, "engagement": 0.25}),
    "delayed_feedback": ("-4*delay(x, 0.21)", {"gain": -4.0, "delay": 0.21}),
    "periodic_forcing": ("2*sin(7.3*t + 0.4)", {"amplitude": 2.0, "frequency": 7.3}),
}


SATURATED = "-0.6*(max(0, push - 6) + min(0, push + 6))"
QUICK = {"cubic_stiffness", "coulomb_friction", "one_sided_spring", "periodic_forcing"}  # one of each form


@cache
def _found(truth, how=None, nominal=None, seed=SEED):
    return discover(nominal or mass(), record(truth, seed, how), Request())


def _named(discovery):
    return discovery.verdict, [(one.name, one.place) for one in discovery.effects]


@pytest.mark.parametrize("name", [*sorted(QUICK), *map(slow, sorted(MISSING.keys() - QUICK))])
def test_a_missing_term_is_named_with_its_numbers(name):
    term, numbers = MISSING[name]
    discovery, augmented = _found(with_load(term))
    assert _named(discovery) == ("missing_physics", [(name, "load")])
    assert augmented.effects[0].name == name
    estimates = list(discovery.effects[0].estimates.values())
    for wanted in numbers.values():
        closest = min(estimates, key=lambda one: abs(one.value - wanted))
        assert closest.value == pytest.approx(wanted, rel=0.02)
        assert closest.low - 0.02 * abs(wanted) < wanted < closest.high + 0.02 * abs(wanted)
    assert discovery.held_out.after < 1.15 * discovery.held_out.noise_floor
    assert discovery.held_out.p < 0.05
    assert discovery.held_out.pieces >= 8


@pytest.mark.parametrize(
    ("truth", "how", "verdict", "name", "place", "value"),
    [
        (mass().with_values({"k": 27.0}), None, "wrong_parameter", "wrong_parameter", "k", 27.0),
        slow(mass().with_values({"c": 1.6}), None, "wrong_parameter", "wrong_parameter", "c", 1.6),
        (mass(), Experiment(late=4), "input_error", "input_delay", "push", 0.08),
        slow(mass(), Experiment(late=-4), "input_error", "input_delay", "push", -0.08),
        (mass().with_observation("x", "x + 0.02*t"), None, "sensor_error", "sensor_drift", "x", 0.02),
        slow(mass(), Experiment(shaking=6.0), "process_noise", "process_noise", "load", 6.0),
    ],
    ids=["stiffness", "damping", "late input", "early input", "drift", "shaken"],
)
def test_what_is_wrong_but_not_missing_is_named(truth, how, verdict, name, place, value):
    discovery, _ = _found(truth, how)
    assert discovery.verdict == verdict
    assert _named(discovery)[1] == [(name, place)]
    (estimate,) = discovery.effects[0].estimates.values()
    assert estimate.value == pytest.approx(value, rel=0.02 if name != "process_noise" else 0.3)


@pytest.mark.parametrize(
    ("truth", "name", "place", "numbers"),
    [
        (remembering("v - abs(v)*z/0.25", "-25*z"), "hysteresis", "load", {"stiffness": 25.0, "yield": 0.25}),
        slow(remembering("v - z/0.4", "-18*z"), "series_elasticity", "load", {"stiffness": 18.0, "relaxation": 0.4}),
        slow(lagging(0.15), "input_lag", "push", {"time_constant": 0.15}),
        slow(with_load("-9*max(0, x - 0.1)*v"), "contact_damper", "load", {"damping": 9.0, "engagement": 0.1}),
        slow(with_load(SATURATED), "input_saturation", "load", {"slope": -0.6, "limit": 6.0}),
    ],
    ids=["hysteresis", "series elasticity", "lag", "contact damper", "saturation"],
)
@pytest.mark.slow
def test_effects_with_states_of_their_own_and_of_inputs_are_named_and_written(truth, name, place, numbers):
    discovery, augmented = _found(truth)
    assert _named(discovery) == ("input_error" if place == "push" else "missing_physics", [(name, place)])
    assert {key: one.value for key, one in discovery.effects[0].estimates.items()} == pytest.approx(numbers, rel=0.05)
    assert discovery.held_out.after < 1.2 * discovery.held_out.noise_floor
    states = discovery.effects[0].states
    assert [state.name for state in augmented.states] == ["x", "v", *states]
    again = parse_simulation(simulation_text(augmented))
    assert again == augmented


@pytest.mark.slow
def test_a_spring_beside_hysteresis_is_named_with_it():
    both = remembering("v - abs(v)*z/0.25", "-25*z").with_effect(Term("load", "port", "hidden", "-14*x**3"))
    discovery, augmented = _found(both)
    assert sorted(_named(discovery)[1]) == [("cubic_stiffness", "load"), ("hysteresis", "load")]
    assert [state.name for state in augmented.states] == ["x", "v", "hysteresis_load"]


@pytest.mark.parametrize(
    ("truth", "alike"),
    [
        (with_load("1.2"), {("sensor_offset", "x"), ("constant_load", "load")}),
        slow(mass().with_observation("x", "1.3*x"), {("sensor_gain", "x"), ("input_gain", "push")}),
    ],
    ids=["load and offset", "sensor and input"],
)
def test_what_a_linear_system_cannot_tell_apart_is_given_together(truth, alike):
    discovery, _ = _found(truth)
    tied = {(one.name, one.place) for one in discovery.rivals if one.tied}
    assert {_named(discovery)[1][0], *tied} >= alike


@pytest.mark.parametrize("cutoff_hz", [0.0, slow(6.0)], ids=["white", "coloured"])
@pytest.mark.parametrize("seed", [0, slow(1)])
def test_nothing_is_named_where_nothing_is_hidden(seed, cutoff_hz):
    discovery, augmented = _found(mass(), Experiment(cutoff_hz=cutoff_hz), seed=seed)
    assert _named(discovery) == ("no_gap", [])
    assert augmented == mass()
    assert discovery.held_out.before == discovery.held_out.after


@pytest.mark.parametrize(
    ("term", "noise"), [("0", 0), slow("-1e-4*x**3", 1e-7), slow("0", 1e-7), slow("-1e-4*x**3", 0)]
)
def test_what_integration_may_leave_is_not_named(term, noise):
    discovery, _ = _found(with_load(term), Experiment(noise=noise))
    assert _named(discovery) == ("no_gap", [])


@pytest.mark.slow
def test_without_noise_a_small_effect_is_named_with_its_number():
    discovery, _ = _found(with_load("-0.05*x**3"), Experiment(noise=0.0))
    assert _named(discovery) == ("missing_physics", [("cubic_stiffness", "load")])
    assert discovery.effects[0].estimates["stiffness"].value == pytest.approx(0.05, rel=0.02)


@pytest.mark.slow
def test_of_forty_nulls_at_most_two_are_named():
    how = [Experiment(cutoff_hz=cutoff) for cutoff in (0.0, 6.0)]
    named = [_named(_found(mass(), how[seed % 2], seed=seed)[0]) for seed in range(100, 140)]
    assert sum(verdict != "no_gap" for verdict, _ in named) <= 2, named


@pytest.mark.slow
def test_two_effects_are_both_named():
    truth = with_load("-14*x**3").with_effect(Term("load", "port", "second", "-1.5*sign(v)"))
    discovery, augmented = _found(truth, Experiment(seconds=10.0))
    verdict, effects = _named(discovery)
    assert (verdict, set(effects)) == ("missing_physics", {("cubic_stiffness", "load"), ("coulomb_friction", "load")})
    assert len(augmented.effects) == 2


def test_one_trial_is_enough_and_its_last_quarter_proves_it():
    discovery, _ = _found(with_load("-14*x**3"), Experiment(trials=1, seconds=40.0))
    assert _named(discovery) == ("missing_physics", [("cubic_stiffness", "load")])
    assert set(discovery.runs.trial) == {1}
    assert discovery.runs.time.min() == pytest.approx(30.0, abs=0.1)


@pytest.mark.slow
def test_an_effect_outside_the_catalogue_is_answered_by_a_shape_that_closes_the_gap():
    discovery, augmented = _found(with_load("-6*exp(-((x - 0.3)/0.2)**2)"), Experiment(trials=6, seconds=9.0))
    assert _named(discovery) == ("unnamed", [("unnamed", "load")])
    size = discovery.held_out
    closed = 1 - (size.after**2 - size.noise_floor**2) / (size.before**2 - size.noise_floor**2)
    assert closed > 0.7
    machine = compile_simulation(augmented)
    at = np.column_stack([np.linspace(-0.2, 0.7, 40), np.zeros(40)])
    plain = compile_simulation(mass()).rates(np.zeros(40), at, np.zeros((40, 1)))
    force = 2.0 * (machine.rates(np.zeros(40), at, np.zeros((40, 1))) - plain)[:, 1]
    assert np.corrcoef(force, -6 * np.exp(-(((at[:, 0] - 0.3) / 0.2) ** 2)))[0, 1] > 0.9


def test_an_effect_of_the_users_own_is_found_by_its_name(tmp_path):
    bump = Shape("bump", ("exp(-((x - c)/0.2)**2)",), constants={"c": "quantiles of x"})
    hidden = record(with_load("-6*exp(-((x - 0.3)/0.2)**2)"), SEED)
    discovery, augmented = discover(mass(), hidden, Request((bump,)))
    assert _named(discovery) == ("missing_physics", [("bump", "load")])
    values = [one.value for one in discovery.effects[0].estimates.values()]
    assert min(abs(value - 0.3) for value in values) < 0.01
    assert "exp" in augmented.effects[0].term


@pytest.mark.slow
def test_in_a_chain_an_effect_is_named_at_the_joint_where_it_acts():
    truth = two_rods().with_effect(Term("lower_moment", "port", "hidden", "-6*max(0, lower - 0.1)"))
    discovery, _ = _found(truth, Experiment(seconds=9.0, noise=0.01), nominal=two_rods())
    assert _named(discovery) == ("missing_physics", [("one_sided_spring", "lower_moment")])


@pytest.mark.slow
def test_a_spring_that_the_held_out_trial_never_reaches_is_proven_on_another_and_every_step_is_told():
    truth = with_load("-20*max(0, x - 0.7)")
    measured = record(truth, 1, Experiment(seconds=10.0))
    reached = measured.observed[:, :, 0].max(axis=1)
    assert (reached[:3] > 0.8).all()
    assert reached[3] < 0.65
    progress = []
    found, _ = discover(mass(), measured, Request(progress=progress.append))
    assert [effect.name for effect in found.effects] == ["one_sided_spring"]
    assert found.effects[0].estimates["engagement"].value == pytest.approx(0.7, abs=0.03)
    assert found.held_out.after < 0.5 * found.held_out.before
    assert says(progress[0], "fitting the simulation")
    assert any("testing errors of the inputs" in line for line in progress)
    assert any(says(line, "held-out data never reach", "other data") for line in progress)
    note = next(finding for finding in found.findings if finding.kind == "held out")
    assert says(note.what, "trial 4", "trial 3")


@pytest.mark.slow
def test_where_one_trial_comes_to_rest_its_first_quarter_proves_the_friction():
    still = mass().with_values({"c": 0.1})
    measured = record(still.with_effect(Term("load", "port", "friction", "-1.5*sign(v)")), 2, Experiment(1, 40.0, 0.05))
    rest = Drive.of([0 * measured.drive.inputs[0]], measured.drive.rate)
    rows = Rows(np.zeros(1, int), np.zeros(1, int), np.array([[2.0, 0.0]]))
    truth = compile_simulation(still.with_effect(Term("load", "port", "friction", "-1.5*sign(v)")))
    states, _ = truth.run(rest, rows, measured.observed.shape[1] - 1)
    assert np.abs(states[0, 1500:, 0]).max() < 0.1
    seen = states[:, :, :1] + 0.03 * np.random.default_rng(0).normal(size=states[:, :, :1].shape)
    found, _ = discover(still, Measured(rest, seen, ("1",), measured.channels))
    assert [effect.name for effect in found.effects] == ["coulomb_friction"]
    (instead,) = (one for one in found.findings if one.kind == "held out")
    assert says(instead.what, "trial 1", "held out", "first quarter")


def test_where_the_last_quarter_of_one_trial_alone_shows_a_gap_the_first_is_held_out():
    rest, gain = Parameter("rest", 78.0, low=65, high=90), Parameter("gain", 0.25, low=0.1, high=0.5)
    numbers = rest, gain, Parameter("tau", 60.0)  # no integers: for these the machine would be compiled once more
    given = {one.name: one.value for one in numbers}
    heart = system({"rate": "(rest + gain*power - rate)/tau"}, ["power"], given, {"rate": "rate"})
    base, time = replace(heart, parameters=numbers), np.arange(120) * 10.0
    drive = Drive.of([np.where(time < 1000, 25 * np.floor(time / 120) + 50, 25.0)[:, None]], 0.1)  # it rises, and falls
    truth = compile_simulation(base.with_values({"rest": 85, "gain": 0.235, "tau": 400}))
    states, _ = truth.run(drive, Rows(np.zeros(1, int), np.zeros(1, int), np.array([[84.0]])), 119)
    seen = states[:, :, :1] + np.random.default_rng(0).normal(size=(1, 120, 1))
    found, _ = discover(base, Measured(drive, seen, ("1",), ("rate",)))
    assert _named(found) == ("wrong_parameter", [("wrong_parameter", "tau")])
    assert found.effects[0].estimates["value"].low < 400 < found.effects[0].estimates["value"].high
    note = next(finding for finding in found.findings if finding.kind == "held out")
    assert says(note.what, "the training data do not show the gap of", "last quarter", "held out", "first quarter")
    assert found.held_out.alpha == 0.025  # two splits share the rate of false finds


@pytest.mark.slow
def test_one_record_in_degrees_gives_the_same_name_and_estimates():
    knee = parse_simulation(KNEE, "knee.toml")
    stop = knee.with_effect(Term("knee", "port", "hidden", "-110*max(0, theta - 0.25)"))
    seen = record(stop, SEED, Experiment(seconds=6.0))
    plain, degrees = (
        discover(knee.with_observation("theta", text), replace(seen, observed=factor * seen.observed))[0]
        for text, factor in (("theta", 1.0), ("57.2958*theta", 57.2958))
    )
    assert _named(plain) == _named(degrees) == ("missing_physics", [("one_sided_spring", "knee")])
    for name, one in plain.effects[0].estimates.items():
        other = degrees.effects[0].estimates[name]
        assert other.value == pytest.approx(one.value, rel=1e-4)
        assert (other.low, other.high) == pytest.approx((one.low, one.high), rel=1e-3)
    assert (plain.units, degrees.units) == (("rad",), ("deg",))
    assert degrees.held_out.after == pytest.approx(plain.held_out.after, rel=1e-3)


@pytest.fixture(scope="module")
def short():
    return record(mass(), 2, Experiment(seconds=8.0))


def test_a_simulation_that_stays_near_the_data_passes(short):
    assert refuse_blow_up(mass(), short)


def test_samples_that_are_too_far_apart_for_a_simulation_are_told_from_slow_ones(short):
    """Milliseconds taken for seconds: a period in less than a sample. A tank every 4 s is as slow as its clock."""
    slow = system({"x": "w*tanh(v)", "v": "-w*tanh(x)"}, parameters={"w": 1.0})
    time = 4.0 * np.arange(400)
    level = TrialColumns("1", time, np.empty((400, 0)), np.column_stack([np.sin(0.01 * time), np.cos(0.01 * time)]))
    measured = check_measured([level, replace(level, name="2")], (), ("x", "v"), "tank.csv")
    assert [one.kind for one in measured.findings] == ["clock"]
    assert refuse_blow_up(slow.with_values({"w": 0.01}), measured) and not refuse_blow_up(slow, measured)


def test_where_it_blows_up_and_what_drives_it_is_told(short):
    wild = mass().with_effect(Term("load", "port", "wild", "k*exp(300*abs(x))"))
    with pytest.raises(SimulationError, match=r"trial.*t =.*'v'.*'k'"):
        refuse_blow_up(wild, short)


def test_effects_that_are_given_are_fitted_and_nothing_is_searched():
    """The true one is borne out; one that is not there is said to be idle beside it."""
    measured = record(with_load("-14*x**3"), SEED)
    discovery, augmented = discover(mass(), measured, Request(effects=("cubic_stiffness@load", "constant_load@load")))
    assert _named(discovery)[1] == [("cubic_stiffness", "load"), ("constant_load", "load")]
    assert [one.small for one in discovery.effects] == [False, True]
    assert discovery.given == "proven"
    assert says(discovery.sentence, "given", "suffice without constant load at the load port")
    assert discovery.effects[0].estimates["stiffness"].value == pytest.approx(14.0, rel=0.05)
    assert [one.name for one in augmented.effects] == ["cubic_stiffness", "constant_load"]


def test_a_given_effect_that_is_not_there_is_refuted():
    discovery, _ = discover(mass(), record(mass(), SEED), Request(effects=("coulomb_friction@load",)))
    assert discovery.given == "refuted"
    assert says(discovery.sentence, "do not support it", "p = ")


def test_a_given_effect_that_does_not_exist_is_refused_with_the_nearest():
    with pytest.raises(SchemaError) as refused:
        discover(mass(), record(mass(), SEED), Request(effects=("cubic_stifness@load",)))
    assert says(str(refused.value), "'cubic_stifness@load'", "cubic_stiffness@load")


def test_accounts_are_of_the_whole_gap_and_what_was_named_comes_first():
    discovery, _ = _found(with_load("-14*x**3"))
    first, *others = discovery.explanations
    assert first.as_given == "cubic_stiffness@load"
    assert others
    assert first.held_out is not None
    assert all(one.held_out.after > first.held_out.after for one in others)
    assert discovery.held_out.of == "trial 4"


@pytest.mark.slow
def test_a_term_goes_before_the_random_pushes_beside_it():
    discovery, _ = _found(with_load("-1.5*sign(v)"), Experiment(seconds=8.0, shaking=3.0))
    assert _named(discovery) == ("missing_physics", [("coulomb_friction", "load")])
    assert discovery.effects[0].estimates["friction"].value == pytest.approx(1.5, rel=0.2)


def test_the_answer_says_how_large_an_error_of_an_input_would_explain_it_as_well():
    found, _ = _found(with_load("-1.5*sign(v)"))
    (exact,) = (one for one in found.findings if one.kind == "exact inputs")
    assert says(exact.what, " N (rms)", "'push'", "Coulomb friction")
    size = float(exact.what.split("an error of ")[1].split(" ")[0])
    assert size == pytest.approx(1.5, rel=0.03)


def test_the_rate_of_false_finds_is_the_users():
    strict, usual = (PairedTest(0.01, 9, 1.0, alpha) for alpha in (0.005, 0.05))
    assert (strict.bears_out, usual.bears_out) == (False, True)
    found, _ = discover(mass(), record(mass(), SEED), Request(effects=("quadratic_drag@load",), alpha=0.2))
    assert found.held_out.alpha == 0.2
    assert found.to_json()["gap"]["held_out"]["alpha"] == 0.2


@pytest.mark.parametrize("alpha", [0.0, 1.0, -0.1, float("nan")])
def test_a_rate_that_is_none_is_refused(alpha):
    with pytest.raises(SchemaError, match=f"alpha.*{alpha:g}"):
        Request.read(None, (), alpha)
