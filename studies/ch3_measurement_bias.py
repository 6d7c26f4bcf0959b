"""Section 3.4.4: a mass on a spring whose position is measured with a gain of 1 + eps, Fig. 3.13, and Kalman filters.

    python studies/ch3_measurement_bias.py [FOLDER] [--quick]

The known model is right, its measurement is not: the residual model (Eq. 3.5) learns the bias. So does a Kalman filter
that has the bias among its states: the chapter's neutral result.
"""

from __future__ import annotations

from pathlib import Path

from command_line import report_line

GIVEN = report_line(__name__, __doc__, "ch3_measurement_bias")  # before the slow imports

import numpy as np
from chapter3.cell import ALL_METHODS, NOISES, grid
from chapter3.methods import MethodSettings
from chapter3.pages import Result, blocks_of, statements_table, written
from chapter3.record import Conditions, Record, System, recorded, system_of
from chapter3.starts import Uncertainty, unscented_kalman
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.report.page import Block

SEEDS = (0, 1, 2)
FIGURES = {"state": "Fig. 3.13", "noise": "Fig. 3.13"}
SETTINGS = MethodSettings(delays=300, rank=5)  # a quarter of what is learned from; the published code has 10
STATED = tuple(
    ("Fig. 3.13", f"state: every method learns the bias ({noise:.1%} noise)", "state", noise) for noise in NOISES
)


def systems() -> dict[str, System]:
    """Text and code."""
    free = gd.bundled_simulation("mass_spring_damper")
    text, code = (gd.Term("force", "port", "cubic", "x**3"), gd.Term("v", "equation", "cubic", "x**3"))
    return {
        "text": system_of(free.with_effect(text), gain=(1.01,)),
        "code": system_of(free.with_effect(code), gain=(1.1,)),
    }


def run(quick: bool = False, folder: Path = Path("ch3_measurement_bias")) -> Result:
    """Compute all cells and both filters, draw the figures."""
    noises, seeds = (NOISES[:2], SEEDS[:1]) if quick else (NOISES, SEEDS)
    conditions = Conditions(duration_s=20.0)
    cells, rows = {}, []
    for variant, system in systems().items():
        cells[variant] = grid(system, conditions, noises, seeds, (ALL_METHODS, ("state",)), SETTINGS)
        for noise in noises:
            for seed in seeds if noise else seeds[:1]:
                record = recorded(system, Conditions(noise, seed, duration_s=20.0))
                what = f"{variant}, {noise:.1%} noise, seed {seed}: filters do as well"
                rows.append(("3.4.4", what, filters(record)))
    neutral = Block("kalman", "The neutral result", (), tables=(statements_table(rows, "kalman"),))
    stated, *others = blocks_of(cells, FIGURES, STATED)
    return written(cells, [stated, neutral, *others], "Measurement bias, section 3.4.4", folder)


def filters(record: Record) -> str:
    """Share of the bias that each filter removes from the measured position, after 2 s, and the bias it states."""
    system, dt, y = record.system, record.conditions.dt_s, record.measured[:, 0]
    clean, settled = record.truth @ system.observation[0], slice(200, None)
    sd = max(float(np.std(y - clean)), 1e-6)
    start, noise = np.array([*system.start, 0.0]), Uncertainty(np.array([1e-6, 1e-6, 0.2]), np.full(3, 1e-6), sd)

    def turn(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack([system.known.run(points[:, :2], dt, 1)[:, 1], points[:, 2]])

    jacobian = np.column_stack([(turn(np.eye(3)[[k]] * 1e-4) - turn(np.zeros((1, 3))))[0] / 1e-4 for k in range(3)])
    walking = Uncertainty(noise.first, np.array([1e-5, 1e-4, 2e-4]), sd)  # an offset that is to follow a gain
    linear = unscented_kalman(lambda p: p @ jacobian.T, lambda p: p[:, 0] + p[:, 2], y, start, walking).states
    unscented = unscented_kalman(turn, lambda p: (1 + p[:, 2]) * p[:, 0], y, start, noise)
    states, known = unscented.states, record.truth[:, 0]
    seen = {"linear (offset)": linear[:, 0] + linear[:, 2], "unscented (gain)": (1 + states[:, 2]) * states[:, 0]}
    gap = np.sqrt(np.mean((clean - known)[settled] ** 2))
    words = [f"{n} {100 * (1 - np.sqrt(np.mean((clean - s)[settled] ** 2)) / gap):.1f} %" for n, s in seen.items()]
    return f"{', '.join(words)}; gain found {1 + states[-1, 2]:.4f} ± {1.96 * unscented.sd[-1, 2]:.4f}"


if __name__ == "__main__":
    print(run(GIVEN.quick, GIVEN.folder).page)
