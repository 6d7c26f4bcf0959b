"""A record of another sign or unit than the model's is refused; one of a model that lacks something is not."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gaitdisc.engines.conventions import refuse_other_conventions, refuse_other_units
from gaitdisc.engines.engine import Coordinate, Motion
from gaitdisc.errors import SchemaError
from gaitdisc.simulation.drive import Drive
from gaitdisc.simulation.parts import Input, Sensor, State
from gaitdisc.simulation.simulation import Simulation

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
        ((1, -1), r"column 'knee' has the other sign: .* expression = \"-\(57.2957795\*knee\)\""),
        ((-1, -1), r"column 'hip' has the other sign, and so does 'knee'"),
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
    refuse_other_units(mapping, Legs(), {"hip": 0.3, "knee": 1.2})
    with pytest.raises(SchemaError, match=r"'knee'.*45 rad.*--degrees"):
        refuse_other_units(mapping, Legs(), {"hip": 0.3, "knee": 45.0})
