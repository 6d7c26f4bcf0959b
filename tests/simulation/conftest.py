"""Simulations that several tests run."""

import pytest

from gaitdisc.simulation.simulation_file import parse_simulation

ANKLE = """
title = "Ankle"            # a joint
[states.theta]
unit = "rad"
[states.omega]
unit = "rad/s"
[inputs.tau]
unit = "N m"
[inputs.phase]
unit = "1"
[parameters.inertia]
value = 0.12
[parameters.b]
value = 1.1
[parameters.k]
value = 25.0   # passive
low = 10
high = 60
[ports.ankle_moment]
unit = "N m"
[definitions]
spring = "k*theta"
[equations]
theta = "omega"
omega = "(tau + ankle_moment - b*omega - spring)/inertia"
"""


@pytest.fixture
def ankle():
    return parse_simulation(ANKLE, "ankle.toml")


@pytest.fixture
def ankle_text():
    return ANKLE
