import numpy as np
import pytest
from chapter3.cell import learned_model
from chapter3.methods import MethodSettings
from chapter3.record import Conditions, recorded, system_of
from chapter3.starts import filtered_start

from gaitdisc.errors import ShapeError
from gaitdisc.simulation.simulation_file import bundled


@pytest.mark.parametrize("by", ["unscented", pytest.param("ensemble", marks=pytest.mark.slow)])
def test_a_filter_is_nearer_to_the_true_state_than_the_last_sample_and_its_smoothing(van_der_pol, by):
    record = recorded(van_der_pol, Conditions(noise=0.1, duration_s=20.0, seed=5))
    learned = learned_model(record, "sindy", "dynamics", MethodSettings())
    true = record.start(forecast=True)
    error = np.linalg.norm(filtered_start(record, learned, by) - true)
    assert error < 0.5 * np.linalg.norm(record.filtered[-1] - true)


def test_states_that_nobody_measures_are_refused():
    hidden = system_of(bundled("mass_spring_damper"), gain=(1.1,))
    record = recorded(hidden, Conditions(noise=0.01, duration_s=5.0))
    with pytest.raises(ShapeError, match=r"2 states.*1 are: x"):
        filtered_start(record, lambda x: x, "unscented")
