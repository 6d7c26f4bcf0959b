"""The course of SHRED's latent state over the stride, beside the first modes of what it estimates (Fig. 5.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import RECONSTRUCTED
from gaitdisc.report.panels import Room, in_style, legend, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOOKS = tuple(RECONSTRUCTED.values())
BINS = np.arange(0.0, 101.0, 2.0)
LATENT, MODES = "latent state of SHRED", "modes of the states"


def course_numbers(phi: NDArray[np.float64], components: NDArray[np.float64]) -> pd.DataFrame:
    """Mean and standard deviation of each component in 2 % of the stride.

    returns: component, from 1; percent; mean; sd [1]
    """
    known = np.isfinite(phi)
    place = np.clip(np.digitize(phi[known], BINS) - 1, 0, len(BINS) - 2)
    middle = (BINS[:-1] + BINS[1:]) / 2
    tables = []
    for k in range(components.shape[1]):
        by_bin = pd.Series(components[known, k]).groupby(place).agg(["mean", "std"])
        tables.append(pd.DataFrame({"component": k + 1, "percent": middle[by_bin.index.to_numpy(int)],
                                    "mean": by_bin["mean"].to_numpy(), "sd": by_bin["std"].to_numpy()}))  # fmt: skip
    return pd.concat(tables, ignore_index=True)


def draw_course(axes: Axes, numbers: pd.DataFrame) -> None:
    """Draw each component's mean over the stride, and its standard deviation shaded."""
    for (k, rows), look in zip(numbers.groupby("component"), LOOKS, strict=False):
        axes.fill_between(rows["percent"], rows["mean"] - rows["sd"], rows["mean"] + rows["sd"],
                          color=look.colour, alpha=0.2, linewidth=0)  # fmt: skip
        axes.plot(rows["percent"], rows["mean"], color=look.colour, linestyle=look.line, label=f"component {k}")
    axes.set_xlim(0, 100)
    axes.set_xlabel("stride [%]")
    axes.set_ylabel("standard deviations [1]")


@in_style
def latent_course_figure(courses: dict[str, pd.DataFrame], name: str, source: str) -> Figure:
    """Draw the latent state and the modes side by side.

    courses: title of each panel -> its `course_numbers`
    """
    drawn, (row,) = panels(1, len(courses), 2.1, Room(across=0.7, top=0.5))
    for axes, (title, numbers) in zip(row, courses.items(), strict=True):
        draw_course(axes, numbers)
        axes.set_title(title)
    legend(drawn, row[0].get_lines())
    caption = (
        f"{source}. Principal components in time, each of standard deviation 1; shaded: standard deviation of 2 %."
    )
    numbers = pd.concat([each.assign(panel=title) for title, each in courses.items()], ignore_index=True)
    return Figure(name, caption, "Components of the latent state and of the states over the stride", numbers, drawn)
