from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_function import tank, write_record
from hidden_in_a_mass import MASS, Experiment, mass, record, with_load
from hidden_in_a_mass import ONE_SIDED as ABOVE
from texts import says

from gaitdisc.discovery.answer import (
    answer,
    augment_with,
    file_bounds,
    find_phase,
    find_region,
    weigh_rivals,
)
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.process_noise import rank_process_noise
from gaitdisc.discovery.scored_model import Part, compared, fit_model, score
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.parts import Input, Parameter
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation

BELOW = replace(ABOVE, pieces=("max(0, _x0 - x)",))
SLACK = replace(
    ABOVE, name="dead_zone_spring", pieces=("max(0, x - _d) - max(0, -x - _d)",), constants={"d": "half widths of x"}
)


@pytest.fixture(scope="module")
def answered(case, as_read, named):
    now, rivals = named
    plain, *_ = compared([as_read, now])
    return answer(case, plain, Verdict(now, tuple(rivals)))


def test_the_augmented_simulation_has_the_numbers_that_were_found(answered, named):
    _, augmented = answered
    value = named[0].parts[0].values["factor"]
    assert augmented.effects[0].term == f"{value:.6g}*(x**3)"
    assert augmented.parameters == mass().parameters


def test_the_augmented_simulation_is_the_true_one_up_to_its_interval(answered):
    rng = np.random.default_rng(0)
    at = (np.zeros(50), rng.uniform(-1, 1, (50, 2)), rng.normal(size=(50, 1)))
    truth, found = (compile_simulation(one).rates(*at) for one in (with_load("-14*x**3"), answered[1]))
    np.testing.assert_allclose(found, truth, atol=0.1)


def test_the_gap_is_the_noise_once_the_effect_is_in(answered):
    discovery, _ = answered
    for size in (discovery.train, discovery.held_out):
        assert size.after == pytest.approx(size.noise_floor, rel=0.1)
        assert size.before > 3 * size.after
    assert discovery.effects[0].held_out == pytest.approx(1.0, abs=0.02)


def test_what_is_left_is_told_as_a_share_beside_the_noise_of_the_sensors(case, as_read, labelled):
    spring = as_read.refitted(as_read.shooting, (Part(labelled["linear_stiffness@load"], {"factor": -1.0}),))
    found, _ = answer(case, as_read, Verdict(score(spring), ()))
    size = found.held_out
    assert size.noise_floor == pytest.approx(0.02 * case.measured.observed.std(), rel=0.25)
    left = (size.after**2 - size.noise_floor**2) / (size.before**2 - size.noise_floor**2)
    assert found.to_json()["gap"]["held_out"]["unexplained"] == pytest.approx(left) and left > 0.1


def test_the_place_of_the_gap_and_its_share_are_given(answered):
    (where,) = answered[0].where
    assert (where.kind, where.place, where.phase) == ("port", "load", ())
    assert 0.9 < where.share_of_gap <= 1.0


def test_what_was_named_is_not_its_own_rival(answered):
    discovery, _ = answered
    assert ("cubic_stiffness", "load") not in [(one.name, one.place) for one in discovery.rivals]
    assert discovery.rivals
    assert discovery.units == ("m",)
    assert not any(one.tied for one in discovery.rivals if one.name == "linear_stiffness")


def test_numbers_are_written_one_explanation_after_the_other():
    drift = Candidate("sensor_error", "observation", "x", "sensor_drift")
    augmented = augment_with(mass(), (Part(ABOVE, {"factor": -30.0, "x0": 0.25}), Part(drift, {"rate": 0.02})))
    assert augmented.effects[0].term == "-30*(max(0, x - 0.25))"
    assert dict(augmented.observations)["x"] == "(x) + 0.02*t"


@pytest.mark.parametrize(
    ("candidate", "values", "region"),
    [
        (ABOVE, {"factor": -30.0, "x0": 0.25}, "x > 0.25"),
        (BELOW, {"factor": -30.0, "x0": -0.1}, "x < -0.1"),
        (SLACK, {"factor": -30.0, "d": 0.4}, "abs(x) > 0.4"),
        (replace(ABOVE, name="cubic_stiffness", pieces=("x**3",), constants=None), {"factor": 1.0}, ""),
    ],
)
def test_a_region_is_said_where_an_effect_has_one(candidate, values, region):
    assert find_region(Part(candidate, values)) == region


@pytest.mark.parametrize(("seen", "centre"), [("phase", 0.4), ("late", 0.5)])
def test_the_part_of_the_stride_is_where_the_effect_is_half_as_strong_as_at_its_strongest(seen, centre):
    """Also of an effect over something that comes 0.1 s late, a tenth of the stride."""
    inputs, late = (*mass().inputs, Input("phase")), (("late", "delay(phase, 0.1)"),)
    stride = replace(mass(), inputs=inputs, definitions=late)
    measured = record(mass(), 0, Experiment(2, 10.0))
    time = np.arange(measured.samples[0]) / measured.rate
    phase = np.broadcast_to((time % 1.0)[None, :, None], (2, len(time), 1))
    drive = replace(measured.drive, inputs=np.concatenate([measured.drive.inputs, phase], axis=2))
    case = set_up_case(stride, replace(measured, drive=drive))
    grids = {"c": "phases", "w": "phase widths"}
    pulse = Candidate("missing_physics", "port", "load", "pulse", (f"exp(-(({seen} - _c)/_w)**2)",), grids)
    half = 0.1 * np.sqrt(np.log(2))
    begin, end = find_phase(case, case.as_read(), Part(pulse, {"factor": 3.0, "c": 0.4, "w": 0.1}))
    assert (begin, end) == pytest.approx((centre - half, centre + half), abs=0.03)


def test_random_pushes_of_a_function_are_answered(tmp_path):
    case = set_up_case(tank(), read_measured(write_record(tmp_path / "tank.csv"), tank()))
    as_read = case.as_read()
    process_noise, *_ = rank_process_noise(as_read, case.search.places)
    found, augmented = answer(case, as_read, Verdict(as_read, (), process_noise))
    assert [(one.place, one.name) for one in found.effects] == [("leak", "process_noise")]
    assert augmented == tank()


@pytest.fixture(scope="module")
def shape(case, as_read, cubic):
    """Return an answer without a name that is the truth: no effect of the catalogue but one comes near it."""
    part = Part(replace(cubic, name="unnamed"), {"factor": -14.0})
    model = as_read.refitted(as_read.shooting, (part,))
    return score(model)


def test_the_evidence_of_an_answer_is_its_own_and_one_of_nothing_has_none(case, as_read, shape):
    before = fit_model(shape.shooting, case.search.base, (), shape.fit.starts, 15)
    (effect,) = answer(case, as_read, Verdict(shape, ()))[0].effects
    assert effect.bic == pytest.approx(before.bic - shape.bic)
    assert answer(case, as_read, Verdict(as_read, (shape,)))[0].rivals[0].bic == shape.gained


def test_rivals_are_compared_with_the_answer_and_one_that_explains_as_much_is_tied(case, shape, named):
    gained = case.search.with_others(shape, ()).bic - shape.bic
    found = tuple(one for one in named[1] if one.labels != ("cubic_stiffness@load",))
    assert found
    rivals = weigh_rivals(case.search, shape, found, gained)
    assert rivals
    assert not any(one.tied for one in rivals)
    assert all(one.gained < gained - CRITERIA.tie for one in rivals)
    first = weigh_rivals(case.search, shape, tuple(named[1]), gained)[0]
    assert first.scored.labels == ("cubic_stiffness@load",)
    assert first.tied
    assert first.gained == pytest.approx(gained, abs=0.5)


def test_one_that_is_in_the_answer_is_no_rival(case, named):
    now, found = named
    rivals = weigh_rivals(case.search, now, tuple(found), now.gained)
    assert "cubic_stiffness@load" not in [one.scored.labels[-1] for one in rivals]


def test_beside_one_of_two_a_rival_stands_in_the_place_of_the_other(case, as_read, cubic, named):
    drift = next(one for one in case.search.candidates if one.label == "sensor_drift@x")
    parts = (Part(cubic, {"factor": -14.0}), Part(drift, {"rate": 0.0}))
    model = as_read.refitted(as_read.shooting, parts)
    both = score(model)
    offset = next(one for one in case.search.candidates if one.label == "sensor_offset@x")
    other = as_read.refitted(as_read.shooting, (Part(offset, {"offset": 0.0}),))
    (rival,) = weigh_rivals(case.search, both, (other,), 0.0)
    assert rival.scored.labels == ("cubic_stiffness@load", "sensor_offset@x")
    assert rival.tied


def test_where_nothing_is_named_rivals_keep_what_they_were_found_with(case, as_read, named):
    rivals = weigh_rivals(case.search, as_read, tuple(named[1]), 0.0)
    assert [one.gained for one in rivals] == [one.gained for one in named[1]][: len(rivals)]
    assert not any(one.tied for one in rivals)


OFF = {"m": (2.0, 2.08), "k": (24.0, 22.9), "c": (0.8, 0.84)}


def within(low, high):
    """The mass, whose stiffness has bounds."""
    return mass().with_parameter(Parameter("k", 24.0, "N/m", low, high))


def believed(bounds=0.125):
    """The mass, each number off by about 4 %, within bounds."""
    text = MASS
    for true, off in OFF.values():
        low, high = off * (1 - bounds), off * (1 + bounds)
        text = text.replace(f"value = {true}", f"value = {off}\nlow = {low:.6g}\nhigh = {high:.6g}")
    return parse_simulation(text, "believed.toml")


def test_where_only_numbers_are_a_little_off_nothing_is_named_and_they_are_corrected():
    found, augmented = discover(believed(), record(mass(), 3))
    assert (found.verdict, found.effects) == ("no_gap", ())
    moved = {one.parameter: one for one in found.corrections}
    for name, (true, off) in OFF.items():
        assert moved[name].given == off
        assert moved[name].found.value == pytest.approx(true, rel=0.02)
        assert augmented.values()[name] == moved[name].found.value
    assert augmented.effects == ()
    assert "Parameters that changed within their bounds" in found.sentence


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


def test_a_parameter_with_one_bound_has_none_on_the_other_side():
    wrong = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=24.0)
    assert file_bounds(mass(), wrong) == ()
    bounded = mass().with_parameter(Parameter("k", 24.0, "N/m", high=30.0))
    assert file_bounds(bounded, wrong) == (-float("inf"), 30.0)
    assert file_bounds(bounded, replace(wrong, verdict="sensor_error")) == ()
