"""A run that blows up is told with trial, time, state and parameter."""

import numpy as np
import pytest

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.running import compile_simulation, find_divergence, refuse_divergence
from gaitdisc.simulation.simulation_file import parse_simulation

TEXT = """title = "growth"
[states.x]
[states.y]
[parameters.calm]
value = 1.0
[parameters.wild]
value = 20.0
[equations]
x = "-calm*x"
y = "wild*y - calm*y{more}"
"""


def _run(more="", values=None):
    compiled = compile_simulation(parse_simulation(TEXT.format(more=more)))
    drive = Drive.of([np.empty((101, 0))] * 2, 100.0, [0.0, 5.0])
    rows = Rows(np.array([0, 1]), np.array([0, 10]), np.array([[1.0, 0.0], [1.0, 1.0]]), values)
    return compiled, drive, rows, *compiled.run(drive, rows, 80)


def test_trial_time_state_and_parameter():
    *run, ok = _run()
    told = find_divergence(*run, 1)
    assert (ok.tolist(), told.trial, told.state, told.parameter) == ([True, False], 1, "y", "wild")
    assert told.time == pytest.approx(5.1 + np.log(1e6) / 19, abs=0.011)
    assert 1e5 < told.value < 1e6


def test_the_refusal_says_so():
    with pytest.raises(SimulationError, match=r"'growth'.*trial 2.*= 5\.8.*'y'.*'wild'"):
        refuse_divergence(*_run())
    refuse_divergence(*_run(values=np.array([1.0, 2.0])))


def test_a_row_that_is_lost_at_once():
    *run, ok = _run(" + sqrt(-1 - y**2)")
    one, other = (find_divergence(*run, row) for row in np.flatnonzero(~ok))
    assert (one.state, one.time) == ("y", 0.0)
    assert other.time == 5.1


def test_with_a_delay():
    assert find_divergence(*_run(" + 0*delay(x, 0.1)")[:4], 1).parameter == "wild"


@pytest.mark.parametrize(
    ("rate", "words"),
    [
        (0.1, r"10 s apart.*\(the time must be in seconds, not in milliseconds\)"),
        (100.0, r"Samples 0.01 s apart may also be too coarse for this motion\.$"),
    ],
)
def test_a_record_so_coarse_is_likelier_one_in_milliseconds(rate, words):
    compiled = compile_simulation(parse_simulation(TEXT.format(more="")))
    drive, rows = Drive.of([np.empty((101, 0))], rate), Rows(np.array([0]), np.array([0]), np.array([[1.0, 1.0]]))
    with pytest.raises(SimulationError, match=words):
        refuse_divergence(compiled, drive, rows, *compiled.run(drive, rows, 80))
