"""Maps of fields as measured and as reconstructed, and what describes a turbulent flow."""

from __future__ import annotations

import re
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
SHELL = re.compile(r"e_(\d+)")


@in_style
def maps_figure(field: Field, snapshots: Mapping[str, NDArray[np.floating]], name: str, source: str) -> Figure:
    """One quantity of a field on its grid, one panel a snapshot, all on one scale of colour."""
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
    """Where sensors go, on the grid of a field with two axes."""
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


@in_style
def flow_figure(numbers: pd.DataFrame, power: float, name: str) -> Figure:
    """Mean spectrum beside the slope of -5/3, and dissipation beside the power that is put in."""
    drawn, ((left, right),) = panels(1, 2, 2.2, Room(across=0.8, top=0.3))
    shells = [column for column in numbers.columns if SHELL.fullmatch(column)]
    k = np.array([int(column[2:]) for column in shells], float)
    mean = numbers[shells].mean().to_numpy()
    left.loglog(k, mean, "o-", color="#1f4fc8", markersize=3.5)
    left.loglog(k, mean[1] * (k / k[1]) ** (-5 / 3), color="#888888", linestyle=(0, (4.0, 1.6)), label="slope −5/3")
    for axis in (left.xaxis, left.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    left.minorticks_off()
    left.set_ylim(bottom=mean.min() / 3, top=3 * mean.max())
    left.set_xticks([1, 2, 5, 10, *([20] if k[-1] >= 20 else [])])
    left.set_xlabel("wavenumber [1]")
    left.set_ylabel("energy in the shell [1]")
    left.legend(loc="lower left")
    right.plot(numbers["snapshot"], numbers["dissipation"], color="#c8102e", linewidth=1.0, label="dissipation")
    right.axhline(power, color="#888888", linestyle=(0, (4.0, 1.6)), label="power put in")
    right.set_ylim(0, 1.3 * max(power, float(numbers["dissipation"].max())))
    right.set_xlabel("snapshot")
    right.set_ylabel("per mass and time [1]")
    right.legend(loc="lower right")
    middle = numbers.mean()
    caption = (
        f"Stand-in flow, mean of {len(numbers)} instants: Reynolds number of Taylor's microscale "
        f"{middle['re_lambda']:.1f}, largest wavenumber times Kolmogorov's length {middle['kmax_eta']:.2f}, turnover "
        f"{middle['turnover']:.2f}; dissipation {middle['dissipation']:.4f}, power {power:g}."
    )
    return Figure(name, caption, "Spectrum of energy, and dissipation over time", numbers, drawn)
