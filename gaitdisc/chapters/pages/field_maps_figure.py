"""Maps of a field: what was measured beside what was told, and where the sensors went (Figs. 5.2 and 5.3, top)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording import Axis, Field
from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import Room, in_style, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh

SENSOR_COLOUR = "#111111"
ROUTE_COLOURS = ("#c8102e", "#1f4fc8", "#00875a", "#d97700", "#7a3fa0")


@in_style
def maps_figure(field: Field, snapshots: Mapping[str, NDArray[np.floating]], name: str, source: str) -> Figure:
    """One quantity of a field on its grid, one panel a snapshot, all on one scale of colour.

    Parameters
    ----------
    field : Field
        Whose grid, quantity and unit are shown: its first quantity, and its middle plane where it has three axes.
    snapshots : mapping of str to ndarray (point,)
        Title -> values [the quantity's unit].
    name, source : str
        Of the files; the figure of the dissertation that it stands for.
    """
    planes = {title: _plane(field.on_grid(values)) for title, values in snapshots.items()}
    middle, reach = _span(np.concatenate([plane.ravel() for plane in planes.values()]))
    columns = 2
    rows = -(-len(planes) // columns)
    vertical, across = field.axes[-2:]
    width = (8.0 - 1.6 - 0.5) / columns
    height = float(np.clip(width * np.ptp(vertical.coordinates) / np.ptp(across.coordinates), 0.9, 2.6))
    drawn, grid = panels(rows, columns, height, Room(right=0.85, across=0.5, down=0.5, top=0.35))
    panel_list = [axes for row in grid for axes in row]
    for axes in panel_list[len(planes) :]:
        axes.set_visible(False)
    limits = (middle - reach, middle + reach)
    pairs = zip(panel_list, planes.values(), strict=False)
    meshes = [_draw(axes, (vertical, across), plane, limits) for axes, plane in pairs]
    for axes, title in zip(panel_list, planes, strict=False):
        axes.set_title(title)
    for row in grid:
        row[0].set_ylabel(f"{vertical.name} [{vertical.unit}]")
    for axes in grid[-1]:
        axes.set_xlabel(f"{across.name} [{across.unit}]")
    box = drawn.add_axes((1 - 0.72 / 8.0, 0.2, 0.12 / 8.0, 0.6))
    drawn.colorbar(meshes[0], cax=box, label=f"{field.quantities[0]} [{field.units[0]}]")
    table = pd.DataFrame([
        {"snapshot": title, "mean": np.nanmean(plane), "sd": np.nanstd(plane), "points": int(np.isfinite(plane).sum())}
        for title, plane in planes.items()
    ])  # fmt: skip
    plane_words = " Middle plane." if len(field.axes) > 2 else ""
    return Figure(name, f"{source}. {field.quantities[0]} [{field.units[0]}].{plane_words}",
                  f"{len(planes)} maps on one scale of colour", table, drawn)  # fmt: skip


@in_style
def routes_figure(field: Field, routes: Mapping[str, NDArray[np.floating]], name: str, source: str) -> Figure:
    """Where sensors go, on the grid of a field with two axes.

    Parameters
    ----------
    routes : mapping of str to ndarray (time, axis)
        Name -> where the sensor is; one that stays is drawn as a point.
    """
    vertical, across = field.axes[-2:]
    height = float(np.clip(7.0 * np.ptp(vertical.coordinates) / np.ptp(across.coordinates), 1.2, 3.8))
    drawn, ((axes,),) = panels(1, 1, height, Room(top=0.5))
    axes.pcolormesh(across.coordinates, vertical.coordinates, np.where(field.mask, 0.25, np.nan), vmin=0, vmax=1,
                    cmap="Greys", rasterized=True)  # fmt: skip
    rows = []
    for k, (title, places) in enumerate(routes.items()):
        colour = ROUTE_COLOURS[k % len(ROUTE_COLOURS)]
        stays = len(np.unique(places, axis=0)) == 1
        axes.plot(places[:, 1], places[:, 0], "o" if stays else "-", color=colour, markersize=5, linewidth=1.4,
                  label=title)  # fmt: skip
        rows.append(pd.DataFrame({"route": title, vertical.name: places[:, 0], across.name: places[:, 1]}))
    axes.set_xlabel(f"{across.name} [{across.unit}]")
    axes.set_ylabel(f"{vertical.name} [{vertical.unit}]")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=len(routes), borderaxespad=0.2)
    return Figure(name, f"{source}. Grey: points of the field.", "Routes of sensors on a map", pd.concat(rows), drawn)


def _draw(axes: Axes, pair: tuple[Axis, Axis], plane: NDArray[np.float64], limits: tuple[float, float]) -> QuadMesh:
    axes.set_facecolor("#dddddd")
    return axes.pcolormesh(
        pair[1].coordinates, pair[0].coordinates, plane, vmin=limits[0], vmax=limits[1], cmap="RdBu_r", rasterized=True
    )


def _plane(grid: NDArray[np.float64]) -> NDArray[np.float64]:
    while grid.ndim > 2:
        grid = grid[len(grid) // 2]
    return grid


def _span(values: NDArray[np.float64]) -> tuple[float, float]:
    """Middle and reach of the colours: about zero where values lie on both sides of it."""
    low, high = np.nanquantile(values, [0.005, 0.995])
    if low < 0 < high:
        return 0.0, float(max(-low, high))
    return float((low + high) / 2), float((high - low) / 2) or 1.0
