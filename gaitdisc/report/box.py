"""A box over participants: median, quartiles and the whole range."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from numpy.typing import NDArray

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes


def draw_box(
    axes: Axes,
    values: NDArray[np.float64],
    place: float,
    colour: str,
    orientation: Literal["vertical", "horizontal"] = "vertical",
) -> None:
    """Draw a box whose whiskers reach the smallest and the largest value.

    values (participant,): finite
    """
    line = {"color": colour, "linewidth": 0.9}
    axes.boxplot(
        [values],
        positions=[place],
        orientation=orientation,
        widths=0.2,
        whis=(0, 100),
        showfliers=False,
        manage_ticks=False,
        boxprops=line,
        whiskerprops=line,
        capprops=line,
        medianprops={"color": colour, "linewidth": 2.0},
    )
