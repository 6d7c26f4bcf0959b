import numpy as np
import pytest

from gaitdisc.cohort.demonstration import write_demonstration
from gaitdisc.discovery.joint_and_trials import nominal_and_trials, nominal_model, stride_trials
from gaitdisc.errors import StrideError
from gaitdisc.processing.processed_walks import process_walks
from gaitdisc.simulation.running import compile_simulation


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return write_demonstration(tmp_path_factory.mktemp("study"), 30.0, 1)


@pytest.fixture(scope="module")
def nominal(study):
    return process_walks(study, study.participant("W01"))[0]["nominal"]


def test_the_model_explains_the_acceleration_of_its_own_walk(nominal):
    model = nominal_model(nominal, "ankle_angle_r")
    x, phi = np.radians(nominal.trajectory.x), nominal.trajectory.phi / 100
    column = nominal.state.names.index("ankle_angle_r")
    rate, speedup = (np.radians(each[:, column]) for each in (nominal.trajectory.xdot, nominal.trajectory.xddot))
    known = np.isfinite(np.column_stack([x[:, column], rate, speedup, phi])).all(axis=1)
    states = np.column_stack([x[:, column], rate])[known]
    machine = compile_simulation(model)
    found = machine.rates(np.zeros(known.sum()), states, phi[known, None], machine.defaults)
    np.testing.assert_array_equal(found[:, 0], states[:, 1])
    assert np.mean((found[:, 1] - speedup[known]) ** 2) < 0.1 * np.var(speedup[known])


def test_an_ankle_that_strays_from_its_habit_comes_back(nominal):
    values = nominal_model(nominal, "ankle_angle_r").values()
    assert values["stiffness"] > 0


def test_trials_are_whole_strides_of_the_device_walk(study):
    simulation, measured = nominal_and_trials(study, "W01")
    assert [port.name for port in simulation.ports] == ["acceleration"]
    phase = measured.drive.inputs[0, : measured.samples[0], 0]
    assert (np.diff(phase) < 0).sum() == 3  # four strides
    assert phase[0] < 0.02
    assert measured.channels == ("theta",)
    assert np.abs(measured.observed[0, : measured.samples[0]]).max() < np.radians(40)


def test_too_few_strides_are_refused_with_their_number(nominal, monkeypatch):
    monkeypatch.setattr("gaitdisc.discovery.joint_and_trials.MOTION_STRIDES", 100)
    with pytest.raises(StrideError, match=r"4 separate series of 100 .* 28 strides, which give 0 such series"):
        stride_trials(nominal, "ankle_angle_r")
