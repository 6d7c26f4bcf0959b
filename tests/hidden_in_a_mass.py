"""Small systems whose missing effect is known, because it was hidden here: a mass on a spring, two rods, a neuron."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import State, Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import parse_simulation

RATE = 50.0
ONE_SIDED = Candidate(
    "missing_physics", "port", "load", "one_sided_spring", ("max(0, x - _x0)",), {"x0": "quantiles of x"}, "x"
)
DAMPER = Candidate("missing_physics", "port", "load", "viscous_damping", ("v",), None, "x")
MASS = """
title = "A mass on a spring, pushed"
[states.x]
unit = "m"
[states.v]
unit = "m/s"
[inputs.push]
unit = "N"
[parameters.m]
value = 2.0
unit = "kg"
[parameters.k]
value = 24.0
unit = "N/m"
[parameters.c]
value = 0.8
unit = "N s/m"
[ports.load]
unit = "N"
[equations]
x = "v"
v = "(push + load - k*x - c*v)/m"
[observations]
x = "x"
"""
TWO_RODS = """
title = "Two rods in a chain"
[states.upper]
unit = "rad"
[states.upper_rate]
unit = "rad/s"
[states.lower]
unit = "rad"
[states.lower_rate]
unit = "rad/s"
[parameters.stiffness]
value = 9.0
unit = "N m/rad"
[ports.upper_moment]
unit = "N m"
[ports.lower_moment]
unit = "N m"
[equations]
upper = "upper_rate"
upper_rate = "upper_moment - 3*lower_moment - stiffness*upper - 0.2*upper_rate + 2*(lower - upper)"
lower = "lower_rate"
lower_rate = "lower_moment - stiffness*lower - 0.2*lower_rate + 2*(upper - lower)"
[observations]
upper = "upper"
lower = "lower"
"""
NEURON = """
title = "A neuron that fires"
[states.v]
unit = "1"
[states.w]
unit = "1"
[inputs.push]
unit = "1"
[parameters.b]
value = 0.8
unit = "1"
[equations]
v = "20*(v - v**3/3 - w + 0.04*push)"
w = "1.6*(v + 0.7 - b*w)"
"""


@dataclass(frozen=True)
class Experiment:
    """How trials are recorded."""

    trials: int = 4
    seconds: float = 14.0  # length of each
    noise: float = 0.02  # standard deviation of the sensor's noise over that of the channel
    cutoff_hz: float = 0.0  # of the low-pass filter that colours the noise; 0 leaves it white
    late: int = 0  # samples by which the recorded push is ahead of the true one; negative where it is behind
    shaking: float = 0.0  # standard deviation of a random push that nobody records [N]
    lowpass_hz: float = 0.0  # of the zero-lag low-pass (order 2) that signal and noise go through; 0 for none


def mass() -> Simulation:
    """A mass on a spring, without what is hidden."""
    return parse_simulation(MASS, "mass.toml")


def two_rods() -> Simulation:
    """Two rods, each with a port of its own; the lower port moves the upper rod more than the lower."""
    return parse_simulation(TWO_RODS, "two_rods.toml")


def neuron() -> Simulation:
    """A neuron that fires or does not, a hair apart: the start of a run has more than one minimum of the misfit."""
    return parse_simulation(NEURON, "neuron.toml")


def with_load(term: str, name: str = "hidden") -> Simulation:
    """The mass with an effect on its port."""
    return mass().with_effect(Term("load", "port", name, term))


def remembering(rate: str, term: str) -> Simulation:
    """The mass with an effect on its port that has a state z of its own."""
    return mass().with_state(State("z", "m", initial=0.0), rate).with_effect(Term("load", "port", "hidden", term))


def lagging(seconds: float) -> Simulation:
    """The mass whose push acts through a first-order lag."""
    late = mass().with_state(State("slow", "N", initial=0.0), "0").with_input("push", "slow")
    return late.with_equation("slow", f"(push - slow)/{seconds}")


def record(truth: Simulation, seed: int, how: Experiment | None = None) -> Measured:
    """Record what a system truly does: pushed by a sum of sines, released from a random state."""
    how = how or Experiment()
    rng = np.random.default_rng(seed)
    samples = round(how.seconds * RATE)
    t = np.arange(samples + abs(how.late)) / RATE
    true, recorded = (slice(first, first + samples) for first in (max(-how.late, 0), max(how.late, 0)))
    pushes = [_push(rng, t)[:, None] if truth.inputs else np.zeros((len(t), 0)) for _ in range(how.trials)]
    shocks = [rng.normal(0, how.shaking, push.shape) for push in pushes]
    machine = compile_simulation(truth)
    starts = rng.normal(0, 0.5, (how.trials, len(machine.states)))
    rows = Rows(np.arange(how.trials), np.zeros(how.trials, int), starts)
    drive = Drive.of([(push + shock)[true] for push, shock in zip(pushes, shocks, strict=True)], RATE)
    states, ok = machine.run(drive, rows, samples - 1)
    assert ok.all()
    seen = machine.observe(drive, rows, states)
    error = _noise(rng, seen.shape, how.cutoff_hz) * how.noise * seen.std(axis=(0, 1))
    names = tuple(str(trial + 1) for trial in range(how.trials))
    told = Drive.of([push[recorded] for push in pushes], RATE)
    return Measured(told, _passed(seen + error, how.lowpass_hz), names, machine.observed)


def _push(rng: np.random.Generator, t: NDArray[np.float64]) -> NDArray[np.float64]:
    frequencies = rng.uniform(0.15, 1.2, 6)
    return (rng.uniform(2, 5, 6) * np.sin(2 * np.pi * np.outer(t, frequencies) + rng.uniform(0, 6.3, 6))).sum(axis=1)


def _passed(seen: NDArray[np.float64], lowpass_hz: float) -> NDArray[np.float64]:
    if not lowpass_hz:
        return seen
    return sosfiltfilt(butter(2, lowpass_hz, fs=RATE, output="sos"), seen, axis=1)


def _noise(rng: np.random.Generator, shape: tuple[int, ...], cutoff_hz: float) -> NDArray[np.float64]:
    white = rng.normal(size=shape)
    if not cutoff_hz:
        return white
    slow = sosfiltfilt(butter(4, cutoff_hz, fs=RATE, output="sos"), white, axis=1)
    return slow / slow.std()
