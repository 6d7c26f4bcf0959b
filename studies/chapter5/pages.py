"""Errors and maps of reconstructed fields, and what describes a turbulent flow."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording.field import Field
from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import RECONSTRUCTED, Look, Room, in_style, legend, legend_lines, panels
from gaitdisc.report.table import Table
from gaitdisc.words import number

from .reconstruct_field import FieldCell, field_cells_table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROUTE_LOOKS = (
    Look("#111111", "-", "o"),
    Look("#7a7a7a", (0, (1.2, 1.2)), "s"),
    Look("#c8102e", "-", "v"),
    Look("#1f4fc8", (0, (4.0, 1.6)), "^"),
    Look("#00875a", (0, (4.0, 1.2, 1.2, 1.2)), "D"),
    Look("#d97700", (0, (2.0, 1.0)), "x"),
    Look("#7a3fa0", (0, (6.0, 1.0)), "P"),
    Look("#a8326e", (0, (3.0, 1.0, 1.0, 1.0, 1.0, 1.0)), "*"),
    Look("#5b4a2f", (0, (8.0, 2.0)), "h"),
)
ROUTE_COLOURS = ("#c8102e", "#1f4fc8", "#00875a", "#d97700", "#7a3fa0")
SHELL = re.compile(r"e_(\d+)")


@in_style
def histograms_figure(cells: Sequence[FieldCell], name: str, source: str) -> Figure:
    """How often errors of each size are made, a panel a split, a line a route."""
    splits = list(dict.fromkeys(cell.split for cell in cells))
    routes = list(dict.fromkeys(cell.route for cell in cells))
    drawn, (row,) = panels(1, len(splits), 2.1, Room(top=0.3 + 0.17 * (-(-len(routes) // 3)), across=0.7))
    numbers = []
    for axes, split in zip(row, splits, strict=True):
        for route, look in zip(routes, ROUTE_LOOKS, strict=False):
            some = [cell for cell in cells if (cell.split, cell.route) == (split, route)]
            if some:
                edges, counts = some[0].errors.edges, np.sum([cell.errors.counts for cell in some], axis=0)
                middles, density = (edges[1:] + edges[:-1]) / 2, counts / counts.sum() / np.diff(edges)
                inner = np.where(density > 0, density, np.nan)[1:-1]
                axes.plot(middles[1:-1], inner, color=look.colour, linestyle=look.line, linewidth=1.0)
                of = {"split": split, "route": route}
                numbers.append(pd.DataFrame({**of, "error": middles, "count": counts, "density": density}))
        axes.set(title=split, yscale="log", xlabel=f"reconstructed − measured [{cells[0].unit}]")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    row[0].set_ylabel(f"density [1/{cells[0].unit}]" if cells[0].unit != "1" else "density [1]")
    handles = legend_lines(dict(zip(routes, ROUTE_LOOKS, strict=False)))
    drawn.legend(handles=handles, loc="upper center", ncols=min(3, len(routes)), bbox_to_anchor=(0.5, 1.0))
    # the two outermost bins are open-ended, so that their heights are no density
    outside = [float(one["count"].iloc[[0, -1]].sum() / one["count"].sum()) for one in numbers]
    shares = " to ".join(dict.fromkeys(f"{100 * share:.2g}" for share in (min(outside), max(outside))))
    low, high = (number(cells[0].errors.edges[k]) for k in (1, -2))
    caption = (
        f"{source}. {cells[0].field}, {cells[0].quantity}, {cells[0].model}: errors at all points of all test "
        f"snapshots, n = {cells[0].tested} at most. "
        f"Not drawn: errors below {low} or above {high} {cells[0].unit}, {shares} % of a route's."
    )
    return Figure(name, caption, f"Histograms of errors of {len(routes)} routes", pd.concat(numbers), drawn)


@in_style
def boxes_figure(cells: Sequence[FieldCell], name: str, source: str, ceilings: dict[str, float]) -> Figure:
    """Relative error of many models, a panel a split, a box a kind of sensor, every model a point."""
    splits = list(dict.fromkeys(cell.split for cell in cells))
    routes = list(dict.fromkeys(cell.route for cell in cells))
    drawn, (row,) = panels(1, len(splits), 2.2, Room(across=0.6))
    for axes, split in zip(row, splits, strict=True):
        groups = [[c.relative_l2 for c in cells if (c.split, c.route) == (split, route)] for route in routes]
        axes.boxplot(groups, widths=0.5, showfliers=False, medianprops={"color": "#111111"})
        for k, group in enumerate(groups):
            spread = np.linspace(-0.16, 0.16, len(group)) if len(group) > 1 else np.zeros(1)
            axes.plot(k + 1 + spread, group, ROUTE_LOOKS[k + 2].mark, color=ROUTE_LOOKS[k + 2].colour, markersize=3.5)
        axes.axhline(1.0, color="#888888", linewidth=0.8)
        axes.axhline(ceilings[split], color="#00875a", linestyle=(0, (4.0, 1.6)), linewidth=0.9)
        words = [f"{route}\nn = {len(group)}" for route, group in zip(routes, groups, strict=True)]
        axes.set_xticks(range(1, len(routes) + 1), words)
        axes.set(title=split, ylim=(0, None))
    row[0].set_ylabel("relative L2 error [1]")
    looks = {"the field's own norm": Look("#888888", "-", ""), "POD ceiling": Look("#00875a", (0, (4.0, 1.6)), "")}
    legend(drawn, legend_lines(looks))
    numbers = field_cells_table(cells)[["split", "route", "run", "relative_l2", "r2"]]
    caption = f"{source}. Each point is one model; box: quartiles, whiskers within 1.5 of their distance."
    return Figure(name, caption, "Boxes of relative errors by split and kind of sensor", numbers, drawn)


@in_style
def latent_figure(found: pd.DataFrame, name: str, source: str) -> Figure:
    """Error against the nodes of the recurrent layer, beside the energy that as many modes leave."""
    drawn, ((left, right),) = panels(1, 2, 2.1, Room(across=0.8, top=0.2))
    splits = list(dict.fromkeys(found["split"]))
    for split, look in zip(splits, (RECONSTRUCTED["shred"], RECONSTRUCTED["delay ridge"]), strict=False):
        some = found[found["split"] == split]
        style = {"marker": look.mark, "color": look.colour, "linestyle": look.line, "markersize": 4, "label": split}
        left.plot(some["nodes"], some["relative_l2"], **style)
    first = found[found["split"] == splits[0]]
    right.plot(first["nodes"], first["energy_left"], "o-", color="#111111", markersize=4)
    for axes, words in ((left, "relative L2 error of SHRED [1]"), (right, "energy beyond so many modes, share [1]")):
        axes.set_xscale("log", base=2)
        axes.set_xticks(list(first["nodes"]), [str(n) for n in first["nodes"]])
        axes.minorticks_off()
        axes.axvline(5, color="#888888", linewidth=0.7, linestyle=(0, (2.0, 2.0)))
        axes.set(ylabel=words, ylim=(0, None))
    left.set_xlabel("nodes of the recurrent layer")
    right.set_xlabel("proper orthogonal modes")
    left.legend(loc="lower left")
    caption = f"{source}. Dotted: 5, where the dissertation sees both elbows. Modes of the training part ({splits[0]})."
    return Figure(name, caption, "Error against latent size, and energy against modes", found, drawn)


def field_table(cells: Sequence[FieldCell], name: str, printed: Mapping[tuple[str, str], float] | None = None) -> Table:
    """Relative L2 error of every route, model and split; the least of each row and split is marked by a star."""
    splits = list(dict.fromkeys(cell.split for cell in cells))
    models = list(dict.fromkeys(cell.model for cell in cells if not _is_bound(cell.model)))
    routes = list(dict.fromkeys(cell.route for cell in cells))
    found = {}
    for cell in cells:
        found.setdefault((cell.route, cell.split, cell.model), []).append(cell)
    extra, rows, tested = ("printed",) if printed else (), [], []
    for split in splits:
        counts = sorted({cell.tested for cell in cells if cell.split == split})
        tested.append(f"{split} {' to '.join(map(str, dict.fromkeys((counts[0], counts[-1]))))}")
    bounds = {(cell.split, cell.model): cell for cell in reversed(cells) if _is_bound(cell.model)}  # of every route
    words = [f"{split}, {model}: {_cell([cell])}" for (split, model), cell in reversed(bounds.items())]
    for route in routes:
        row = [route]
        for split in splits:
            here = [found.get((route, split, model), []) for model in models]
            least = min((_middle(some, "relative_l2") for some in here if some), default=0.0)
            row += [_cell(cell, least) for cell in here]
            if printed:
                row.append(f"{printed[route, split]:.4f}" if (route, split) in printed else "")
        rows.append(tuple(row))
    first = cells[0]
    caption = (
        f"{first.field}, {first.quantity}: relative L2 error, the norm of the error over the norm of the field about "
        f"zero; in brackets RMSE [{first.unit}] and R2 about the training part's mean; medians "
        f"of the seeds; star: least of the models. "
        f"Test snapshots: {', '.join(tested)}." + f" Bounds: {'; '.join(words)}." * bool(words)
    )
    columns = ("route", *[word for _ in splits for word in (*models, *extra)])
    groups = (("", 1), *[(split, len(models) + len(extra)) for split in splits])
    return Table(name, caption, columns, tuple(rows), field_cells_table(cells), groups)


def _is_bound(model: str) -> bool:
    return model.endswith("(no sensor)") or model.startswith("POD")


def _middle(cells: Sequence[FieldCell], name: str) -> float:
    return float(np.median([getattr(cell, name) for cell in cells]))


def _cell(cells: Sequence[FieldCell], least: float = 0.0) -> str:
    if not cells:
        return ""
    error, rmse, r2 = (_middle(cells, name) for name in ("relative_l2", "rmse", "r2"))
    return f"{error:.3f}{'*' * (error == least)} ({rmse:.3g}; {r2:.2f})"


def means_table(cells: Sequence[FieldCell], name: str) -> Table:
    """Mean over the routes, a row a field, quantity and split: median of the seeds, [least, greatest] of several."""
    numbers = field_cells_table([cell for cell in cells if not _is_bound(cell.model)])
    models, rows = list(dict.fromkeys(numbers["model"])), []
    for keys, own in numbers.groupby(["field", "quantity", "split"], sort=False):
        seeds = own.groupby(["model", "run"])[["relative_l2", "r2"]].mean()
        least = own.pivot_table("relative_l2", "route", "model", "median").idxmin(axis=1).value_counts()
        said = [_spread(seeds.loc[model]) if model in seeds.index else "" for model in models]
        rows.append((*map(str, keys), *said, ", ".join(f"{model} {count}" for model, count in least.items())))
    times = numbers.groupby("model")["seconds"].median()
    rows.append(("median fit [s]", "", "", *(f"{times[model]:.2g}" for model in models), ""))
    caption = "Relative L2 error (R2), mean over routes; least: of how many routes a model has the least error."
    return Table(name, caption, ("field", "quantity", "split", *models, "least"), tuple(rows), numbers)


def _spread(seeds: pd.DataFrame) -> str:
    error, r2 = seeds["relative_l2"], seeds["r2"]
    spread = f" [{error.min():.3f}, {error.max():.3f}], n = {len(error)}" if len(error) > 1 else ""
    return f"{error.median():.3f}{spread} ({r2.median():.2f})"


def medians_table(cells: Sequence[FieldCell], name: str) -> Table:
    """Median and range over runs of every route, split and model."""
    groups: dict[tuple[str, str, str], list[FieldCell]] = {}
    for cell in cells:
        route = "" if _is_bound(cell.model) else cell.route
        groups.setdefault((cell.split, cell.model, route), []).append(cell)
    rows = []
    for (split, model, route), found in groups.items():
        some = found if route else found[:1]
        errors, r2 = [cell.relative_l2 for cell in some], [cell.r2 for cell in some]
        rows.append((
            split, model, route, str(len(some)), f"{np.median(errors):.3f}", f"{min(errors):.3f} to {max(errors):.3f}",
            f"{np.median(r2):.3f}", f"{np.median([c.bias for c in some]):+.4f}",
            f"{np.median([c.sd for c in some]):.4f}", f"{np.median([c.seconds for c in some]):.1f}",
        ))  # fmt: skip
    first = cells[0]
    caption = (
        f"{first.field}, {first.quantity} [{first.unit}]: medians over runs; relative L2 error about zero with its "
        "range, R2 about the training part's mean, mean and standard deviation of reconstructed minus measured, "
        "processor time of a fit."
    )
    columns = ("split", "model", "sensor", "n", "relative L2", "range", "R2", "bias", "sd", "fit [s]")
    return Table(name, caption, columns, tuple(rows), field_cells_table(cells))


@in_style
def maps_figure(field: Field, snapshots: Mapping[str, NDArray[np.floating]], name: str, source: str) -> Figure:
    """One quantity of a field on its grid, one panel a snapshot, all on one scale of colour."""
    planes = {}
    for title, values in snapshots.items():
        planes[title] = field.on_grid(values)
        while planes[title].ndim > 2:  # of a field in space the middle plane
            planes[title] = planes[title][len(planes[title]) // 2]
    low, high = np.nanquantile(np.concatenate([plane.ravel() for plane in planes.values()]), [0.005, 0.995])
    middle = 0.0 if low < 0 < high else (low + high) / 2  # colours are about zero where values lie on both sides of it
    reach = max(high - middle, middle - low) or 1.0
    columns, (vertical, across) = 2, field.axes[-2:]
    rows, width = -(-len(planes) // columns), (8.0 - 1.6 - 0.5) / columns
    height = float(np.clip(width * np.ptp(vertical.coordinates) / np.ptp(across.coordinates), 0.9, 2.6))
    drawn, grid = panels(rows, columns, height, Room(right=0.85, across=0.5, down=0.5, top=0.35))
    panel_list, meshes = [axes for row in grid for axes in row], []
    for axes in panel_list[len(planes) :]:
        axes.set_visible(False)
    for axes, (title, plane) in zip(panel_list, planes.items(), strict=False):
        axes.set(facecolor="#dddddd", title=title)
        mesh = {"vmin": middle - reach, "vmax": middle + reach, "cmap": "RdBu_r", "rasterized": True}
        meshes.append(axes.pcolormesh(across.coordinates, vertical.coordinates, plane, **mesh))
        _draw_coast(axes, field)
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
    caption = f"{source}. {field.quantities[0]} [{field.units[0]}].{plane_words}"
    return Figure(name, caption, f"{len(planes)} maps on one scale of colour", table, drawn)


@in_style
def routes_figure(field: Field, routes: Mapping[str, NDArray[np.floating]], name: str, source: str) -> Figure:
    """Where sensors go, on the grid of a field with two axes."""
    vertical, across = field.axes[-2:]
    height = float(np.clip(7.0 * np.ptp(vertical.coordinates) / np.ptp(across.coordinates), 1.2, 3.8))
    drawn, ((axes,),) = panels(1, 1, height, Room(top=0.5))
    grey = {"vmin": 0, "vmax": 1, "cmap": "Greys", "rasterized": True}
    axes.pcolormesh(across.coordinates, vertical.coordinates, np.where(field.mask, 0.15, np.nan), **grey)
    _draw_coast(axes, field)
    rows = []
    for k, (title, places) in enumerate(routes.items()):
        colour = ROUTE_COLOURS[k % len(ROUTE_COLOURS)]
        stays = len(np.unique(places, axis=0)) == 1
        look = {"color": colour, "markersize": 5, "linewidth": 1.4, "label": title}
        axes.plot(places[:, 1], places[:, 0], "o" if stays else "-", **look)
        rows.append(pd.DataFrame({"route": title, vertical.name: places[:, 0], across.name: places[:, 1]}))
    axes.set(xlabel=f"{across.name} [{across.unit}]", ylabel=f"{vertical.name} [{vertical.unit}]")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=len(routes), borderaxespad=0.2)
    coast = "The file has no land mask, so no coast is drawn" if field.mask.all() else "Grey: points of the field"
    return Figure(name, f"{source}. {coast}.", "Routes of sensors on a map", pd.concat(rows), drawn)


def _draw_coast(axes: Axes, field: Field) -> None:
    if field.mask.ndim == 2 and not field.mask.all():
        at = [axis.coordinates for axis in reversed(field.axes)]
        axes.contour(*at, field.mask, [0.5], colors="#333333", linewidths=0.7).set_clim(axes.collections[0].get_clim())


@in_style
def flow_figure(numbers: pd.DataFrame, power: float) -> Figure:
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
    left.set(xlabel="wavenumber [1]", ylabel="energy in the shell [1]")
    left.legend(loc="lower left")
    right.plot(numbers["snapshot"], numbers["dissipation"], color="#c8102e", linewidth=1.0, label="dissipation")
    right.axhline(power, color="#888888", linestyle=(0, (4.0, 1.6)), label="power put in")
    most = 1.3 * max(power, float(numbers["dissipation"].max()))
    right.set(ylim=(0, most), xlabel="snapshot", ylabel="per mass and time [1]")
    right.legend(loc="lower right")
    middle = numbers.mean()
    caption = (
        f"Stand-in flow, mean of {len(numbers)} instants: Reynolds number of Taylor's microscale "
        f"{middle['re_lambda']:.1f}, largest wavenumber times Kolmogorov's length {middle['kmax_eta']:.2f}, turnover "
        f"{middle['turnover']:.2f}; dissipation {middle['dissipation']:.4f}, power {power:g}."
    )
    return Figure("flow", caption, "Spectrum of energy, and dissipation over time", numbers, drawn)
