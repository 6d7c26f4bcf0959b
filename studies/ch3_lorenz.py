"""Section 3.4.2: the Lorenz system with a hidden cubic term, Figs. 3.6-3.11, and the remark on finer sampling.

    python studies/ch3_lorenz.py [FOLDER] [--quick]

What a forecast is worth where chaos takes the accuracy over the whole of it from every model (until the truth first
changes lobes; the time that it is valid), and short records: `ch3_seeds.py`, `ch3_tables.py`.
"""

from __future__ import annotations

from pathlib import Path

from command_line import report_line

GIVEN = report_line(__name__, __doc__, "ch3_lorenz")  # before the slow imports

from chapter3.cell import ALL_METHODS, FOUR_METHODS, NOISES, grid
from chapter3.pages import Result, blocks_of, written
from chapter3.record import APPROACHES, Conditions, System, system_of
from further import result_text

import gaitdisc as gd

SEEDS = (0, 1, 2)
FINE_DT_S, FINE_S = 0.001, 20.0
FIGURES = {
    "system": "Fig. 3.6", "dynamics": "Fig. 3.7", "state": "Fig. 3.8", "horizon": "Fig. 3.9", "noise": "Fig. 3.10",
    "cost": "Fig. 3.11",
}  # fmt: skip
STATED = (
    ("Fig. 3.7", "dynamics: SINDy, GPR and NN without error for the first five seconds; DMD fails", "dynamics", 0.0),
    ("Fig. 3.10", "dynamics: little is left of it over the whole forecast (0.1 %)", "dynamics", 0.001),
    ("Fig. 3.8", "state: SINDy and DMD change nothing; GPR and NN reduce the error, none recovers the truth",
     "state", 0.0),
    ("section 3.5", "dt 0.001: almost perfect over short times", "dynamics", 0.0),
)  # fmt: skip


def system() -> System:
    """Text and code agree."""
    return system_of(gd.bundled_simulation("lorenz"), gd.Term("x", "equation", "cubic", "0.01*x**3"))


def run(quick: bool = False, folder: Path = Path("ch3_lorenz")) -> Result:
    """Compute all cells, draw the figures, set the chapter's statements beside them."""
    noises, seeds, duration_s = (NOISES[:1], SEEDS[:1], 20.0) if quick else (NOISES, SEEDS, 50.0)
    chosen = (FOUR_METHODS if quick else ALL_METHODS, APPROACHES)
    published = Conditions(duration_s=duration_s, published=True, absolute=True)
    cells = {"done right": grid(system(), Conditions(duration_s=duration_s), noises, seeds, chosen)}
    if not quick:
        cells["as published"] = grid(system(), published, noises, seeds, chosen)
        fine = Conditions(dt_s=FINE_DT_S, duration_s=FINE_S)
        cells["done right, dt 0.001 s, 20 s"] = grid(system(), fine, NOISES[:1], (0,))
    blocks = blocks_of(cells, FIGURES, STATED, {"done right": system()})
    return written(cells, blocks, "Lorenz system, section 3.4.2", folder)


if __name__ == "__main__":
    print(result_text(run(GIVEN.quick, GIVEN.folder)))
