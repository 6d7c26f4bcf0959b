"""Parametric models: how long a stride lasts, as one more input."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from ch5_runner import LAGS, SAGITTAL, TOLD, rmse
from further import Number
from real_people import real_people

import gaitdisc as gd
from gaitdisc.sensing.reconstructor import Sensing, fit_reconstructor
from gaitdisc.sensing.splits import split_by_trial


def speed(quick: bool) -> Iterator[Number]:
    """Every walk by models of the others, without and with the duration of its strides."""
    walker = next(person for person in real_people() if person.name == "S01")
    plain = Sensing(SAGITTAL, TOLD, LAGS, 100.0)
    windows = [plain.windows(one, np.zeros(len(one.time))).rows(slice(None, None, 4)) for one in walker.recordings]
    lasts = [stride_s(one) for one in walker.recordings]
    for kind in ("delay ridge",) if quick else ("delay ridge", "fourier ridge"):
        for name, each in (("", windows), ("stride's duration given", list(map(given, windows, lasts)))):
            sensors = (*SAGITTAL, "stride_s") if name else SAGITTAL
            what = replace(plain, sensors=sensors)
            for place in range(len(each)):
                parts = split_by_trial(each, [place], plain.reach_s)
                done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
                missed = rmse(done(parts.tested()) - parts.tested().y)
                yield Number(f"{kind}, {name}".strip(", "), "RMSE [deg]", f"walk {place + 1}", missed)


def stride_s(walk: gd.Recording) -> float:
    """Period of the knee: the first peak of its autocorrelation after half a second [s]."""
    knee = walk["knee_angle_r"] - walk["knee_angle_r"].mean()
    every = np.correlate(knee, knee, "full")[len(knee) - 1 :]
    return float(50 + np.argmax(every[50:200])) / 100


def given(windows: gd.Samples, lasts: float) -> gd.Samples:
    """Windows whose every reading has the stride's duration beside it."""
    count = len(SAGITTAL)
    x = windows.x.reshape(len(windows), -1, count)
    x = np.concatenate([x, np.full((*x.shape[:2], 1), lasts)], axis=2).reshape(len(windows), -1)
    names = tuple(f"{k} {name}" for k in range(LAGS.count) for name in (*SAGITTAL, "stride_s"))
    return replace(windows, x=x, inputs=names)
