from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_function import tank, write_record
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.answer import answer, augmented_of, phase_of, region_of
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.candidate_model import Part
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.process_noise import rank_process_noise
from gaitdisc.discovery.scored_model import compared
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.parts import Input
from gaitdisc.simulation.running import compile_simulation

ABOVE = Candidate(
    "missing_physics", "port", "load", "one_sided_spring", ("max(0, x - _x0)",), {"x0": "quantiles of x"}, "x"
)
BELOW = replace(ABOVE, pieces=("max(0, _x0 - x)",))
SLACK = replace(
    ABOVE, name="dead_zone_spring", pieces=("max(0, x - _d) - max(0, -x - _d)",), constants={"d": "half widths of x"}
)


@pytest.fixture(scope="module")
def answered(case, as_read, named):
    now, rivals = named
    plain, *_ = compared([as_read, now], case.search.base)
    return answer(case, plain, Verdict("missing_physics", now, tuple(rivals)))


def test_the_augmented_simulation_has_the_numbers_that_were_found(answered, named):
    _, augmented = answered
    value = named[0].model.parts[0].values["factor"]
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
    augmented = augmented_of(mass(), (Part(ABOVE, {"factor": -30.0, "x0": 0.25}), Part(drift, {"rate": 0.02})))
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
    assert region_of(Part(candidate, values)) == region


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
    begin, end = phase_of(case, case.as_read(), Part(pulse, {"factor": 3.0, "c": 0.4, "w": 0.1}))
    assert (begin, end) == pytest.approx((centre - half, centre + half), abs=0.03)


def test_random_pushes_of_a_function_are_answered(tmp_path):
    case = set_up_case(tank(), read_measured(write_record(tmp_path / "tank.csv"), tank()))
    as_read = case.as_read()
    process_noise, *_ = rank_process_noise(as_read.shooting, as_read.model, case.search.places)
    found, augmented = answer(case, as_read, Verdict("process_noise", as_read, (), process_noise))
    assert [(one.place, one.name) for one in found.effects] == [("leak", "process_noise")]
    assert augmented == tank()
