"""Moments and powers of every step over those that the file holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Curves = Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]  # channel -> ours, theirs over one step


def over_each_other(steps: Mapping[str, Sequence[Curves]], file: str) -> None:
    """Draw ours and, dashed, theirs in the person's colour, a panel for each channel."""
    from matplotlib.figure import Figure

    names = list(next(iter(steps.values()))[0])
    drawing = Figure(figsize=(13, 11), layout="constrained")
    for place, name in enumerate(names):
        axis = drawing.add_subplot(4, 3, place + 1, title=name.replace("_{}", ""), xlabel="% of stance")
        axis.set_ylabel("W/kg" if "power" in name else "N m/kg")
        for number, (person, several) in enumerate(steps.items()):
            for one, curves in enumerate(several):
                ours, theirs = curves[name]
                phase = np.linspace(0, 100, len(ours))
                label = person if place == 0 and one == 0 else None
                axis.plot(phase, ours, color=f"C{number}", linewidth=1.1, label=label)
                axis.plot(phase, np.where(theirs != 0, theirs, np.nan), "--", color=f"C{number}", linewidth=0.8)
        if place == 0:
            axis.legend(fontsize=7, title="ours; theirs dashed", title_fontsize=7)
    drawing.savefig(file, dpi=100)
