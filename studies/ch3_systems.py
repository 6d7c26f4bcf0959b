"""Sections 3.4.1, 3.4.2 and 3.4.4: what four methods learn of each system's hidden term, Figs. 3.2-3.11 and 3.13.

    python studies/ch3_systems.py [van_der_pol|lorenz|measurement_bias] [FOLDER] [--quick]

`van_der_pol`: the text starts at (0.1, 5) and hides -eps x^3, the published code starts at (0.1, 0.1) and hides
+0.01 x^3; the text gives no mu, the code 0.5. Both run, each as published (absolute noise, 4 Hz filter, central
differences, tuned thresholds, SINDy's residual integrated) and done right. `lorenz`: a cubic term, also sampled finely.
`measurement_bias`: a mass on a spring whose position is measured with a gain of 1 + eps; the known model is right, and
the residual model (Eq. 3.5) learns the bias. So does a Kalman filter that has the bias among its states: the chapter's
neutral result (`ch3_further.py --tables gain`).

What a forecast is worth where chaos takes the accuracy over the whole of it from every model (until the truth first
changes lobes; the time that it is valid), and short records: `ch3_seeds.py`, `ch3_tables.py`.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

NAMES = ("van_der_pol", "lorenz", "measurement_bias")
NAME = argument("system", "which of them", NAMES[0], choices=NAMES)
OUT = argument("folder", "where the report goes (default: ch3_SYSTEM)", nargs="?", type=Path)
GIVEN = command_line(__name__, __doc__, NAME, OUT, QUICK)  # before the slow imports

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from chapter3.cell import ALL_METHODS, FOUR_METHODS, NOISES, grid
from chapter3.methods import MethodSettings
from chapter3.pages import Stated, blocks_of, written
from chapter3.record import APPROACHES, Approach, Conditions, System, system_of
from further import Result, result_text

import gaitdisc as gd

SEEDS = (0, 1, 2)
FINE = Conditions(dt_s=0.001, duration_s=20.0)


class Section(NamedTuple):
    """A section of the chapter, with what it states."""

    title: str
    figures: Mapping[str, str]
    stated: tuple[Stated, ...]
    duration_s: float = 50.0
    approaches: tuple[Approach, ...] = APPROACHES
    settings: MethodSettings | None = None


SECTIONS = {
    "van_der_pol": Section(
        "Van der Pol oscillator, section 3.4.1",
        {"system": "Fig. 3.2", "dynamics": "Fig. 3.3", "state": "Fig. 3.4", "noise": "Fig. 3.5", "cost": "Fig. 3.11"},
        (
            ("Fig. 3.3", "dynamics: no error remains, all four methods, no noise", "dynamics", 0.0),
            ("Fig. 3.5", "dynamics: all four forecast at low noise (0.1 %)", "dynamics", 0.001),
            ("Fig. 3.5", "dynamics: all four forecast at medium noise (1 %)", "dynamics", 0.01),
            ("Fig. 3.5", "dynamics: SINDy gains but is not sparse at high noise (10 %)", "dynamics", 0.1),
            ("Fig. 3.4", "state: SINDy fails; DMD, GPR and NN reconstruct better and struggle to forecast",
             "state", 0.0),
        ),
    ),
    "lorenz": Section(
        "Lorenz system, section 3.4.2",
        {"system": "Fig. 3.6", "dynamics": "Fig. 3.7", "state": "Fig. 3.8", "horizon": "Fig. 3.9",
         "noise": "Fig. 3.10", "cost": "Fig. 3.11"},
        (
            ("Fig. 3.7", "dynamics: SINDy, GPR and NN without error for the first five seconds; DMD fails",
             "dynamics", 0.0),
            ("Fig. 3.10", "dynamics: little is left of it over the whole forecast (0.1 %)", "dynamics", 0.001),
            ("Fig. 3.8", "state: SINDy and DMD change nothing; GPR and NN reduce the error, none recovers the truth",
             "state", 0.0),
            ("section 3.5", "dt 0.001: almost perfect over short times", "dynamics", 0.0),
        ),
    ),
    "measurement_bias": Section(
        "Measurement bias, section 3.4.4",
        {"state": "Fig. 3.13", "noise": "Fig. 3.13"},
        tuple(("Fig. 3.13", f"state: every method learns the bias ({each:.1%} noise)", "state", each)
              for each in NOISES),
        20.0,
        APPROACHES[1:],
        MethodSettings(delays=300, rank=5),  # a quarter of what is learned from; the published code has 10
    ),
}  # fmt: skip


def oscillators() -> dict[str, System]:
    """Text and code, each with its start and sign."""
    sides = {"text": ("van_der_pol", "-0.01*x**3"), "code": ("van_der_pol_published", "0.01*x**3")}
    return {
        word: system_of(gd.bundled_simulation(name), gd.Term("y", "equation", "cubic_stiffness", term))
        for word, (name, term) in sides.items()
    }


def lorenz() -> System:
    """Text and code agree."""
    return system_of(gd.bundled_simulation("lorenz"), gd.Term("x", "equation", "cubic", "0.01*x**3"))


def biased_masses() -> dict[str, System]:
    """Text and code."""
    free = gd.bundled_simulation("mass_spring_damper")
    text, code = (gd.Term("force", "port", "cubic", "x**3"), gd.Term("v", "equation", "cubic", "x**3"))
    return {
        "text": system_of(free.with_effect(text), gain=(1.01,)),
        "code": system_of(free.with_effect(code), gain=(1.1,)),
    }


def variants(name: str, quick: bool) -> dict[str, tuple[System, Conditions]]:
    """Each system that is computed, and how it is recorded; the first of them quickly."""
    right = Conditions(duration_s=20.0 if quick else SECTIONS[name].duration_s)
    published = replace(right, published=True, absolute=True)
    if name == "measurement_bias":
        return {word: (system, right) for word, system in biased_masses().items()}
    if name == "lorenz":
        cases = {"done right": right, "as published": published, "done right, dt 0.001 s, 20 s": FINE}
        return {word: (lorenz(), made) for word, made in list(cases.items())[: 1 if quick else None]}
    shown = list(oscillators().items())[: 1 if quick else None]
    cases = {"done right": right, "as published": published}
    return {f"{word}, {how}": (system, made) for word, system in shown for how, made in cases.items()}


def run(name: str, quick: bool = False, folder: Path | None = None) -> Result:
    """Compute all cells, draw the figures, set the chapter's statements beside them."""
    section, cells, drawn = SECTIONS[name], {}, {}
    chosen = (FOUR_METHODS if quick else ALL_METHODS, section.approaches)
    for variant, (system, made) in variants(name, quick).items():
        noises = NOISES[:1] if quick or made is FINE else NOISES
        cells[variant] = grid(system, made, noises, SEEDS, chosen, section.settings)
        if "system" in section.figures and variant.endswith("done right"):
            drawn[variant] = system
    blocks = blocks_of(cells, section.figures, section.stated, drawn)
    return written(cells, blocks, section.title, folder or Path(f"ch3_{name}"))


if __name__ == "__main__":
    print(result_text(run(GIVEN.system, GIVEN.quick, GIVEN.folder)))
