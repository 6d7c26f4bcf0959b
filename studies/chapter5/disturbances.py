"""Noise on the sensors of a walk and readings that are lost, for every kind of model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from log_axis import decades
from numpy.typing import NDArray

from gaitdisc import Channel, Recording, Samples
from gaitdisc.ingest.study import Study
from gaitdisc.reconstruction.reconstruct_study import ReconstructionSettings
from gaitdisc.reconstruction.sensed_walks import read_walks
from gaitdisc.reconstruction.state_errors import angle_columns
from gaitdisc.reconstruction.window_model import (
    KINDS,
    MASKED,
    WITHOUT_NETWORK,
    Sensing,
    WindowModel,
    fit_reconstructor,
    sensing,
)
from gaitdisc.reconstruction.windows import Parts, fill_readings, split_within, with_missing
from gaitdisc.report.figure import Figure
from gaitdisc.report.page import Block
from gaitdisc.report.panels import RECONSTRUCTED, Room, in_style, legend, panels
from gaitdisc.report.table import save_table
from gaitdisc.words import listing

from .gait import SAGITTAL, SENSORS

NOISES = (0.0, 0.01, 0.02, 0.05, 0.10)
SHARES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
DISTURBED = ("disturbance", "level", "model", "rmse_deg")
Walks = Sequence[tuple[Recording, NDArray[np.float64]]]  # of one person, with the place in the stride (time,) [%]
AXES = {"noise": "noise of the sensors [% of their standard deviation]", "missing": "missing readings [%]"}


def disturbed(study: Study, folder: Path, quick: bool) -> Block:
    """Noise and missing readings, for the first person of the cohort."""
    file, person = folder / "disturbed.csv", study.participants[0].id
    if not file.exists():
        kinds = WITHOUT_NETWORK if quick else tuple(KINDS)
        walks = read_walks(study, SENSORS[SAGITTAL], "nominal")
        names = tuple(channel.name for channel in walks.channels)
        what = sensing(names, SENSORS[SAGITTAL], ReconstructionSettings().lags(walks.rate_hz), walks.rate_hz)
        channels = [channel for channel in walks.channels if channel.name in what.states]
        own = [(walk.recording, walk.phi) for walk in walks.people[person]]
        masked = (MASKED,) if "shred" in kinds else ()
        missing = against_missing(own, what, channels, (*kinds, *masked))
        rows = [*against_noise(own, what, channels, kinds), *missing]
        save_table(pd.DataFrame(rows, columns=pd.Index(DISTURBED)), file)
    figure = disturbance_figure(pd.read_csv(file), f"{person}, {SAGITTAL} sensors")
    return Block("disturbed", "Noise and missing readings", (), (figure,))


def noisy(recording: Recording, sensors: Sequence[str], share: float, seed: int) -> Recording:
    """Add white noise to the readings of the sensors, and to nothing else.

    share: standard deviation of the noise, by that of the sensor in this trial
    """
    rng = np.random.default_rng(seed)
    values = recording.values.copy()
    for name in sensors:
        column = recording.index(name)
        values[:, column] += share * np.nanstd(values[:, column]) * rng.standard_normal(len(values))
    return recording.with_values(values)


def against_noise(walks: Walks, what: Sensing, channels: Sequence[Channel], kinds: Sequence[str]) -> Iterator[tuple]:
    """RMSE of every kind of model against noise, temporal split; fitted to and tested on the same noise.

    returns: disturbance (`noise`), level [share of the sensor's standard deviation], model, rmse_deg (angles)
    """
    for level in NOISES:
        parts = _disturbed_parts(walks, what, lambda walk, k, level=level: noisy(walk, what.sensors, level, k))
        for kind in kinds:
            done = fit_reconstructor(kind, what, parts.fitted(), parts.checked(), 0)
            yield "noise", level, kind, _rmse(done, parts.tested(), channels)


def against_missing(walks: Walks, what: Sensing, channels: Sequence[Channel], kinds: Sequence[str]) -> Iterator[tuple]:
    """RMSE of every kind of model against missing readings, temporal split; fitted to walks that lack none.

    Readings are lost one by one, each sensor by itself. The sensor's last known reading stands in their place; the
    masked SHRED alone is given which are missing.

    returns: disturbance (`missing`), level [share of the readings], model, rmse_deg (angles)
    """
    parts = _disturbed_parts(walks, what, lambda walk, _: walk)
    fitted = {kind: fit_reconstructor(kind, what, parts.fitted(), parts.checked(), 0) for kind in kinds}
    for level in SHARES:
        for kind, done in fitted.items():

            def lost(walk: Recording, k: int, done: WindowModel = done, level: float = level) -> Recording:
                holed = with_missing(walk, what.sensors, level, 0.0, k)
                return holed if done.kind == MASKED else fill_readings(holed, what.sensors, "last", done.sensor_means)

            test = _disturbed_parts(walks, what, lost).tested()
            yield "missing", level, kind, _rmse(done, test, channels)


def _disturbed_parts(walks: Walks, what: Sensing, disturbed: Callable[[Recording, int], Recording]) -> Parts:
    windows = [what.windows(disturbed(walk, k), phi, missing=True) for k, (walk, phi) in enumerate(walks)]
    return split_within(windows, "temporal", what.reach_s)


def _rmse(done: WindowModel, test: Samples, channels: Sequence[Channel]) -> float:
    return float(np.sqrt(np.mean((done(test) - test.y)[:, angle_columns(channels)] ** 2)))


@in_style
def disturbance_figure(found: pd.DataFrame, whose: str) -> Figure:
    """One panel a disturbance, one line a model.

    found: disturbance, level, model, rmse_deg
    """
    from matplotlib.lines import Line2D

    kinds = [word for word in AXES if (found["disturbance"] == word).any()]
    models = list(dict.fromkeys(found["model"]))
    drawn, grid = panels(1, len(kinds), 2.1, Room(left=0.6, across=0.6))
    for axes, kind in zip(grid[0], kinds, strict=True):
        for model, rows in found[found["disturbance"] == kind].groupby("model", sort=False):
            axes.plot(100 * rows["level"], rows["rmse_deg"], markersize=3, linewidth=1.1, **_look(str(model)))
        axes.set(xlabel=AXES[kind], ylabel="RMSE [deg]")
        decades(axes)
    legend(drawn, [Line2D([], [], label=model, markersize=3, **_look(model)) for model in models])
    caption = (
        f"{whose}: RMSE of the angles that no sensor measures, temporal split. Left: white noise on the sensors, in "
        f"the fitted and the test part alike. Right: readings lost one by one in the test part; models were "
        f"fitted to walks that lack none, the last known reading stands for a lost one, and masked shred is "
        f"given which are lost."
    )
    return Figure("disturbed", caption, f"Error of {listing(models)} against noise and missing readings.", found, drawn)


def _look(model: str) -> dict[str, Any]:
    look = RECONSTRUCTED[model]
    return {"color": look.colour, "linestyle": look.line, "marker": look.mark}
