"""Mapping files: written from a model, read again; what the model or a record contradicts is refused in words."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from texts import says

from gaitdisc.engines.conventions import refuse_other_conventions, refuse_other_units
from gaitdisc.engines.engine import read_model
from gaitdisc.engines.mapping import draft, other_values, read_mapping, write_mapping
from gaitdisc.engines.motion import Coordinate, Motion
from gaitdisc.engines.tracked_files import draft_tracked
from gaitdisc.engines.tracked_mapping import Tracked, read_tracked, write_tracked_mapping
from gaitdisc.errors import GaitdiscError, SchemaError
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.parts import Input, Sensor, State
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import names_engine, read_simulation


def test_a_mapping_goes_to_its_file_and_back(pendulum, tmp_path):
    file = pendulum.with_suffix(".toml")
    written = write_mapping(read_model(pendulum), file, degrees=True)
    read, model = read_mapping(pendulum)  # the mapping beside it is found
    assert read == written and model.path == pendulum
    assert 'model = "pendulum.xml"' in file.read_text() and "[equations]" not in file.read_text()
    (name, expression), sensor = read.observations[0], read.sensor("pivot")
    assert (name, sensor.unit) == ("pivot", "deg")
    assert float(expression.partition("*")[0]) == pytest.approx(np.degrees(1.0))
    assert names_engine(file) and names_engine(pendulum) and not names_engine(file.with_name("else.toml"))
    (tmp_path / "walk.toml").write_text('[tracked]\nexternal_loads = "grf.xml"\n')
    assert names_engine(tmp_path / "walk.toml")


def test_a_walk_whose_motion_is_prescribed_has_nothing_to_run_forward(pendulum, tmp_path, monkeypatch):
    tracked = Tracked(tmp_path / "leg.osim", (tmp_path / "grf.xml", tmp_path / "grf.mot"))
    monkeypatch.setattr("gaitdisc.engines.mapping.read_tracked", lambda _: tracked)
    pendulum.with_suffix(".toml").write_text("[tracked]\n")
    with pytest.raises(GaitdiscError, match=r"pendulum.toml.*motion is prescribed"):
        read_mapping(pendulum)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("[inputs.drive]", "[inputs.drife]"), "has no 'drife'. Did you mean 'drive'"),
        (("[states.pivot]", "[states.pivott]"), "each coordinate or speed of a mapping must exist in the model"),
        (("[ports.pivot_moment]", "[ports.hip_moment]"), "each port of a mapping must exist in the model"),
        (("[parameters.rod_mass]", "[parameters.foot_mass]"), "has no 'foot_mass'"),
    ],
)
def test_what_is_not_the_models_is_refused(pendulum, change, words):
    file = pendulum.with_suffix(".toml")
    write_mapping(read_model(pendulum), file)
    text = file.read_text()
    assert change[0] in text
    if change[0].startswith("[states"):
        text = text.replace('expression = "pivot"', 'expression = "pivott"')
    file.write_text(text.replace(*change))
    with pytest.raises(GaitdiscError, match=words):
        read_mapping(file)


def test_without_a_mapping_columns_and_numbers_are_the_models_and_another_number_is_said(pendulum):
    mapping, model = read_mapping(pendulum)
    assert mapping.observations == (("pivot", "pivot"),) and mapping.sensor("pivot").unit == "rad"
    assert other_values(mapping, model) == ()
    (said,) = other_values(mapping.with_values({"rod_mass": 3.0}), model)
    assert says(said.what, "rod_mass", "3", "2")


def test_a_mapping_is_no_simulation_that_runs_by_itself(pendulum):
    with pytest.raises(GaitdiscError, match=r"pendulum.xml.*to `gaitdisc discover`"):
        compile_simulation(draft(read_model(pendulum)))


def test_equations_beside_a_model_are_refused(pendulum):
    file = pendulum.with_suffix(".toml")
    write_mapping(read_model(pendulum), file)
    file.write_text(file.read_text() + '\n[equations]\npivot = "pivot_speed"\n')
    with pytest.raises(GaitdiscError, match="the equations must be either in the file"):
        read_simulation(file)


DATA = Path(__file__).parents[3] / "shared/data/opensim_gait10dof"
LOADS = DATA / "ExperimentalData/subject01_walk_grf.xml"


@pytest.mark.skipif(not DATA.is_dir(), reason="the recorded walk is not here")
def test_a_mapping_of_recorded_forces_goes_to_its_file_and_back(tmp_path):
    pytest.importorskip("opensim", reason="OpenSim is not installed: gaitdisc[opensim]")
    forces = DATA / "CMC/results_no_spring/walk_subject_Actuation_force.sto"
    model, reserves = DATA / "CMC/subject01_metabolics.osim", DATA / "gait10dof_Reserve_Actuators.xml"
    tracked, engine, columns = draft_tracked(model, LOADS, forces, reserves)
    assert len(engine.coordinates) == 10 and len(columns) == len(engine.actuators)
    assert engine.mass_kg == pytest.approx(72.6, abs=0.1)
    given = replace(tracked, noise_deg=0.5, start_s=0.7)
    write_tracked_mapping(given, tmp_path / "walk.toml")
    read = read_tracked(tmp_path / "walk.toml")
    assert read is not None and [one.resolve() for one in read.files] == [one.resolve() for one in given.files]
    assert (read.noise_deg, read.start_s, read.end_s) == (0.5, 0.7, float("inf"))
    with pytest.raises(GaitdiscError, match=r"which is no actuator.*.tracked. as actuators"):
        draft_tracked(model, LOADS, forces)  # its reserves are in no file that is named


RATE_HZ, SECONDS = 100.0, 3.0
NAMES = ("hip", "knee")
DEGREES = {name: f"57.2957795*{name}" for name in NAMES}


def accelerations(q, v, u, spring=0.0):
    """Of two segments, one on the other, in small motion; gravity and the chain tie one joint to the other."""
    hip = -30 * np.sin(q[..., 0]) + 12 * np.sin(q[..., 1]) - 0.8 * v[..., 0] + 20 * u[..., 0]
    knee = 18 * np.sin(q[..., 0]) - 60 * np.sin(q[..., 1]) - 1.5 * v[..., 1] - 15 * u[..., 0] - spring * q[..., 1]
    return np.stack([hip, knee], axis=-1)


class Legs:
    """An engine that is those equations."""

    path, called = Path("legs.xml"), "MuJoCo"
    coordinates = tuple(Coordinate(name, "rad", name) for name in NAMES)

    def along(self, q, v, controls, rate):
        return Motion(q, v, controls)

    def accelerations(self, at, values, forces=None):
        return accelerations(at.q, at.v, at.u)


def recorded(factors, spring=0.0):
    """Record of one trial, its smoothed states times some factors."""
    t = np.arange(round(SECONDS * RATE_HZ)) / RATE_HZ
    u = (0.5 * np.sin(3.1 * t) + 0.4 * np.sin(7.3 * t + 1))[:, None]

    def rates(time, y):
        drive = np.array([np.interp(time, t, u[:, 0])])
        return np.concatenate([y[2:], accelerations(y[:2], y[2:], drive, spring)])

    y = solve_ivp(rates, (0, t[-1]), [0.2, -0.1, 0.0, 0.0], t_eval=t, rtol=1e-8, atol=1e-10).y.T
    measured = SimpleNamespace(drive=Drive.of([u], RATE_HZ, 0.0), rate=RATE_HZ)
    return measured, (y * np.tile(factors, 2))[None]


@pytest.fixture
def mapping():
    speeds = tuple(f"{name}_speed" for name in NAMES)
    states = (*(State(name, "rad") for name in NAMES), *(State(name, "rad/s") for name in speeds))
    sensors = tuple(Sensor(name, "deg") for name in NAMES)
    lines = tuple((one.name, "0") for one in states)
    return Simulation(
        "legs", states, (Input("motor", "1"),), equations=lines, observations=tuple(DEGREES.items()), sensors=sensors
    )


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ((1, -1), r"column 'knee' has the opposite sign: .* expression = \"-\(57.2957795\*knee\)\""),
        ((-1, -1), r"column 'hip' has the opposite sign, and so does 'knee'"),
        ((1, np.pi / 180), r"'knee' is in radians: .* unit = \"rad\", expression = \"knee\""),
        ((np.pi / 180, np.pi / 180), r"is in radians, and so is '\w+'"),
        ((180 / np.pi, 1), r"'hip' is in degrees"),
    ],
)
def test_another_convention_is_refused(mapping, factors, words):
    with pytest.raises(SchemaError, match=words):
        refuse_other_conventions(mapping, Legs(), *recorded(np.array(factors, float)))


@pytest.mark.parametrize("spring", [0.0, 20.0, 60.0, 200.0])
def test_a_missing_spring_is_no_other_convention(mapping, spring):
    refuse_other_conventions(mapping, Legs(), *recorded(np.ones(2), spring))


def test_degrees_that_can_be_no_radians_are_refused(mapping):
    refuse_other_units(mapping, Legs(), *recorded(np.ones(2)))
    measured, states = recorded(np.array([1, 180 / np.pi]))
    largest = np.abs(states[..., 1]).max()
    with pytest.raises(SchemaError, match=rf"'knee'.*{largest:.4g} rad.*--degrees"):
        refuse_other_units(mapping, Legs(), measured, states)


def test_a_wheel_turns_as_often_as_it_does(mapping, monkeypatch):
    """The engine follows 90 rad as radians: as degrees its accelerations would be far too large."""
    measured, states = recorded(np.ones(2))
    time = np.arange(states.shape[1]) / RATE_HZ
    wheel = np.column_stack([states[0, :, 0], 10 * time**2, states[0, :, 2], 20 * time])[None]
    monkeypatch.setattr(Legs, "accelerations", lambda *_: np.gradient(wheel[0, :, 2:], 1 / RATE_HZ, axis=0))
    refuse_other_units(mapping, Legs(), measured, wheel)
