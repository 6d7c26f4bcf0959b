"""Pages of chapter 3: errors, accuracy against noise and horizon, cost, every cell, who names what, what is stated."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from further import Result, decades, write_page
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Rectangle
from numpy.typing import NDArray

from gaitdisc.report.figure import Figure
from gaitdisc.report.page import Block
from gaitdisc.report.panels import Look, Room, in_style, legend, legend_lines, panels
from gaitdisc.report.table import Table, save_table, words_table
from gaitdisc.words import unit_text

from .cell import FORECAST, ORACLE, PART_WORDS, PARTS, RECONSTRUCTION, DiscrepancyCell, PartAccuracy, cells_table
from .recommend import measured_cells
from .record import System

METHOD_WORDS = {
    "sindy": "SINDy",
    "esindy": "SINDy, ensemble",
    "wsindy": "SINDy, weak form",
    "dmd": "DMD",
    "exactdmd": "exact DMD",
    "bopdmd": "BOP-DMD",
    "gp": "Gaussian process",
    "gpm": "Gaussian process, Matern",
    "nn": "neural network",
}
METHOD_LOOKS = {
    "sindy": Look("#00875a", "-", "s"),
    "esindy": Look("#4caf7d", (0, (4.0, 1.6)), "P"),
    "wsindy": Look("#0b5f3f", (0, (1.2, 1.2)), "X"),
    "dmd": Look("#d97700", (0, (4.0, 1.6)), "o"),
    "bopdmd": Look("#7a3fa0", (0, (3.0, 1.0, 1.0, 1.0)), "D"),
    "exactdmd": Look("#a85f00", (0, (1.2, 1.2)), "p"),
    "gp": Look("#1f4fc8", (0, (1.2, 1.2)), "^"),
    "gpm": Look("#6f8fe0", "-", "<"),
    "nn": Look("#c8102e", (0, (4.0, 1.2, 1.2, 1.2)), "v"),
}
KNOWN, AUGMENTED = Look("#1f4fc8", "-", ""), Look("#111111", (0, (4.0, 1.6)), "")
HORIZONS_S = tuple(np.round(np.geomspace(0.2, 20.0, 40), 2))
MOST_DRAWN = 1000  # points of a line
BAR = 0.16  # of the distance between two noises, for one method
MOST_TERMS = 110  # characters
COEFFICIENT = r"(?<![*\w.])-?[0-9.]+(e[-+]?[0-9]+)?\*"  # of a term, but no power
WORST_SAID = -1000.0  # %: how much worse a run is whose error is eleven times the known model's, rounding decides
MOST_CHANNELS = 4  # that are listed one by one
MOST_WORDS = 120  # characters of an answer
TOOL_WORDS = {"discover": "discover", "sindy": "SINDy", "dmd": "DMD", "gp": "Gaussian process", "nn": "network"}
RIGHT, HALF, WRONG, SILENT, CURVE = "#00875a", "#8fd0b5", "#d97700", "#ffffff", "#c9ced6"
EDGE = "#555555"
LOOKS = {
    "right": (RIGHT, "N", "right, and nothing else"),
    "tied": (HALF, "T", "right or another, tied"),
    "among others": (HALF, "A", "right among others"),
    "wrong name": (WRONG, "W", "wrong name"),
    "curve": (CURVE, "C", "a curve, no name"),
    "nothing": (SILENT, "–", "nothing found"),
    "refused": (SILENT, "R", "refused"),
}
ROW, LEFT = 0.27, 1.75  # inch
FEW, MANY = -999.0, 99.5  # accuracies beyond are written as such


@in_style
def error_figure(cells: Sequence[DiscrepancyCell], name: str, source: str, channel: int = 0) -> Figure:
    """Truth minus known and truth minus augmented over the record's time, a row a method (Figs. 3.3, 3.4, 3.7, 3.8)."""
    cells = [cell for cell in cells if cell.parts]
    drawn, grid = panels(len(cells), len(PARTS), 0.95, Room(left=0.95, across=0.65, down=0.35, right=0.15))
    numbers = []
    for row, cell in zip(grid, cells, strict=True):
        for axes, part in zip(row, PARTS, strict=True):
            found = cell.parts[part]
            some = np.unique(np.linspace(0, len(found.time) - 1, MOST_DRAWN).astype(int))
            table = pd.DataFrame({"method": cell.method, "part": part, "t_s": found.begins_s + found.time[some]})
            for model, look in (("known", KNOWN), ("augmented", AUGMENTED)):
                table[model] = (found.truth - getattr(found, model))[some, channel]
                axes.plot(table["t_s"], table[model], color=look.colour, linestyle=look.line, linewidth=0.8)
            when = "" if found.diverged_s is None else f"diverged at t = {found.begins_s + found.diverged_s:.2f} s"
            axes.set_title("\n".join(filter(None, (PART_WORDS[part] if row is grid[0] else "", when))))
            axes.set_xlim(found.begins_s, found.begins_s + found.time[-1])
            axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}".replace("-", "\N{MINUS SIGN}"))
            numbers.append(table)
        row[0].set_ylabel(f"{METHOD_WORDS[cell.method]}\nerror of {cell.channels[channel]} [{_unit(cell, channel)}]")
    for axes in grid[-1]:
        axes.set_xlabel("time in the record [s]")
    legend(drawn, legend_lines({"truth − known": KNOWN, "truth − augmented": AUGMENTED}))
    caption = (
        f"{source}. {cells[0].system}, {cells[0].channels[channel]}: reconstruction of the training part from the true "
        "first state; forecast from the noise-free true state (an oracle), and from the start estimated from the data; "
        f"approach: {cells[0].approach}; variant: {cells[0].variant}; noise {cells[0].noise:g}."
    )
    return Figure(name, caption, f"Error curves of {len(cells)} methods over time", pd.concat(numbers), drawn)


def _unit(cell: DiscrepancyCell, channel: int) -> str:
    return unit_text(cell.units[channel]) if cell.units else "1"


@in_style
def system_figure(cell: DiscrepancyCell, missing: NDArray[np.float64], name: str, source: str) -> Figure:
    """Phase portraits and time evolution of true and known system, and what is missing in rates and states."""
    found, channels = cell.parts[PARTS[0]], cell.channels
    said = [f"{channel} [{_unit(cell, k)}]" for k, channel in enumerate(channels)]
    drawn, grid = panels(2, 3, 1.5, Room(across=0.6, down=0.6))
    some = np.unique(np.linspace(0, len(found.time) - 1, MOST_DRAWN).astype(int))
    lacking, last = int(np.argmax(np.abs(missing).max(axis=0))), len(channels) - 1
    table = pd.DataFrame({"t_s": found.time[some]})
    for row, model, look in zip(grid, ("truth", "known"), (AUGMENTED, KNOWN), strict=True):
        for channel, values in zip(channels, getattr(found, model)[some].T, strict=True):
            table[f"{channel} {model}"] = values
        across, up = (table[f"{channels[k]} {model}"] for k in (0, last))
        row[0].plot(across, up, color=look.colour, linewidth=0.6)
        title = f"phase portrait, {'true' if model == 'truth' else 'known'}"
        row[0].set(title=title, xlabel=said[0], ylabel=said[last])
        for panel, k, values in ((grid[0][1], 0, across), (grid[1][1], last, up)):
            panel.plot(table["t_s"], values, color=look.colour, linestyle=look.line, linewidth=0.7)
            panel.set(ylabel=said[k], xlabel="time [s]")
    table["missing rate"], table["residual"] = missing[some, lacking], (found.truth - found.known)[some, 0]
    unit = _unit(cell, lacking)
    rate = unit_text(f"{unit}2" if unit.endswith("/s") else f"{unit}/s")
    lacks = channels[lacking]
    for panel, column, words, label in (
        (grid[0][2], "missing rate", f"dynamical error: rate of {lacks}", f"missing rate of {lacks} [{rate}]"),
        (grid[1][2], "residual", f"state-space residual of {channels[0]}", f"truth − known, {said[0]}"),
    ):
        panel.plot(table["t_s"], table[column], color=AUGMENTED.colour, linewidth=0.7)
        panel.set(title=words, xlabel="time [s]", ylabel=label)
    legend(drawn, legend_lines({"true": AUGMENTED, "known": KNOWN}))
    caption = (
        f"{source}. True and known system from the same start, without noise: phase portraits, time evolution, and the "
        "two errors along the truth."
    )
    return Figure(name, caption, "Phase portraits, curves over time, two error signals", table, drawn)


@in_style
def accuracy_figure(cells: Sequence[DiscrepancyCell], name: str, source: str) -> Figure:
    """Clipped accuracy against noise, a row an approach (Figs. 3.5, 3.10, 3.13)."""
    table = cells_table([cell for cell in cells if cell.parts])
    approaches, noises = list(dict.fromkeys(table["approach"])), sorted(table["noise"].unique())
    over = table.groupby(["approach", "part", "method", "noise", "seed"], sort=False)["clipped"].median()
    spread = over.groupby(level=[0, 1, 2, 3]).agg(["median", "min", "max", "size"])
    spread["diverged_s"] = table.groupby(["approach", "part", "method", "noise"])["diverged_s"].min()
    spread.loc[spread["diverged_s"].notna(), ["median", "min", "max"]] = np.nan  # a time, and never a number
    spread = spread.reset_index()
    drawn, grid = panels(len(approaches), len(PARTS), 1.4, Room(across=0.4, down=0.5))
    methods = list(dict.fromkeys(table["method"]))
    noise_unit = "channel’s unit" if cells[0].variant == "as published" else "share of the channel’s SD"
    for row, approach in zip(grid, approaches, strict=True):
        for axes, part in zip(row, PARTS, strict=True):
            here = spread[(spread["approach"] == approach) & (spread["part"] == part)]
            for k, method in enumerate(methods):
                rows = here[here["method"] == method]
                at = [noises.index(noise) + (k - (len(methods) - 1) / 2) * BAR for noise in rows["noise"]]
                axes.bar(at, rows["median"], 0.9 * BAR, color=METHOD_LOOKS[method].colour)
                axes.vlines(at, rows["min"], rows["max"], color="#111111", linewidth=0.7)
                lost = [place for place, time in zip(at, rows["diverged_s"], strict=True) if np.isfinite(time)]
                axes.plot(lost, [-97.0] * len(lost), "x", color=METHOD_LOOKS[method].colour, markersize=4)
            axes.set_xticks(range(len(noises)), [f"{noise:g}" for noise in noises])
            axes.set_ylim(-105, 105)
            axes.axhline(0, color="#111111", linewidth=0.5)
            axes.set_title(f"{approach}: {PART_WORDS[part]}")
        row[0].set_ylabel("less RMSE than known [%]")
    for axes in grid[-1]:
        axes.set_xlabel(f"noise [{noise_unit}]")
    legend(drawn, _patches({METHOD_WORDS[method]: METHOD_LOOKS[method] for method in methods}))
    caption = (
        f"{source}. 100 (1 − RMSE augmented / RMSE known) against the noise-free truth, median of channels, clipped to "
        f"±100; lines: least to most of n = {int(spread['size'].max())} seeds. ×: diverged, in one seed at least. "
        "Oracle start: the noise-free true state, which no user has; estimated start: from the noisy data."
    )
    return Figure(name, caption, "Bars of accuracy against noise, by method", spread, drawn)


@in_style
def horizon_figure(cells: Sequence[DiscrepancyCell], name: str, source: str) -> Figure:
    """Percent change in RMSE against the forecast horizon, a panel an approach (Fig. 3.9)."""
    cells = [cell for cell in cells if cell.parts]
    approaches = list(dict.fromkeys(cell.approach for cell in cells))
    drawn, grid = panels(1, len(approaches), 1.8, Room(across=0.6))
    tables, methods = [], list(dict.fromkeys(cell.method for cell in cells))
    longest = max(float(cell.parts[FORECAST].time[-1]) for cell in cells)
    for axes, approach in zip(grid[0], approaches, strict=True):
        for cell in (each for each in cells if each.approach == approach):
            part, look = cell.parts[FORECAST], METHOD_LOOKS[cell.method]
            last_s = float(part.time[-1])
            horizons = [each for each in HORIZONS_S if each < last_s] + [last_s]
            change = part.change(horizons)
            axes.plot(horizons, np.clip(change, -100, 100), color=look.colour, linestyle=look.line)
            row = {"approach": approach, "method": cell.method, "horizon_s": horizons, "accuracy": change}
            tables.append(pd.DataFrame(row))
        axes.axvline(cells[0].parts[FORECAST].first_jump_s(), color="#7a7a7a", linewidth=0.6)
        axes.set(xlim=(0, longest), title=approach, xlabel="forecast horizon [s]")
    grid[0][0].set_ylabel("less RMSE than known [%]")
    legend(drawn, legend_lines({METHOD_WORDS[method]: METHOD_LOOKS[method] for method in methods}))
    caption = (
        f"{source}. Median over channels, clipped to ±100, to the end of the forecast after {longest:g} s, from the "
        f"start estimated from the data; grey: the truth’s first jump. Noise {cells[0].noise:g}."
    )
    return Figure(name, caption, "Curves of accuracy against horizon", pd.concat(tables), drawn)


@in_style
def cost_figure(cells: Sequence[DiscrepancyCell], name: str, source: str) -> Figure:
    """Seconds to fit and to run, by method and approach (Fig. 3.11)."""
    rows = [(c.approach, c.method, c.fit_s, c.run_s) for c in cells if c.parts]
    table = pd.DataFrame(rows, columns=pd.Index(["approach", "method", "fit_s", "run_s"]))
    middle = table.groupby(["approach", "method"], sort=False).median().reset_index()
    approaches = list(dict.fromkeys(middle["approach"]))
    drawn, grid = panels(1, len(approaches), 1.6, Room(across=0.6, bottom=0.5))
    for axes, approach in zip(grid[0], approaches, strict=True):
        part = middle[middle["approach"] == approach]
        at = np.arange(len(part))
        axes.bar(at - 0.2, part["fit_s"], 0.36, color="#555555")
        axes.bar(at + 0.2, part["run_s"], 0.36, color="#bbbbbb")
        decades(axes)
        axes.set_xticks(at, [METHOD_WORDS[str(method)].replace(" ", "\n") for method in part["method"]])
        axes.set_title(approach)
    grid[0][0].set_ylabel("processor time [s]")
    legend(drawn, _patches({"fit": Look("#555555", "-", ""), "runs": Look("#bbbbbb", "-", "")}))
    caption = (
        f"{source}. Processor time: fit (dark), and estimating the start and running all parts (light); median over "
        "noises and seeds."
    )
    return Figure(name, caption, "Bars of seconds", middle, drawn)


@in_style
def field_figure(found: PartAccuracy, places: Sequence[float], name: str, source: str) -> Figure:
    """Error of known and augmented model over space and the record's time (Fig. 3.12)."""
    drawn, grid = panels(1, 2, 2.0, Room(right=1.0, top=0.3, across=0.6))
    some = np.unique(np.linspace(0, len(found.time) - 1, 200).astype(int))
    time = found.begins_s + found.time[some]
    errors = {model: (found.truth - getattr(found, model))[some] for model in ("known", "augmented")}
    most, drawn_maps = float(np.nanmax(np.abs(errors["known"]))) or 1.0, []
    for axes, (model, error) in zip(grid[0], errors.items(), strict=True):
        span = {"vmin": -most, "vmax": most, "cmap": "RdBu_r", "rasterized": True}
        drawn_maps.append(axes.pcolormesh(places, time, error, **span))
        axes.set(title=f"truth − {model}", xlabel="place [1]")
    grid[0][0].set_ylabel("time in the record [s]")
    beyond = "both" if np.nanmax(np.abs(errors["augmented"])) > most else "neither"
    place = grid[0][-1].get_position()
    beside = drawn.add_axes((place.x1 + 0.015, place.y0, 0.012, place.height))
    drawn.colorbar(drawn_maps[-1], cax=beside, extend=beyond, label="error of u [1]")
    sizes = {f"rmse_{model}": np.sqrt(np.mean(error**2, axis=1)) for model, error in errors.items()}
    numbers = pd.DataFrame({"t_s": time, **sizes})
    caption = (
        f"{source}. Colours span ±{most:.3g}, the known model’s largest error; errors beyond have the last colour."
    )
    return Figure(name, caption, "Two maps of error over space and time", numbers, drawn)


def _patches(looks: dict[str, Look]) -> list[Artist]:
    return [Patch(color=look.colour, label=words) for words, look in looks.items()]


def grid_table(cells: Sequence[DiscrepancyCell], name: str) -> Table:
    """Accuracy of every cell, a row a method, approach and noise; the median of the seeds."""
    groups: dict[tuple, list[DiscrepancyCell]] = {}
    for cell in cells:
        groups.setdefault((cell.variant, cell.approach, cell.method, cell.noise), []).append(cell)
    rows = []
    for (variant, approach, method, noise), found in groups.items():
        parts = [[c.parts[part] for c in found if c.parts] for part in PARTS]
        rows.append((
            variant, approach, METHOD_WORDS[method], f"{noise:g}", f"{len(found)}",
            *(_cell(each, len(found)) for each in parts),
            *(_median([p.valid_s("augmented") for p in each]) for each in parts[1:]),
            _median([p.valid_s("known") for p in parts[2]]),
            _median([c.fit_s for c in found]), _median([c.run_s for c in found]), _found(found),
        ))  # fmt: skip
    columns = (
        "variant", "approach", "method", "noise", "n", "reconstruction, true start [%]",
        "forecast, true start (oracle) [%]", "forecast, estimated start [%]", "oracle valid [s]", "valid [s]",
        "known valid [s]", "fit [s]", "run [s]", "found",
    )  # fmt: skip
    caption = (
        "100 (1 − RMSE augmented / RMSE known) by channel, unclipped, against the noise-free truth: median and "
        "[least, greatest] of n seeds; without noise there is one. "
        "True start: the noise-free state, which no user has; estimated start: from the noisy measurement. "
        "How far below −1000 it lies depends on the machine, and is not said. "
        "Valid: until the error passes 0.4 standard deviations, median. Seconds of processor time. "
        "Found: terms of the first seed."
    )
    return Table(name, caption, columns, tuple(rows), cells_table(cells))


def _cell(parts: list[PartAccuracy], seeds: int) -> str:
    """Say median and range over the seeds, by channel; when it diverged, and in how many seeds, instead of a number."""
    if not parts:
        return "not fitted"
    if diverged := diverged_words(parts, seeds):
        return diverged
    accuracy = np.array([part.accuracy() for part in parts])
    many = accuracy.shape[1] > MOST_CHANNELS
    columns = [np.median(accuracy, axis=1)] if many else list(accuracy.T)
    said = "; ".join(spread_words(column) for column in columns)
    said += f" (median of {accuracy.shape[1]})" if many else ""
    return said if len(parts) == seeds else f"{said} ({len(parts)} of {seeds} seeds)"


def diverged_words(parts: Sequence[PartAccuracy], seeds: int = 1) -> str:
    """Say when the first of some runs diverged, and of how many seeds; nothing where none did."""
    lost = [part.diverged_s for part in parts if part.diverged_s is not None]
    return f"diverged at t = {min(lost):.2f} s" + f" ({len(lost)} of {seeds} seeds)" * (seeds > 1) if lost else ""


def spread_words(values: NDArray[np.float64]) -> str:
    """Median, and least and greatest where there are several."""
    if not np.isfinite(values).all():
        return "nothing to mend"
    three = (float(np.median(values)), values.min(), values.max())
    middle, low, high = (f"{one:.1f}" if one >= WORST_SAID else f"below {WORST_SAID:.0f}" for one in three)
    return middle if len(values) == 1 else f"{middle} [{low}, {high}]"


def _median(seconds: list[float]) -> str:
    return f"{np.median(seconds):.1f}" if seconds else ""


def _found(cells: list[DiscrepancyCell]) -> str:
    refused = [cell.refused for cell in cells if cell.refused]
    if refused:
        return refused[0] + (f" ({len(refused)} of {len(cells)} seeds)" * (len(cells) > 1))
    kinds = [re.sub(COEFFICIENT, "", cell.terms) for cell in cells]
    same = f" (the same terms in {kinds.count(kinds[0])} of {len(cells)} seeds)" * (len(cells) > 1)
    terms = cells[0].terms
    if len(terms) > MOST_TERMS:
        terms = f"{terms[:MOST_TERMS]}… ({terms.count('*')} products)"
    return terms + same if terms else ""


def statements_table(statements: Sequence[tuple[str, str, str]], name: str) -> Table:
    """What the dissertation states, and what was found."""
    caption = "The dissertation's statements beside what was found here."
    return words_table(name, caption, ("where", "dissertation", "ours"), statements)


def naming_table(table: pd.DataFrame) -> Table:
    """What each tool answers, a row a case and noise, of `namings_table`."""
    tools = [tool for tool in TOOL_WORDS if tool in set(table["tool"])]
    rows = []
    for (case, noise), found in table.groupby(["case", "noise"], sort=False):
        cells = [_answers(found[found["tool"] == tool]) for tool in tools]
        n = str(found["seed"].nunique())
        rows.append((str(case), str(found["hidden"].iloc[0]) or "nothing", f"{noise:.1%}", n, *cells))
    rows.sort(key=lambda row: list(dict.fromkeys(table["case"])).index(row[0]))
    caption = (
        "Answers, with how many of the n seeds gave them (curves: of the first alone); × the true number: median of "
        "the seeds that named it. Of a curve: how far it is from what is missing, along the record without noise."
    )
    columns = ("case", "hidden", "noise", "n", *(TOOL_WORDS[tool] for tool in tools))
    return Table("names", caption, columns, tuple(rows), table)


def _answers(found: pd.DataFrame) -> str:
    if not len(found):
        return ""
    counts, amounts = found["answer"].value_counts(sort=False), found["amount"].dropna()
    some = [f"{answer} {count}/{len(found)}" if count < len(found) else str(answer) for answer, count in counts.items()]
    words = ", ".join(some) + (f" (× {amounts.median():.4g})" if len(amounts) else "")
    first = str(found["said"].iloc[0]).split(";")[0]
    shown = found["answer"].iloc[0] in ("curve", "refused") and len(first) < MOST_WORDS
    return f"{words}: {first}" if shown else words


@in_style
def naming_figure(table: pd.DataFrame, name: str) -> Figure:
    """A row a case, a column a tool and noise; the tile shows the answer, and the forecast."""
    rows = []
    for tool in TOOL_WORDS:
        for (case, noise), found in table[table["tool"] == tool].groupby(["case", "noise"], sort=False):
            counts = found["answer"].where(~found["right"], "right").value_counts(sort=False)
            share = float(counts.max() / len(found))  # of the seeds, for their most frequent answer
            rows.append((case, tool, noise, str(counts.idxmax()), share, _forecast(found)))
    tiles = pd.DataFrame(rows, columns=pd.Index(["case", "tool", "noise", "kind", "share", "forecast"]))
    cases, noises = list(dict.fromkeys(table["case"])), sorted(table["noise"].unique())
    tools = list(dict.fromkeys(tiles["tool"]))
    room = Room(left=LEFT, top=0.75, bottom=0.35, across=0.06)
    drawn, (row,) = panels(1, len(tools), ROW * len(cases), room)
    for axes, tool in zip(row, tools, strict=True):
        _draw_tiles(axes, tiles[tiles["tool"] == tool], cases, noises)
        axes.set_title(TOOL_WORDS[tool])
    hidden = dict(zip(table["case"], table["hidden"], strict=True))
    labels = [f"{case}:\n{hidden[case]}" if hidden[case] else case for case in cases]
    row[0].set_yticks(np.arange(len(cases)) + 0.5, labels, fontsize=6)
    row[len(tools) // 2].set_xlabel("noise [% of each channel’s SD]")
    key = [Patch(facecolor=c, edgecolor=EDGE, label=f"{letter} {words}") for c, letter, words in LOOKS.values()]
    legend(drawn, key[:4])
    legend(drawn, key[4:], down=0.2)
    caption = (
        "Answer of most seeds, with its share in percent where the seeds differ; below it, how much less RMSE the "
        "forecast from the noise-free true state (an oracle) has than the known model’s [%], median of "
        f"n = {table['seed'].nunique()} seeds (without noise, and of the curves, one; no tile: not run)."
    )
    return Figure(name, caption, "Tiles of answers by case, tool and noise", tiles, drawn)


def _draw_tiles(axes: Axes, tiles: pd.DataFrame, cases: list[str], noises: list[float]) -> None:
    for case, _, noise, kind, share, forecast in tiles.itertuples(index=False):
        down, across = cases.index(str(case)), noises.index(noise)
        colour, letter, _ = LOOKS[kind]
        axes.add_patch(Rectangle((across, down), 1, 1, facecolor=colour, edgecolor=EDGE, linewidth=0.4))
        ink = "#ffffff" if colour in (RIGHT, WRONG) else "#111111"
        said = letter if share == 1 else f"{letter} {share:.0%}".replace("%", "")
        axes.text(across + 0.5, down + 0.30, said, ha="center", va="center", fontsize=6, color=ink)
        axes.text(across + 0.5, down + 0.72, forecast, ha="center", va="center", fontsize=5, color=ink)
    axes.set_xlim(0, len(noises))
    axes.set_ylim(len(cases), 0)
    axes.set_xticks(np.arange(len(noises)) + 0.5, [f"{100 * noise:g}" for noise in noises])
    axes.set_yticks([])
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def _forecast(found: pd.DataFrame) -> str:
    if found["diverged_s"].notna().any():
        return "div."
    middle = float(found["accuracy"].median())
    if not np.isfinite(middle):
        return ""
    if middle < FEW:
        return f"<{FEW:.0f}".replace("-", "−")
    return (f"{middle:.1f}" if middle > MANY else f"{middle:.0f}").replace("-", "−")


Cells = Mapping[str, tuple[DiscrepancyCell, ...]]
Stated = tuple[str, str, str, float]  # where, statement, approach, noise
APART = "the time evolution diverges quickly with only an eps-small difference in the dynamics"
COST = "SINDy costs least, then DMD, GPR and NN, in both approaches; NN in the dynamics over 500 s, up to 2,100 s"
HORIZON = "dynamics: near 100 % at first, falls at the first jump (about 5 s), settles near 0"
SAID_WITHIN_S = (0.3, 1.0, 5.0, 20.0)
ARTEFACT = (
    "As published, SINDy's map for the residual is integrated as if it gave a rate, from zero, and added; the map "
    "itself is evaluated in the cells done right. That is why the chapter finds that SINDy learns no residual."
)


def apart_words(cells: Cells) -> str:
    """Say how long the known system stays near the true one, by variant."""
    parts = {v: next(c.parts[RECONSTRUCTION] for c in found if c.parts and not c.noise) for v, found in cells.items()}
    near = (f"{v}: within 0.4 SD for {part.valid_s('known'):.1f} of {part.time[-1]:.0f} s" for v, part in parts.items())
    return "; ".join(near)


def cost_words(cells: Cells) -> str:
    """Seconds of a core of each method, cheapest first, by approach: median over variants, noises and seeds."""
    said = []
    for approach in ("dynamics", "state"):
        some = [c for found in cells.values() for c in found if c.approach == approach and c.parts]
        spent = {m: np.median([c.fit_s + c.run_s for c in some if c.method == m]) for m in {c.method for c in some}}
        ordered = sorted(spent.items(), key=lambda item: item[1])
        words = [f"{METHOD_WORDS[method]} {seconds:.1f} s" for method, seconds in ordered]
        said.append(f"{approach}: {', '.join(words)}")
    return "; ".join(said)


def horizon_words(cells: Cells) -> str:
    """Say how much less error the forecasts have within a few horizons, without noise, by variant and method."""
    said = []
    for variant, found in cells.items():
        some = []
        for cell in (c for c in found if c.approach == "dynamics" and c.parts and not c.noise):
            part = cell.parts[FORECAST]
            changes = part.change([each for each in SAID_WITHIN_S if each <= part.time[-1]])
            within = "/".join(f"{each:.0f}" if np.isfinite(each) else diverged_words([part]) for each in changes)
            some.append(f"{METHOD_WORDS[cell.method]} {within}")
        said.append(f"{variant}: {', '.join(some)}")
    return f"[%] from the estimated start, within {'; '.join(map('{:g}'.format, SAID_WITHIN_S))} s; " + "; ".join(said)


def answered(cells: Cells, approach: str, noise: float) -> str:
    """Forecast (oracle; reconstruction) accuracy of each method, by variant: median and range over seeds."""
    said = []
    for variant, found in cells.items():
        some = [c for c in found if c.approach == approach and c.noise == noise]
        parts = [f"{METHOD_WORDS[m]} {_accuracy([c for c in some if c.method == m])}" for m in METHOD_WORDS]
        if some:
            said.append(f"{variant}: {', '.join(part for part in parts if not part.endswith(' '))}")
    what = "forecast from the estimated start (from the true state, an oracle; reconstruction) [%]"
    return "; ".join([what, *said]) if said else "not computed"


def _accuracy(cells: Sequence[DiscrepancyCell]) -> str:
    fitted = [cell for cell in cells if cell.parts]
    if not fitted:
        return "not fitted" if cells else ""
    words = []
    for name in (FORECAST, ORACLE, RECONSTRUCTION):
        parts = [cell.parts[name] for cell in fitted]
        said = spread_words(np.array([np.median(part.accuracy()) for part in parts]))
        words.append(diverged_words(parts, len(cells)) or said)
    return f"{words[0]} ({words[1]}; {words[2]})"


def blocks_of(
    cells: Cells, figures: Mapping[str, str], stated: Sequence[Stated], systems: Mapping[str, System] | None = None
) -> list[Block]:
    """Parts of a page: a variant each, with the figures that the chapter has."""
    statements = [(where, words, answered(cells, approach, noise)) for where, words, approach, noise in stated]
    captions = (("system", APART, apart_words), ("horizon", HORIZON, horizon_words), ("cost", COST, cost_words))
    statements += [(figures[key], words, answer(cells)) for key, words, answer in captions if key in figures]
    first = statements_table(statements, "stated")
    blocks = [Block("stated", "What the chapter states", (ARTEFACT,), tables=(first,))]
    for number, (variant, found) in enumerate(cells.items(), 1):
        quiet = [cell for cell in found if cell.noise == 0]
        drawn = []
        if systems and variant in systems:
            truth, system = quiet[0].parts[RECONSTRUCTION].truth, systems[variant]
            missing = system.true(truth) - system.known(truth)
            drawn.append(system_figure(quiet[0], missing, f"system-{number}", figures["system"]))
        for approach in ("dynamics", "state"):
            some = [cell for cell in quiet if cell.approach == approach and cell.parts]
            if approach in figures and some:
                drawn.append(error_figure(some, f"{approach}-{number}", figures[approach]))
        drawn.append(accuracy_figure(found, f"noise-{number}", figures["noise"]))
        for key, draw, some in (("horizon", horizon_figure, quiet), ("cost", cost_figure, found)):
            drawn += [draw(some, f"{key}-{number}", figures[key])] if key in figures else []
        table = grid_table(found, f"cells-{number}")
        blocks.append(Block(f"variant-{number}", variant, (), tuple(drawn), (table,)))
    return blocks


def written(cells: Cells, blocks: Sequence[Block], title: str, folder: Path) -> Result:
    """Write the page, and what `recommend` could answer from."""
    measured = [cell for found in cells.values() for cell in found if cell.approach == "dynamics"]
    result = write_page(cells, blocks, title, "chapter 3, computed anew.", folder)
    if measured:
        save_table(measured_cells(measured), folder / "measured_cells.csv")
    return result
