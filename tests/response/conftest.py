"""A walk whose equations are known: two damped oscillators, a torque locked to the phase, a spring on one of them."""

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.recording import Strides, Trajectory
from gaitdisc.response.fit_response import ResponseSettings, fit_response

KNEE, ANKLE = "knee_angle_r", "ankle_angle_r"
SPRING = 40.0  # 1/s2; the slack one acts where the ankle is beyond 0 deg


def no_spring_at_all(ankle):
    return 0.0 * ankle


def linear_spring(ankle):
    return -SPRING * ankle


def slack_spring(ankle):
    return -SPRING * np.maximum(ankle, 0.0)


def accelerated(q, qdot, phi, spring):
    turn = 2 * np.pi * phi / 100
    knee = -90 * q[0] - 4 * qdot[0] + 25 * (q[1] - q[0]) + 700 * np.cos(turn) + 300 * np.sin(2 * turn)
    ankle = -60 * q[1] - 3 * qdot[1] + 25 * (q[0] - q[1]) + 500 * np.sin(turn + 1) + 200 * np.cos(3 * turn)
    return np.array([knee, ankle + spring(q[1])])


def oscillated(spring, seed, duration_s=60.0, subject="P01"):
    """Walk at 100 Hz; random kicks between samples let it visit more than its limit cycle."""
    rng = np.random.default_rng(seed)
    durations = rng.normal(1.1, 0.02, int(duration_s) + 5)
    contacts = np.concatenate([[-0.4], -0.4 + np.cumsum(durations)])
    strides = Strides(contacts[:-1], contacts[1:], "r", "oscillator")
    time = np.arange(round(duration_s * 100)) / 100
    fine = strides.phi(np.arange(4 * len(time)) / 400)
    q, qdot = np.zeros(2), np.zeros(2)
    x, xdot, xddot = (np.empty((len(time), 2)) for _ in range(3))
    for k in range(len(time)):
        x[k], xdot[k], xddot[k] = q, qdot, accelerated(q, qdot, fine[4 * k], spring)
        if rng.random() < 0.05:
            qdot = qdot + rng.normal(0, 60, 2)
        for step in range(4):
            qdot = qdot + accelerated(q, qdot, fine[4 * k + step], spring) / 400
            q = q + qdot / 400
    channels = tuple(Channel(name, "angle", "deg", "r") for name in (KNEE, ANKLE))
    usable = np.ones(x.shape, bool)
    condition = "nominal" if spring is no_spring_at_all else "exo"
    return Trajectory(time, x, xdot, xddot, strides.phi(time), channels, usable, subject, condition)


@pytest.fixture(scope="session")
def nominal():
    return oscillated(no_spring_at_all, 1)


@pytest.fixture(scope="session")
def exo():
    return oscillated(slack_spring, 2)


@pytest.fixture(scope="session")
def linear_exo():
    return oscillated(linear_spring, 2)


@pytest.fixture(scope="session")
def no_spring():
    return oscillated(no_spring_at_all, 3)


@pytest.fixture(scope="session")
def settings():
    return ResponseSettings((KNEE, ANKLE), training=TrainingSettings(decays=(0.0,)))


@pytest.fixture(scope="session")
def judged(nominal, exo, settings):
    """One participant, fitted and judged; with a null for the ankle alone."""
    told = []
    found = fit_response(nominal, exo, settings, {ANKLE: 0.507}, told.append)
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)
    return found
