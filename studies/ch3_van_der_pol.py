"""Section 3.4.1: the Van der Pol oscillator with a hidden cubic spring, Figs. 3.2-3.5 and 3.11.

    python studies/ch3_van_der_pol.py [FOLDER] [--quick]

The text starts at (0.1, 5) and hides -eps x^3, the published code starts at (0.1, 0.1) and hides +0.01 x^3; the text
gives no mu, the code 0.5. Both run, each as published (absolute noise, 4 Hz filter, central differences, tuned
thresholds, SINDy's residual integrated) and done right. Records of 10 s: `ch3_seeds.py`.
"""

from __future__ import annotations

from pathlib import Path

from command_line import report_line

GIVEN = report_line(__name__, __doc__, "ch3_van_der_pol")  # before the slow imports

from chapter3.cell import ALL_METHODS, FOUR_METHODS, NOISES, DiscrepancyCell, grid
from chapter3.pages import Result, blocks_of, written
from chapter3.record import APPROACHES, Conditions, System, system_of
from further import result_text

import gaitdisc as gd

SEEDS = (0, 1, 2)
FIGURES = {"system": "Fig. 3.2", "dynamics": "Fig. 3.3", "state": "Fig. 3.4", "noise": "Fig. 3.5", "cost": "Fig. 3.11"}
STATED = (
    ("Fig. 3.3", "dynamics: no error remains, all four methods, no noise", "dynamics", 0.0),
    ("Fig. 3.5", "dynamics: all four forecast at low noise (0.1 %)", "dynamics", 0.001),
    ("Fig. 3.5", "dynamics: all four forecast at medium noise (1 %)", "dynamics", 0.01),
    ("Fig. 3.5", "dynamics: SINDy gains but is not sparse at high noise (10 %)", "dynamics", 0.1),
    ("Fig. 3.4", "state: SINDy fails; DMD, GPR and NN reconstruct better and struggle to forecast", "state", 0.0),
)  # fmt: skip


def systems() -> dict[str, System]:
    """Text and code, each with its start and sign."""
    sides = {"text": ("van_der_pol", "-0.01*x**3"), "code": ("van_der_pol_published", "0.01*x**3")}
    return {
        word: system_of(gd.bundled_simulation(name), gd.Term("y", "equation", "cubic_stiffness", term))
        for word, (name, term) in sides.items()
    }


def run(quick: bool = False, folder: Path = Path("ch3_van_der_pol")) -> Result:
    """Compute all cells, draw the figures, set the chapter's statements beside them."""
    noises, seeds, duration_s = (NOISES[:1], SEEDS[:1], 20.0) if quick else (NOISES, SEEDS, 50.0)
    chosen = (FOUR_METHODS if quick else ALL_METHODS, APPROACHES)
    cells: dict[str, tuple[DiscrepancyCell, ...]] = {}
    shown = dict(list(systems().items())[: 1 if quick else None])
    for variant, system in shown.items():
        cells[f"{variant}, done right"] = grid(system, Conditions(duration_s=duration_s), noises, seeds, chosen)
        published = Conditions(duration_s=duration_s, published=True, absolute=True)
        cells[f"{variant}, as published"] = grid(system, published, noises, seeds, chosen)
    drawn = {f"{variant}, done right": system for variant, system in shown.items()}
    return written(cells, blocks_of(cells, FIGURES, STATED, drawn), "Van der Pol oscillator, section 3.4.1", folder)


if __name__ == "__main__":
    print(result_text(run(GIVEN.quick, GIVEN.folder)))
