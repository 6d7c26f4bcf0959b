"""Section 3.4.4: a mass on a spring whose position is measured with a gain of 1 + eps, Fig. 3.13, and Kalman filters.

    python studies/ch3_measurement_bias.py [FOLDER] [--quick]

The known model is right, its measurement is not: the residual model (Eq. 3.5) learns the bias. So does a Kalman filter
that has the bias among its states: the chapter's neutral result (`ch3_further.py --tables gain`).
"""

from __future__ import annotations

from pathlib import Path

from command_line import report_line

GIVEN = report_line(__name__, __doc__, "ch3_measurement_bias")  # before the slow imports

from chapter3.cell import ALL_METHODS, FOUR_METHODS, NOISES, grid
from chapter3.methods import MethodSettings
from chapter3.pages import Result, blocks_of, written
from chapter3.record import APPROACHES, Conditions, System, system_of
from further import result_text

import gaitdisc as gd

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
    """Compute all cells, draw the figures."""
    noises, seeds, methods = (NOISES[:1], SEEDS[:1], FOUR_METHODS) if quick else (NOISES, SEEDS, ALL_METHODS)
    chosen, conditions = (methods, APPROACHES[1:]), Conditions(duration_s=20.0)
    cells = {name: grid(system, conditions, noises, seeds, chosen, SETTINGS) for name, system in systems().items()}
    return written(cells, blocks_of(cells, FIGURES, STATED), "Measurement bias, section 3.4.4", folder)


if __name__ == "__main__":
    print(result_text(run(GIVEN.quick, GIVEN.folder)))
