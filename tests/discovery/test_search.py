from dataclasses import replace

import pytest
from hidden_in_a_mass import DAMPER, ONE_SIDED, Experiment, mass, record

from gaitdisc.discovery.candidate import Candidate, saturations
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.catalogue import ALL
from gaitdisc.discovery.scored_model import Part
from gaitdisc.discovery.search import is_certain

SLACK = Candidate("missing_physics", "port", "load", "slack", ("max(0, x - _d)",), {"d": "half widths of x"}, "x")
LATE = Candidate("missing_physics", "port", "load", "late", ("delay(x, _d)",), {"d": "delays"}, "x")
DELAY = Candidate("input_error", "input", "push", "input_delay")
LAG = Candidate("sensor_error", "observation", "x", "sensor_lag")
FRICTION = Candidate("missing_physics", "port", "load", "coulomb_friction", ("sign(v)",), None, "x")
FORCING = Candidate(
    "missing_physics", "port", "load", "periodic_forcing", ("sin(_w*t)", "cos(_w*t)"), {"w": "frequencies"}, "x"
)


def _with(model, candidate, **values):
    return replace(model, parts=(Part(candidate, values),))


@pytest.mark.parametrize(
    ("candidate", "values", "sensible"),
    [
        (ONE_SIDED, {"factor": -9.0, "x0": 0.1}, True),
        (ONE_SIDED, {"factor": -9.0, "x0": 40.0}, False),
        (ONE_SIDED, {"factor": -9.0, "x0": -40.0}, False),
        (SLACK, {"factor": -9.0, "d": 0.2}, True),
        (SLACK, {"factor": -9.0, "d": -0.2}, False),
        (LATE, {"factor": -9.0, "d": 0.05}, True),
        (LATE, {"factor": -9.0, "d": -0.05}, False),
        (LATE, {"factor": -9.0, "d": 99.0}, False),
        (DELAY, {"seconds": 0.1}, True),
        (DELAY, {"seconds": -0.1}, True),
        (DELAY, {"seconds": -99.0}, False),
        (LAG, {"seconds": 0.1}, True),
        (LAG, {"seconds": -0.1}, False),
        (FRICTION, {"factor": -9.0}, True),
        (FRICTION, {"factor": 9.0}, False),  # it would drive
        (replace(FRICTION, power=-1.0), {"factor": 9.0}, True),  # at a port that holds its motion back
        (replace(FRICTION, power=0.0), {"factor": 9.0}, True),  # of another body's motion
        (FORCING, {"factor": 1.0, "factor_1": 1.0, "w": 3.0}, True),
        (FORCING, {"factor": 1.0, "factor_1": 1.0, "w": 0.1}, False),  # of less than a cycle in a trial
    ],
)
def test_a_number_has_to_lie_where_it_means_what_its_name_says(case, as_read, candidate, values, sensible):
    assert case.search.sensible(_with(as_read, candidate, **values)) is sensible


@pytest.mark.parametrize(("seconds", "sensible"), [(0.1, True), (-0.1, False)])
def test_an_input_that_lags_is_not_early_as_well(case, as_read, seconds, sensible):
    late = Part(DELAY, {"seconds": seconds})
    lagging = Part(Candidate("input_error", "input", "push", "input_lag"), {"seconds": 0.1})
    assert case.search.sensible(replace(as_read, parts=(late, lagging))) is sensible


def test_a_fit_that_failed_is_not_sensible(case, as_read):
    failed = replace(as_read.fit, white=as_read.fit.white * float("inf"))
    assert not case.search.sensible(replace(as_read, fit=failed))


def _both(case, as_read, cubic):
    parts = (Part(cubic, {"factor": -14.0}), Part(DAMPER, {"factor": 0.0}))
    return as_read.refitted(as_read.shooting, parts)


def test_less_one_explanation_the_others_stay(case, as_read, cubic):
    both = _both(case, as_read, cubic)
    assert case.search.without(both, 0).labels == ("viscous_damping@load",)
    assert case.search.without(both, 1).labels == ("cubic_stiffness@load",)


def test_a_number_lost_in_its_error_is_not_certain(case, as_read, cubic):
    both = _both(case, as_read, cubic)
    assert not is_certain(both)
    assert is_certain(case.search.without(both, 1))


@pytest.mark.parametrize("limit", [2.0, 8.0])
def test_a_servo_beyond_its_force_nearly_always_gets_its_limit_from_the_record(limit):
    """A run without a limit follows the servo, and no force along it comes near the limit."""
    servo = replace(mass(), equations=(("x", "v"), ("v", "(150*push - 150*x - 15*v + load - k*x - c*v)/m")))
    (*_, candidate) = saturations(servo, {"push": (150.0, 0.0, "-150*x - 15*v")})
    truth = candidate.written(servo, {"limit": f"{limit}"})
    case = set_up_case(servo, record(truth, 3, Experiment(seconds=6.0)), replace(ALL, added=(candidate,)))
    (found,) = (one for one in case.search.far_off(case.as_read()) if one.parts[0].candidate is candidate)
    assert found.parts[0].values["limit"] == pytest.approx(limit, rel=0.02)
