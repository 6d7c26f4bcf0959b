"""Running a simulation over time, against closed forms; a model as a script names it."""

import math

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

import gaitdisc as gd
from gaitdisc.channel import Channel
from gaitdisc.engines.engine import read_model
from gaitdisc.engines.mapping import with_input_changed, write_mapping
from gaitdisc.errors import SamplingError, SchemaError, ShapeError, SimulationError
from gaitdisc.library.simulating import as_model
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.simulation_file import bundled
from gaitdisc.simulation.writing import write_simulation

TIME = np.linspace(1.0, 3.0, 201)


def driven(x, u, rate=0.7):
    return u - rate * x


def test_a_decay_follows_the_exponential():
    run = gd.simulate(lambda x, rate=0.7: -rate * x, TIME, start=[2.0])
    np.testing.assert_allclose(run["x"], 2.0 * np.exp(-0.7 * (TIME - 1.0)), atol=1e-9)
    assert (run.rate_hz, run.time[0]) == (100.0, 1.0)


def test_inputs_may_be_a_mapping_a_table_or_a_recording():
    u = np.sin(TIME)
    given = ({"u": u}, pd.DataFrame({"u": u}), gd.Recording(TIME, u[:, None], (Channel("u", "signal", "1"),)))
    runs = [gd.simulate(driven, TIME, one, {"x": 0.0}) for one in given]
    assert runs[0].names == ("x", "u")
    for run in runs[1:]:
        np.testing.assert_allclose(run.values, runs[0].values, atol=1e-12)
    rate = np.gradient(runs[0]["x"], TIME)[1:-1]
    np.testing.assert_allclose(rate, (u - 0.7 * runs[0]["x"])[1:-1], atol=1e-4)


def test_an_observation_has_the_input_and_the_time_of_its_sample():
    model = gd.simulation_from_function(lambda x, u: u - x, observations={"seen": "x + u + 2*t"})
    run = gd.simulate(model, TIME, {"u": np.sin(TIME)}, start=[0.0])
    np.testing.assert_allclose(run["seen"], run["x"] + np.sin(TIME) + 2 * TIME, atol=1e-12)


def test_units_are_those_of_the_simulation():
    pendulum = gd.bundled_simulation("pendulum")
    run = gd.simulate(pendulum, TIME, start={state.name: 0.1 for state in pendulum.states},
                      inputs={each.name: np.zeros(len(TIME)) for each in pendulum.inputs})  # fmt: skip
    assert {channel.unit for channel in run.channels} >= {"rad"}
    tank = gd.simulation_from_function(lambda level: -level, {"level": "m^3"})
    assert gd.simulate(tank, TIME, start=[1.0]).channels[0].unit == "1"  # no unit of the closed list


@pytest.mark.parametrize(
    ("keywords", "error", "words"),
    [
        ({}, SimulationError, r"'u' is not among the given inputs \(none\)"),
        ({"inputs": {"u": np.zeros(3)}}, ShapeError, r"'u' must have one value per time .* \(3,\), but there are 201"),
        ({"inputs": {"u": np.full(201, np.nan)}}, SimulationError, "'u' is missing at t = 1 s"),
        ({"inputs": {"u": np.zeros(201)}}, SimulationError, "the state 'x' has none"),
        ({"inputs": {"u": np.zeros(201)}, "start": [1.0, 2.0]}, ShapeError, "a number for each state: x"),
        ({"inputs": {"u": np.zeros(201)}, "start": {"y": 1.0}}, SimulationError, "there is no 'y'"),
    ],
)
def test_what_is_missing_is_named(keywords, error, words):
    with pytest.raises(error, match=words):
        gd.simulate(driven, TIME, **keywords)


def test_uneven_time_one_sample_and_a_state_that_leaves_all_bounds_are_refused():
    with pytest.raises(SamplingError, match="a constant"):
        gd.simulate(lambda x: -x, [0.0, 0.1, 0.4], start=[1.0])
    with pytest.raises(ShapeError, match="three"):
        gd.simulate(lambda x: -x, [0.0], start=[1.0])
    with pytest.raises(SimulationError, match="x"):
        gd.simulate(lambda x: x**2, np.linspace(0.0, 3.0, 301), start=[1.0])


@pytest.fixture
def engine_pendulum(tmp_path):
    """Mapping of a pendulum of MuJoCo in degrees: 2 kg at 0.4 m, 0.05 kg m2, a motor with gear 5."""
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install 'gaitdisc[mujoco]'")
    (tmp_path / "pendulum.xml").write_text(
        '<mujoco><option timestep="0.0005" integrator="RK4"/><worldbody><body><joint name="pivot" axis="0 -1 0"/>'
        '<inertial pos="0 0 -0.4" mass="2" diaginertia="0.05 0.05 0.001"/></body></worldbody>'
        '<actuator><motor name="drive" joint="pivot" gear="5"/></actuator></mujoco>'
    )
    write_mapping(read_model(tmp_path / "pendulum.xml"), tmp_path / "pendulum.toml", degrees=True)
    return tmp_path / "pendulum.toml"


def swing(stiffness, time, drive):
    """Angle [deg] of that pendulum with a spring, by scipy."""

    def rates(t, x):
        moment = -2 * 9.81 * 0.4 * np.sin(x[0]) - stiffness * x[0] + 5 * np.interp(t, time, drive)
        return x[1], moment / (0.05 + 2 * 0.4**2)

    return np.rad2deg(solve_ivp(rates, time[[0, -1]], [0.3, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0])


def test_an_engine_runs_its_model_and_what_the_mapping_adds(engine_pendulum):
    time, start = np.linspace(0.0, 2.0, 401), {"pivot": 0.3, "pivot_speed": 0.0}
    drive = 0.2 * np.sin(3 * time)
    run = gd.simulate(engine_pendulum, time, {"drive": drive}, start)
    np.testing.assert_allclose(run["pivot"], swing(0.0, time, drive), atol=0.05)  # a control is held over a sample
    assert next((one.name, one.unit) for one in run.channels) == ("pivot", "deg")
    mapping = gd.read_simulation(engine_pendulum)
    write_simulation(
        mapping.with_effect(gd.Term("pivot_moment", "port", "linear_stiffness", "-6*pivot")), engine_pendulum
    )
    stiff = gd.simulate(engine_pendulum, time, {"drive": drive}, start)
    np.testing.assert_allclose(stiff["pivot"], swing(6.0, time, drive), atol=0.05)
    pushed = mapping.with_effect(gd.Term("pivot_moment", "port", "push", "2*sin(3*t)"))
    write_simulation(with_input_changed(pushed, "drive", "0.5*drive"), engine_pendulum)
    late = gd.simulate(engine_pendulum, time + 1.0, {"drive": drive}, start)  # a push of the model's own time
    np.testing.assert_allclose(late["pivot"], swing(0.0, time, 0.5 * drive + 0.4 * np.sin(3 * time + 3)), atol=0.05)
    write_simulation(
        mapping.with_effect(gd.Term("pivot_moment", "port", "push", "-delay(pivot, 0.1)")), engine_pendulum
    )
    with pytest.raises(SchemaError, match=r"pendulum.toml.*pivot_moment.*write them into"):
        gd.simulate(engine_pendulum, time, {"drive": drive}, start)


@pytest.mark.parametrize("u", [np.sin, 0.5], ids=["function", "number"])
def test_an_input_may_be_a_function_of_the_time_or_a_number(u):
    values = u(TIME) if callable(u) else np.full(len(TIME), u)
    run = gd.simulate(driven, TIME, {"u": u}, start=[0.5])
    np.testing.assert_array_equal(run.values, gd.simulate(driven, TIME, {"u": values}, start=[0.5]).values)


def test_a_table_with_times_is_read_at_the_times_of_the_run():
    slow = np.arange(0.0, 5.0, 0.02)
    table = pd.DataFrame({"time": slow, "u": slow})  # a ramp: linear between its samples
    run = gd.simulate(driven, TIME, table, start=[0.5])
    np.testing.assert_allclose(run["u"], TIME, atol=1e-12)


def test_inputs_without_names_and_a_span_in_place_of_times_are_refused():
    with pytest.raises(SimulationError, match=r"without names.*inputs=\{'u'"):
        gd.simulate(driven, TIME, np.sin(TIME), start=[0.5])
    for time in ((0.0, 5.0), 5.0):
        with pytest.raises(ShapeError, match=r"three.*np\.linspace"):
            gd.simulate(lambda x: -x, time, start=[0.5])


def test_a_walk_whose_motion_is_prescribed_is_not_simulated(tracked_walk):
    with pytest.raises(SchemaError, match=r"walk.toml.*Run .gaitdisc discover"):
        gd.simulate(tracked_walk, TIME)


def test_a_file_an_object_and_a_function_are_models(tmp_path):
    pendulum = bundled("pendulum")
    file = write_simulation(pendulum, tmp_path / "pendulum.toml")
    assert as_model(file) == as_model(str(file)) == as_model(pendulum) == pendulum
    assert as_model(lambda x: -x).equations == (("x", "-x"),)
    model = as_model(lambda x: math.erf(x))  # noqa: PLW0108 its argument is the state
    assert isinstance(model, PythonSimulation) and as_model(model) is model


def test_anything_else_is_refused():
    with pytest.raises(SimulationError, match="Python function; found"):
        as_model(3)  # pyright: ignore[reportArgumentType]
