"""A pendulum expanded along a run: the expanded simulation runs as MuJoCo does, forces and parameters included."""

from dataclasses import replace

import numpy as np

from gaitdisc.engines.engine import Motion
from gaitdisc.engines.expansion import expanded
from gaitdisc.engines.mapping import drafted, with_input_changed
from gaitdisc.engines.model_file import read_model
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.running import compile_simulation

RATE, SAMPLES = 100.0, 150


def test_runs_near_the_record_are_those_of_the_engine(pendulum):
    model = read_model(pendulum)
    t = np.arange(SAMPLES) / RATE
    controls = 0.3 * np.sin(9.0 * t)[:, None]
    begun = Motion(np.array([[0.4]]), np.zeros((1, 1)), np.zeros((1, 1)))
    whole = model.run(begun, controls[None], RATE)
    drive = Drive.of([controls], RATE)
    measured = Measured(drive, whole[:, :, :1], ("1",), ("pivot",))
    linear, driven = expanded(drafted(model), model, measured, whole)
    machine = compile_simulation(linear)
    start = whole[:, 0]
    run = machine.run(driven.drive, Rows(np.zeros(1, int), np.zeros(1, int), start), SAMPLES - 1)[0]
    assert np.abs(run[0, :, 0] - whole[0, :, 0]).max() < 3e-3 * np.ptp(whole[0, :, 0])  # steps of 1 ms, first order

    names = [one.name for one in linear.inputs if one.computed]
    assert names and all(one.startswith("pivot_speed_") for one in names)
    assert [one.name for one in linear.driving] == ["drive"]

    point = [np.array([t[70]]), whole[:, 70], driven.drive.inputs[:, 70]]
    pushed = compile_simulation(linear.with_effect(Term("pivot_moment", "port", "push", "2.5")))
    at = Motion(whole[:, 70, :1], whole[:, 70, 1:], controls[70:71])
    assert np.allclose(machine.rates(*point)[:, 1:], model.accelerations(at, {}), rtol=1e-9)
    assert np.allclose(pushed.rates(*point)[:, 1:], model.accelerations(at, {}, np.full((1, 1), 2.5)), rtol=1e-9)

    half = expanded(with_input_changed(drafted(model), "drive", "0.5*drive"), model, measured, whole)[0]
    at = Motion(at.q, at.v, at.u / 2)
    assert np.allclose(compile_simulation(half).rates(*point)[:, 1:], model.accelerations(at, {}), rtol=1e-9)
    at = Motion(at.q, at.v, at.u * 2)

    heavier = compile_simulation(linear.with_values({"rod_mass": 2.02}))
    wanted = model.accelerations(at, {"rod_mass": 2.02})
    assert np.allclose(heavier.rates(*point)[:, 1:], wanted, rtol=1e-3)
    around, other = expanded(drafted(model), model, measured, whole, {"rod_mass": 2.02})
    again = compile_simulation(replace(around, parameters=around.with_values({"rod_mass": 2.02}).parameters))
    assert np.allclose(again.rates(*point[:2], other.drive.inputs[:, 70])[:, 1:], wanted, rtol=1e-9)
