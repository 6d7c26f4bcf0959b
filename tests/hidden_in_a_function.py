"""A simulation that is a Python function of ten lines, and short records of what it lacks."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.parts import Input, Parameter, Port, State
from gaitdisc.simulation.python_simulation import PythonSimulation, python_simulation
from gaitdisc.simulation.running import compile_simulation

RATE = 10.0
Change = Callable[[PythonSimulation], PythonSimulation]


def tank_rates(t, x, u, values, ports):
    """A tank that a pump fills and that drains through a pipe: level, from inflow and outflow."""
    area, drain = values[:, 0], values[:, 1]
    inflow = u[:, 0] + ports[:, 0]
    outflow = drain * x[:, 0]
    return ((inflow - outflow) / area)[:, None]


def tank(initial: float | None = None) -> PythonSimulation:
    """The tank, without what is hidden."""
    numbers = [Parameter("area", 0.8, "m^2"), Parameter("drain", 1.1, "m^2/s")]
    return python_simulation(
        "tank",
        tank_rates,
        [State("level", "m", "", initial)],
        [Input("pump", "m^3/s")],
        numbers,
        [Port("leak", "m^3/s")],
    )


def write_record(path: Path, change: Change = lambda one: one, seed: int = 0) -> Path:
    """Write four trials of 8 s of a tank that was changed, its level measured with 2 mm of noise."""
    rng = np.random.default_rng(seed)
    truth, count = change(tank()), 80
    t = np.arange(count) / RATE
    waves = [
        [rng.uniform(0.5, 1.5) * np.sin(2 * np.pi * f * t + rng.uniform(0, 6.3)) for f in (0.2, 0.45, 0.9)]
        for _ in range(4)
    ]
    pumps = np.sum(waves, axis=1)
    drive = Drive.of([pump[:, None] for pump in pumps], RATE)
    machine = compile_simulation(truth)
    rows = Rows(np.arange(4), np.zeros(4, int), rng.uniform(0.2, 0.6, (4, 1)))
    states, ok = machine.run(drive, rows, count - 1)
    assert ok.all()
    seen = machine.observe(drive, rows, states)[:, :, 0] + rng.normal(0, 0.002, (4, count))
    lines = ["trial,time,pump,level"]
    for trial in range(4):
        columns = zip(t, pumps[trial], seen[trial], strict=True)
        lines += [f"{trial + 1},{when:.3f},{pump:.6g},{level:.6g}" for when, pump, level in columns]
    path.write_text("\n".join(lines) + "\n")
    return path
