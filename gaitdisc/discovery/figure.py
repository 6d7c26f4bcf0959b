"""Measured, simulated and augmented on what was held out: over time, over the stride, and against the state."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.discovery.effect_words import display_channel, display_unit
from gaitdisc.discovery.method import methods_used
from gaitdisc.discovery.result import Discovery
from gaitdisc.recording.arrays import Values
from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import MEASURED, MODELS, Room, in_style, legend, legend_lines, panels, panels_for

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

SHADE = "#f2b632"  # the gap, as in a comparison of two walks
MOST_CHANNELS = 4
SHOWN = 500  # samples of the stretch that is drawn
STRIDE_BINS, STATE_BINS = 50, 16
FEWEST = 5  # samples of a bin
WORDS = ("measured", "simulated", "augmented")


@in_style
def discovery_figures(discovery: Discovery) -> list[Figure]:
    """Draw a typical stretch over time, the stride where there is a phase, and the gap against each channel."""
    table = display_runs(discovery)
    stride = [_over_stride(discovery, table)] if "phase" in table else []
    state = [_against_state(discovery, table)] if len(table) >= FEWEST * STATE_BINS else []
    return [_over_time(discovery, table), *stride, *state]


@in_style
def explanations_figure(discovery: Discovery) -> list[Figure]:
    """Draw what each explanation leaves of one held-out run, side by side; nothing where there is but one."""
    explanations = [explanation for explanation in discovery.explanations if explanation.time]
    if len(explanations) < 2:
        return []
    channel = discovery.held_out.ranked[0]
    unit, floor = noise_floor(discovery, channel)
    factor = display_channel(discovery, channel)[1]
    drawn, (cells,) = panels(1, len(explanations), 1.1, Room(left=0.6, top=0.3, across=0.12))
    for number, (axes, each) in enumerate(zip(cells, explanations, strict=True), 1):
        axes.axhspan(-2 * floor, 2 * floor, color="#888888", alpha=0.22, linewidth=0)
        axes.plot(each.time, factor * np.array(each.left), color=MODELS["augmented"].colour, linewidth=0.9)
        axes.set_title(str(number))
        axes.sharey(cells[0])
        axes.tick_params(labelleft=number == 1)
        axes.set_xlabel("time [s]", labelpad=1)
    cells[0].set_ylabel(f"[{unit}]", labelpad=1)
    columns = {str(number): pd.Series(factor * np.array(each.left)) for number, each in enumerate(explanations, 1)}
    caption = (
        f"Residual of each explanation in the table, for {channel}: measured minus simulated, over the first held-out "
        "run. Grey band: two standard deviations of the noise."
    )
    table = pd.DataFrame({"time": explanations[0].time} | columns)
    return [Figure("explanations", caption, caption, table, drawn)]


def display_runs(discovery: Discovery) -> pd.DataFrame:
    """Held-out runs in the units that are drawn, degrees in place of radians."""
    table = discovery.to_frame().dropna()
    for channel, unit in zip(discovery.channels, discovery.units, strict=True):
        table[[f"{channel}_{word}" for word in WORDS]] *= display_unit(unit)[1]
    return table


def pick_stretch(table: pd.DataFrame, channel: str) -> pd.DataFrame:
    """A typical stretch of the first trial, of the table of `display_runs`."""
    trial = table[table["trial"] == table["trial"].iloc[0]].reset_index(drop=True)
    gap = (trial[f"{channel}_measured"] - trial[f"{channel}_simulated"]).to_numpy() ** 2
    begin, end = typical_stretch(gap, min(SHOWN, len(trial)))
    shown = trial.iloc[begin:end]
    step = shown["time"].diff()
    interrupted = shown.loc[step > 1.5 * step.median(), ["time"]] - step.median() / 2  # no line across what is unknown
    return pd.concat([shown, interrupted]).sort_values("time", kind="stable")


def draw_runs(axes: Axes, numbers: pd.DataFrame, channel: str) -> None:
    """Draw one channel over time: measured, simulated as read and with what was found; the gap is shaded."""
    time = numbers["time"].to_numpy()
    seen, simulated, augmented = (numbers[f"{channel}_{word}"].to_numpy() for word in WORDS)
    axes.fill_between(time, seen, simulated, color=SHADE, alpha=0.55, linewidth=0, zorder=1)
    axes.plot(time, seen, color=MEASURED.colour, linewidth=1.3, zorder=2)
    _models(axes, time, simulated, augmented)


def draw_left(axes: Axes, numbers: pd.DataFrame, channel: str, floor: float) -> None:
    """Draw what is left of one channel over time: measured minus simulated, as read and with what was found.

    floor: standard deviation of the sensor's noise [as drawn]; twice it is shaded grey
    """
    time = numbers["time"].to_numpy()
    seen, simulated, augmented = (numbers[f"{channel}_{word}"].to_numpy() for word in WORDS)
    axes.axhspan(-2 * floor, 2 * floor, color="#888888", alpha=0.22, linewidth=0)
    axes.fill_between(time, seen - simulated, 0.0, color=SHADE, alpha=0.55, linewidth=0, zorder=1)
    _models(axes, time, seen - simulated, seen - augmented)


def typical_stretch(gap: Values, samples: int) -> tuple[int, int]:
    """Return first and end sample of the stretch whose mean squared gap is the median of all such stretches.

    >>> typical_stretch(np.array([9.0, 9, 1, 1, 4, 4]), 2)
    (4, 6)
    """
    begins = np.arange(0, max(len(gap) - samples, 0) + 1, samples)
    size = np.array([gap[begin : begin + samples].mean() for begin in begins])
    begin = int(begins[np.argsort(size, kind="stable")[len(size) // 2]])
    return begin, min(begin + samples, len(gap))


def bin_values(along: Values, values: Values, edges: Values) -> pd.DataFrame:
    """Return mean and standard deviation of values in bins along others, those with too few samples left out."""
    which = np.clip(np.digitize(along, edges) - 1, 0, len(edges) - 2)
    groups = pd.Series(values).groupby(which)
    table = pd.DataFrame({"mean": groups.mean(), "sd": groups.std().fillna(0.0), "n": groups.size()})
    table.insert(0, "at", ((edges[:-1] + edges[1:]) / 2)[table.index])
    return table[table["n"] >= FEWEST].reset_index(drop=True)


def noise_floor(discovery: Discovery, channel: str) -> tuple[str, float]:
    """Unit in which a channel is drawn, and the standard deviation of its noise in it."""
    text, factor = display_channel(discovery, channel)
    return text or "1", factor * discovery.held_out.channels[channel][2]


def _list_channels(discovery: Discovery) -> list[tuple[str, str, float]]:
    """Name, unit shown, noise floor in that unit."""
    return [(name, *noise_floor(discovery, name)) for name in discovery.held_out.ranked[:MOST_CHANNELS]]


def _over_time(discovery: Discovery, table: pd.DataFrame) -> Figure:
    channels = _list_channels(discovery)
    trial, numbers = table["trial"].iloc[0], pick_stretch(table, channels[0][0])
    drawn, grid = panels(len(channels), 2, 1.75, Room(left=0.6, across=0.62, down=0.52))
    for (left, right), (channel, unit, floor) in zip(grid, channels, strict=True):
        draw_runs(left, numbers, channel)
        draw_left(right, numbers, channel, floor)
        for axes, title in ((left, channel), (right, f"{channel}: residual")):
            axes.set_title(title)
            axes.set_ylabel(f"[{unit}]", labelpad=1)
    for axes in grid[-1]:
        axes.set_xlabel("time [s]", labelpad=1)
    legend(drawn, discovery_key(measured=True))
    fitted = ", its parameters fitted within their bounds" if discovery.corrections else ""
    caption = (
        f"Trial {trial}, {methods_used(discovery).held_out}. Left: measured (black), initial model{fitted} (orange, "
        "dashed), model with the identified effect (green). The gap is shaded. Right: residual of each model. Grey "
        f"band: two standard deviations of the noise. Typical section, {len(numbers.dropna())} samples."
    )
    return Figure("held_out", caption, _alt(discovery), numbers, drawn)


def _over_stride(discovery: Discovery, table: pd.DataFrame) -> Figure:
    channels = _list_channels(discovery)
    bins = min(STRIDE_BINS, max(len(table) // (2 * FEWEST), 1))  # few strides fill few bins
    edges = np.linspace(0, 100, bins + 1)
    percent = 100 * table["phase"].to_numpy()
    drawn, grid = panels(len(channels), 2, 1.75, Room(left=0.6, across=0.62, down=0.52))
    kept = []
    for (left, right), (channel, unit, _) in zip(grid, channels, strict=True):
        seen = table[f"{channel}_measured"].to_numpy()
        curves = {word: bin_values(percent, table[f"{channel}_{word}"].to_numpy(), edges) for word in WORDS}
        at = curves["measured"]["at"].to_numpy()
        means = [curves[word]["mean"].to_numpy() for word in WORDS]
        left.fill_between(at, means[0], means[1], color=SHADE, alpha=0.55, linewidth=0, zorder=1)
        left.plot(at, means[0], color=MEASURED.colour, linewidth=1.3, zorder=2)
        _models(left, at, means[1], means[2])
        gaps = [bin_values(percent, seen - table[f"{channel}_{word}"].to_numpy(), edges) for word in WORDS[1:]]
        for gap, look in zip(gaps, (MODELS["nominal"], MODELS["augmented"]), strict=True):
            low, high = gap["mean"] - gap["sd"], gap["mean"] + gap["sd"]
            right.fill_between(gap["at"], low, high, color=look.colour, alpha=0.15, linewidth=0)
        right.axhline(0.0, color="#888888", linewidth=0.6)
        _models(right, at, gaps[0]["mean"].to_numpy(), gaps[1]["mean"].to_numpy())
        for axes, title in ((left, channel), (right, f"{channel}: residual")):
            axes.set_title(title)
            axes.set_ylabel(f"[{unit}]", labelpad=1)
            axes.set_xlim(0, 100)
            for effect in discovery.where:
                if effect.phase:  # a bar at the foot
                    ends, across = [100 * share for share in effect.phase], axes.get_xaxis_transform()
                    look = {"color": "#b06f00", "linewidth": 2.2, "solid_capstyle": "butt"}
                    axes.plot(ends, [0.02, 0.02], transform=across, **look)
        kept += [
            curve.assign(channel=channel, unit=unit, what=word)
            for curve, word in zip([*curves.values(), *gaps], [*WORDS, "gap_before", "gap_after"], strict=True)
        ]
    for axes in grid[-1]:
        axes.set_xlabel("stride [%]", labelpad=1)
    legend(drawn, discovery_key(measured=True))
    caption = (
        f"Signals and residuals over the stride, all {len(table)} held-out samples in {bins} bins; bands: "
        "standard deviation in a bin. Bar at the bottom: part in which the effect reaches at least half its maximum."
    )
    return Figure("over_stride", caption, _alt(discovery), pd.concat(kept, ignore_index=True), drawn)


def _against_state(discovery: Discovery, table: pd.DataFrame) -> Figure:
    channels = _list_channels(discovery)
    drawn, cells = panels_for(len(channels), 3, 1.75, Room(left=0.6, across=0.62, down=0.62))
    kept = []
    for axes, (channel, unit, _) in zip(cells, channels, strict=True):
        seen = table[f"{channel}_measured"].to_numpy()
        edges = np.linspace(np.quantile(seen, 0.005), np.quantile(seen, 0.995), STATE_BINS + 1)
        gaps = [bin_values(seen, seen - table[f"{channel}_{word}"].to_numpy(), edges) for word in WORDS[1:]]
        for gap, look, shift in zip(gaps, (MODELS["nominal"], MODELS["augmented"]), (-0.1, 0.1), strict=True):
            at = gap["at"] + shift * (edges[1] - edges[0])
            error = gap["sd"].to_numpy()
            axes.errorbar(
                at, gap["mean"], error, color=look.colour, marker=look.mark, markersize=3, linewidth=0.9, elinewidth=0.6
            )
        axes.axhline(0.0, color="#888888", linewidth=0.6)
        axes.set_title(f"{channel}: residual")
        axes.set_xlabel(f"{channel} [{unit}]", labelpad=1)
        axes.set_ylabel(f"[{unit}]", labelpad=1)
        words = ("gap_before", "gap_after")
        kept += [gap.assign(channel=channel, unit=unit, what=word) for gap, word in zip(gaps, words, strict=True)]
    legend(drawn, discovery_key(measured=False))
    caption = (
        f"Residual (measured minus simulated) against the measured channel, all {len(table)} held-out samples: mean "
        "and standard deviation in each bin. The residual of a complete model does not depend on the channel."
    )
    return Figure("against_state", caption, _alt(discovery), pd.concat(kept, ignore_index=True), drawn)


def _models(axes: Axes, at: Values, simulated: Values, augmented: Values) -> None:
    for values, look in ((simulated, MODELS["nominal"]), (augmented, MODELS["augmented"])):
        axes.plot(at, values, color=look.colour, linestyle=look.line, linewidth=1.1, zorder=3)


def discovery_key(measured: bool) -> list[Artist]:
    """Handles of the legend, with what was measured and the shaded gap if these are drawn."""
    from matplotlib.patches import Patch

    looks = {"initial model": MODELS["nominal"], "with the effect": MODELS["augmented"]}
    if not measured:
        return legend_lines(looks)
    return [*legend_lines({"measured": MEASURED} | looks), Patch(color=SHADE, alpha=0.55, label="gap")]


def _alt(discovery: Discovery) -> str:
    sizes = discovery.held_out.channels.items()
    errors = (f"{name} from {before:.3g} to {after:.3g}, noise {floor:.3g}" for name, (before, after, floor) in sizes)
    return f"Root-mean-square residual before and after the effect is added: {'; '.join(errors)} (units of the file)."
