"""How many sensors are enough, and which: add the one that helps most, again and again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.recording import Samples
from gaitdisc.regression.fourier_ridge import fit_fourier_ridge
from gaitdisc.sensing.splits import Parts


def search_sensors(parts: Parts, channels: Sequence[Channel], most: int = 4) -> pd.DataFrame:
    """Choose sensors one by one by the error of ridge regression on their history, on the check part.

    Sensors are chosen by what they add to those that were chosen before them, which need not be the best set of that
    size. The judged part has no say; its error stands beside the choice.

    Parameters
    ----------
    parts : Parts
        Windows in which every candidate is read, and every state told: candidates and states are the same channels.
    channels : sequence of Channel
        Of the candidates, in the order of the windows.
    most : int
        Sensors to choose.

    Returns
    -------
    DataFrame
        One row a step: `sensors` (how many), `added` (the name), `loss` (mean squared error of the scaled states on
        the check part, those read counted as exact), `rmse_deg` (on the judged part, angles that no sensor measures),
        `fits` (models fitted in this step: the cost).

    Examples
    --------
    >>> search_sensors(parts, channels, 2)["added"].tolist()  # doctest: +SKIP
    ['ankle_angle_l', 'hip_flexion_r']
    """
    training, check, test = parts.fitted(), parts.checked(), parts.judged()
    spread, chosen, rows = training.y.std(axis=0), [], []
    for step in range(min(most, len(channels) - 1)):
        candidates = [k for k in range(len(channels)) if k not in chosen]
        losses = [_loss(training, check, [*chosen, k], len(channels), spread) for k in candidates]
        chosen.append(candidates[int(np.argmin(losses))])
        told, rest = _told(training, check, test, chosen, len(channels))
        angles = [column for column, k in enumerate(rest) if channels[k].unit == "deg"]
        error = (told - test.y[:, rest])[:, angles]
        rmse = float(np.sqrt(np.mean(error**2))) if angles else float("nan")
        rows.append((step + 1, channels[chosen[-1]].name, min(losses), rmse, len(candidates)))
    return pd.DataFrame(rows, columns=pd.Index(["sensors", "added", "loss", "rmse_deg", "fits"]))


def _loss(training: Samples, check: Samples, read: list[int], count: int, spread: np.ndarray) -> float:
    told, rest = _told(training, check, check, read, count)
    return float(np.sum(np.mean(((told - check.y[:, rest]) / spread[rest]) ** 2, axis=0)) / count)


def _told(
    training: Samples, check: Samples, asked: Samples, read: list[int], count: int
) -> tuple[np.ndarray, list[int]]:
    """What a model on some sensors tells of the other states, and which these are."""
    rest = [k for k in range(count) if k not in read]
    model = fit_fourier_ridge(_of(training, read, rest, count), _of(check, read, rest, count))
    return model(_of(asked, read, rest, count).x), rest


def _of(samples: Samples, read: list[int], rest: list[int], count: int) -> Samples:
    columns = [k for k in range(samples.x.shape[1]) if k % count in read]
    return replace(
        samples,
        x=samples.x[:, columns],
        y=samples.y[:, rest],
        inputs=tuple(samples.inputs[k] for k in columns),
        outputs=tuple(samples.outputs[k] for k in rest),
    )
