"""Colours and line styles: the same thing looks the same in every figure, also in grey print.

Left red, right blue; Nominal orange, Augmented green, Exo grey; SHRED blue, SDN green, linear orange. Every colour has
a line style or a mark of its own, so that grey print and colour-blind readers lose nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Look:
    """How one thing is drawn."""

    colour: str
    line: Any  # Matplotlib's line style: a word, or lengths of dashes
    mark: str


MODELS = {
    "nominal": Look("#d97700", (0, (4.0, 1.6)), "o"),
    "augmented": Look("#00875a", "-", "s"),
    "exo": Look("#7a7a7a", (0, (1.2, 1.2)), "^"),
}
RECONSTRUCTED = {
    "shred": Look("#1f4fc8", "-", "o"),
    "shallow decoder": Look("#00875a", (0, (5.0, 1.5)), "s"),
    "linear": Look("#d97700", (0, (4.0, 1.6)), "^"),
    "delay ridge": Look("#7a3fa0", (0, (3.0, 1.0, 1.0, 1.0)), "v"),
    "fourier ridge": Look("#a8326e", (0, (1.4, 1.0)), "D"),
    "masked shred": Look("#1f4fc8", ":", "*"),
    "shred ensemble": Look("#1f4fc8", "-.", "P"),
    "shred-text": Look("#7a3fb0", "-.", "X"),
}
SIDES = {
    "l": Look("#c8102e", "-", "v"),
    "r": Look("#1f4fc8", "-", "o"),
    "": Look("#222222", "-", "s"),
}
MEASURED = Look("#111111", "-", "")
WITHOUT_DEVICE = Look("#555555", (0, (4.0, 1.6)), "")
NULL = Look("#444444", (0, (2.0, 2.0)), "")
KEPT = Look("#8fa1b8", "-", "")
DROPPED = Look("#111111", "-", "x")
