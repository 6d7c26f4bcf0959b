"""The power that a person uses, from EMG and ground forces over the stride, by models of the others."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from ankle_exo_walks import PEOPLE, SETTINGS, read_walks
from chapter5.gait import DATA
from further import Number

import gaitdisc as gd
from gaitdisc.models.fourier_ridge import fit_fourier_ridge
from gaitdisc.reconstruction.windows import stacked


def energy(quick: bool) -> Iterator[Number]:
    """Power of each person from mean strides, by the other seven; tested over the person's nine settings."""
    walks = read_walks(DATA / "ankle_exo_emg_grf")
    curves = {key: table.to_numpy().T for key, table in walks.curves.items()}  # (signal, bin)
    power = walks.energy_w.loc[list(PEOPLE), list(SETTINGS)].to_numpy()
    change = power - power.mean(axis=1, keepdims=True)
    emg = [k for k, name in enumerate(next(iter(walks.curves.values())).columns) if not name.startswith("F")]
    kinds = {"EMG, mean of each": (emg, True), "ground forces, mean curves": (None, False), "both, means": ([], True)}
    rng = np.random.default_rng(0)
    for kind, (which, mean) in kinds.items():
        rows = which or [k for k in range(22) if which is not None or k not in emg]
        read = [[curves[person, setting][rows] for setting in SETTINGS] for person in PEOPLE]
        x = np.array([[one.mean(axis=1) if mean else one.ravel() for one in own] for own in read])
        x = x / np.abs(x).mean(axis=1, keepdims=True)  # a person's own size of each: the EMG's reference is unknown
        own = x - x.mean(axis=1, keepdims=True)
        parts = [gd.Samples(own[k], change[k][:, None], tuple(map(str, range(own.shape[2]))), ("W",),
                            np.arange(9.0), np.zeros(9)) for k in range(len(PEOPLE))]  # fmt: skip
        predicted = []
        for place in range(len(PEOPLE)):
            chosen = (place + 1) % len(PEOPLE)
            fitted = [parts[k] for k in range(len(PEOPLE)) if k not in (place, chosen)]
            model = fit_fourier_ridge(stacked(fitted), parts[chosen])
            predicted.append(model(own[place])[:, 0])
        predicted = np.array(predicted)
        explained = 1 - np.mean((predicted - change) ** 2) / np.mean(change**2)
        shuffled = [np.array([rng.permutation(row) for row in predicted]) for _ in range(200 if quick else 2000)]
        null = np.array([1 - np.mean((each - change) ** 2) / np.mean(change**2) for each in shuffled])
        yield Number(kind, "within persons: R2 [1]", "", float(explained))
        yield Number(kind, "95 % of shuffled settings below [1]", "", float(np.quantile(null, 0.95)))
        yield Number(kind, "p", "", float((1 + np.sum(null >= explained)) / (1 + len(null))))
        for place, person in enumerate(PEOPLE):
            yield Number(kind, "RMSE [W]", person, float(np.sqrt(np.mean((predicted - change)[place] ** 2))))
    for place, person in enumerate(PEOPLE):
        others = np.delete(change, place, axis=0).mean(axis=0)
        yield Number("no setting known (null)", "RMSE [W]", person, float(change[place].std()))
        yield Number("setting known, mean of the others", "RMSE [W]", person, float((others - change[place]).std()))
    others = np.array([np.delete(change, k, axis=0).mean(axis=0) for k in range(len(PEOPLE))])
    explained = float(1 - np.mean((others - change) ** 2) / np.mean(change**2))
    yield Number("setting known, mean of the others", "within persons: R2 [1]", "", explained)
