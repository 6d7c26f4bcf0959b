"""What describes a turbulent flow: its spectrum, and its energy balance over time."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import Room, in_style, panels

SHELL = re.compile(r"e_(\d+)")


@in_style
def flow_figure(numbers: pd.DataFrame, power: float, name: str) -> Figure:
    """Mean spectrum beside the slope of -5/3, and dissipation beside the power that is put in.

    Parameters
    ----------
    numbers : DataFrame
        From `gaitdisc.chapters.turbulence.isotropic.record_turbulence`.
    """
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
