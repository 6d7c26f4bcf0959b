"""A run that blows up is told with trial, time, state and parameter."""

import numpy as np
import pytest

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.running import compile_simulation, refuse_divergence
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


def test_trial_time_state_value_and_parameter():
    """From 5.1 s on y grows as exp(19 t), so that it passes 1e6 at 5.83 s."""
    said = r"'growth' diverges in trial 2 after t = 5\.82 s, first in 'y' \(last value \d\.?\d*e\+05\)\..*'wild'"
    with pytest.raises(SimulationError, match=said):
        refuse_divergence(*_run())
    refuse_divergence(*_run(values=np.array([1.0, 2.0])))


def test_a_row_that_is_lost_at_once():
    with pytest.raises(SimulationError, match=r"trial 1 after t = 0 s, first in 'y' .*; so do 1 more of 2 runs"):
        refuse_divergence(*_run(" + sqrt(-1 - y**2)"))


def test_with_a_delay():
    with pytest.raises(SimulationError, match="'wild'"):
        refuse_divergence(*_run(" + 0*delay(x, 0.1)"))


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
