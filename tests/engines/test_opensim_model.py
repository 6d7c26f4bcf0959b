"""A double pendulum of OpenSim: forces, masses and its own runs; what is refused, and a process that dies."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest

from gaitdisc.engines.engine import Motion
from gaitdisc.engines.model_file import read_model
from gaitdisc.engines.opensim_text import with_effect
from gaitdisc.errors import GaitdiscError
from gaitdisc.simulation.parts import Term

FILE = Path(__file__).parents[2] / "studies" / "systems" / "double_pendulum.osim"
AT = Motion(
    np.array([[0.3, -0.2], [0.1, 0.4]]), np.array([[1.0, -2.0], [0.5, 0.7]]), np.array([[0.1, 0.2], [0.0, -0.1]])
)


@pytest.fixture(scope="module")
def model(needs_opensim):
    return read_model(FILE)


def test_names_and_numbers(model):
    assert [one.name for one in model.coordinates] == ["hip", "knee"]
    assert [one.name for one in model.controls] == ["hip_motor", "knee_motor"]
    values = {one.name: one.value for one in model.parameters}
    assert values["shank_mass"] == pytest.approx(4.6) and values["gravity"] == pytest.approx(9.81)


def test_a_control_is_its_optimal_force_times_a_moment(model):
    """The knee's motor of 15 N m at 0.2 is 3 N m on the knee, and forces add."""
    without = Motion(AT.q, AT.v, AT.u * [1.0, 0.0])
    moments = np.column_stack([np.zeros(2), 15.0 * AT.u[:, 1]])
    assert np.allclose(model.accelerations(AT, {}), model.accelerations(without, {}, moments), rtol=1e-10)


def test_a_heavier_shank_of_the_same_shape_hangs_as_before(model):
    """Of a pendulum alone, mass divides out: only what the thigh and the motors do changes."""
    still = Motion(np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 2)))
    assert np.allclose(model.accelerations(still, {"shank_mass": 6.0}), 0.0, atol=1e-12)
    changed = model.accelerations(AT, {"shank_mass": 6.0})
    assert np.abs(changed - model.accelerations(AT, {})).max() > 0.1
    assert np.allclose(model.accelerations(AT, {"shank_mass": 4.6}), model.accelerations(AT, {}), rtol=1e-9)


def test_its_own_run_starts_with_its_own_acceleration(model):
    start = Motion(AT.q[:1], AT.v[:1], AT.u[:1])
    run = model.run(start, np.repeat(AT.u[None, :1], 3, axis=1), 1000.0)[0]
    assert np.allclose((run[2, 2:] - run[0, 2:]) / 0.002, model.accelerations(start, {}), rtol=0.02)


def test_a_force_in_the_file_is_the_force_by_hand(model, tmp_path):
    term = Term("knee_moment", "port", "spring", "-30*max(0, knee - 0.1) - 0.4*sign(knee_speed)")
    path = tmp_path / "augmented.osim"
    path.write_text(with_effect(FILE.read_text(), term, ("knee", "knee_speed"), "knee"))
    force = -30 * np.maximum(0, AT.q[:, 1] - 0.1) - 0.4 * np.tanh(AT.v[:, 1] / 0.02)
    by_hand = model.accelerations(AT, {}, np.column_stack([np.zeros(2), force]))
    assert np.allclose(read_model(path).accelerations(AT, {}), by_hand, rtol=1e-10)


def test_a_process_that_dies_is_told_and_replaced(model):
    dead = model._process
    os.kill(dead.pid, signal.SIGKILL)
    dead.wait()
    assert np.isfinite(model.accelerations(AT, {})).all()  # it was started anew
    model._process.stdin.write(b"no question")
    model._process.stdin.close()
    with pytest.raises((GaitdiscError, ValueError)):
        model._conversed("described")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("<Body name", "<Boddy name"), "OpenSim reads and computes"),
        (('<Coordinate name="knee">', '<Coordinate name="knee"><locked>true</locked>'), None),
        (("</OpenSimDocument>", ""), "OpenSim reads and computes"),
    ],
)
def test_what_opensim_cannot_read_is_refused(needs_opensim, tmp_path, change, words):
    text = FILE.read_text()
    assert change[0] in text
    path = tmp_path / "pendulum.osim"
    path.write_text(text.replace(*change))
    if words is None:
        assert [one.name for one in read_model(path).coordinates] == ["hip"]  # a locked one is left out
        return
    with pytest.raises(GaitdiscError, match=words):
        read_model(path)


def test_muscles_are_refused_in_words(needs_opensim):
    arm = Path(__file__).parents[3] / "shared" / "data" / "opensim_gait10dof" / "subject01.osim"
    if not arm.is_file():
        pytest.skip("the recordings of shared/data are not here")
    with pytest.raises(GaitdiscError, match=r"17 more have states \(muscles\)"):
        read_model(arm)
