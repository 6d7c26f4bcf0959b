"""Section 3.4.2: the Lorenz system with a hidden cubic term, Figs. 3.6-3.11, and the remark on finer sampling.

    python studies/ch3_lorenz.py [FOLDER] [--quick]

Beside the accuracy over the whole forecast, which chaos takes away from every model, stands what a forecast is worth:
the accuracy until the truth first changes lobes, and the time that the forecast is valid, in Lyapunov times.
"""

from __future__ import annotations

from pathlib import Path

from command_line import report_line

GIVEN = report_line(__name__, __doc__, "ch3_lorenz")  # before the slow imports

import numpy as np
import pandas as pd
from chapter3.cell import ALL_METHODS, FORECAST, NOISES, ORACLE, PART_WORDS, grid
from chapter3.kept_cells import LYAPUNOV_PER_S
from chapter3.pages import Cells, Result, blocks_of, written
from chapter3.record import APPROACHES, Conditions, System, system_of

import gaitdisc as gd
from gaitdisc.report.page import Block
from gaitdisc.report.table import Table

SEEDS = (0, 1, 2)
FINE_DT_S, FINE_S, SHORT_S = 0.001, 20.0, 10.0  # of the short record 601 samples are learned from
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
    cells = {
        "done right": grid(system(), Conditions(duration_s=duration_s), noises, seeds),
        "as published": grid(system(), Conditions(duration_s=duration_s, published=True, absolute=True), noises, seeds),
    }
    if not quick:
        fine = Conditions(dt_s=FINE_DT_S, duration_s=FINE_S)
        cells["done right, dt 0.001 s, 20 s"] = grid(system(), fine, NOISES[:1], (0,))
        chosen = (ALL_METHODS, APPROACHES[:1])
        cells["done right, 10 s"] = grid(system(), Conditions(duration_s=SHORT_S), noises, seeds, chosen)
    blocks = blocks_of(cells, FIGURES, STATED, {"done right": system()})
    jump = Block("jump", "Until the first jump", (), tables=(jump_table(cells),))
    return written(cells, [blocks[0], jump, *blocks[1:]], "Lorenz system, section 3.4.2", folder)


def jump_table(cells: Cells) -> Table:
    """Forecast until the truth's first jump, and valid time."""
    rows = [
        (variant, c.approach, c.method, c.noise, PART_WORDS[name], c.seed,
         float(np.min(part.accuracy(until_s=part.first_jump_s()))), part.first_jump_s(),
         LYAPUNOV_PER_S * part.valid_s("augmented"), LYAPUNOV_PER_S * part.valid_s("known"))
        for variant, found in cells.items() for c in found if c.parts
        for name, part in c.parts.items() if name in (ORACLE, FORECAST)
    ]  # fmt: skip
    names = ("variant", "approach", "method", "noise", "start", "seed", "worst [%]", "jump [s]", "valid [1]",
             "known valid [1]")  # fmt: skip
    numbers = pd.DataFrame(rows, columns=pd.Index(names))
    middle = numbers.groupby(list(names[:5]), sort=False)[list(names[6:])].median().reset_index()
    shown = tuple(tuple(f"{v:.2f}" if isinstance(v, float) and k != 3 else f"{v}" for k, v in enumerate(row))
                  for row in middle.itertuples(index=False))  # fmt: skip
    caption = (
        "Accuracy of the worst channel until the truth first changes lobes, and valid time in Lyapunov times "
        f"({LYAPUNOV_PER_S} /s); medians over seeds. Below 0: loses to the known model."
    )
    return Table("jump", caption, tuple(middle.columns), shown, numbers)


if __name__ == "__main__":
    print(run(GIVEN.quick, GIVEN.folder).page)
