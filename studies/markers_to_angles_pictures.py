"""Curves over each other of joint angles from markers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

Pairs = Mapping[str, tuple[np.ndarray, np.ndarray]]  # angle -> ours, theirs [deg]


def draw(people: Mapping[str, Pairs], opensim: Pairs, folder: Path) -> None:
    """Plug-in Gait's and ours of each person's straight walk; OpenSim's and ours."""
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    rows = list(next(iter(people.values())))
    drawn = Figure(figsize=(3 * len(people), 1.7 * len(rows)), layout="constrained")
    panels = drawn.subplots(len(rows), len(people), squeeze=False)
    for column, (person, pairs) in enumerate(people.items()):
        for row, name in enumerate(rows):
            panel(panels[row][column], pairs[name], f"{name} [deg]" if column == 0 else "")
        panels[0][column].set_title(person)
    drawn.legend(("Plug-in Gait, in the file", "gaitdisc, from the markers"), loc="outside lower center", ncols=2)
    drawn.savefig(folder / "markers_to_angles_plug_in_gait.png", dpi=90)
    drawn = Figure(figsize=(10, 8), layout="constrained")
    places = drawn.subplots(4, 2).ravel()
    for place, (name, pair) in zip(places, opensim.items(), strict=False):
        panel(place, pair, f"{name} [deg]")
    places[-1].remove()
    drawn.legend(("OpenSim, planar model", "gaitdisc, planar"), loc="outside lower center", ncols=2)
    drawn.savefig(folder / "markers_to_angles_opensim.png", dpi=90)


def panel(axes, pair: tuple[np.ndarray, np.ndarray], label: str) -> None:
    """One angle over the frames."""
    axes.plot(pair[1], color="0.6", lw=3)
    axes.plot(pair[0], color="tab:blue", lw=1)
    axes.set_ylabel(label, fontsize=7)
    axes.set_xlabel("frame", fontsize=6)
    axes.tick_params(labelsize=7)
