"""Joint moments and metabolic power as outcomes of a response: children who turn, people on an ankle exoskeleton."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from ankle_exo_walks import PEOPLE, SETTINGS, read_walks
from chapter5.gait import DATA
from chapter5.people import ANGLES, CUTOFF_HZ
from further import Number

import gaitdisc as gd
from gaitdisc.models.fourier_ridge import fit_fourier_ridge
from gaitdisc.reconstruction.windows import stacked

MOMENTS = ("ankle_angle_{}_moment", "knee_angle_{}_moment", "hip_flexion_{}_moment")
JOINTS = ("ankle", "knee", "hip")
LOADED, LEAST_S = 0.2, 0.2  # of body weight under the foot; a shorter contact is none of a step


def steps(path: Path) -> gd.Samples:
    """Angles and rates of a child's leg while a plate carries its foot, and the moments of that leg [N m/kg]."""
    trial, found = gd.read(path), []
    angles = gd.lowpass(trial.stream("kinematics").selected(ANGLES), CUTOFF_HZ)
    rates, moments = np.gradient(angles.values, 1 / angles.rate_hz, axis=0), trial.stream("moments")
    for side, other in (("r", "l"), ("l", "r")):
        names = [name.format(side) for name in MOMENTS]
        force = f"{side.upper()}NormalisedGRF.z"
        if force not in moments.names:
            continue
        weight = np.abs(np.nan_to_num(moments[force]))
        weight = weight / 9.81 if weight.max() > 5 else weight  # N/kg, or already a share
        y = moments.selected(names).values
        order = [angles.names.index(name) for name in (*(n for n in ANGLES if n.endswith(side)),
                                                       *(n for n in ANGLES if n.endswith(other)))]  # fmt: skip
        x = np.hstack([angles.values[:, order], rates[:, order]])
        on = (weight > LOADED) & np.isfinite(y).all(axis=1) & np.isfinite(x).all(axis=1)
        if on.sum() > LEAST_S * angles.rate_hz:
            named = tuple(f"x{k}" for k in range(x.shape[1]))
            found.append(gd.Samples(x[on], y[on], named, JOINTS, angles.time[on], 0 * angles.time[on]))
    return stacked(found)


def moments(quick: bool) -> Iterator[Number]:
    """Nominal, Augmented and Exo of moments on the turn of each child, by the other children."""
    people = sorted(path for path in (DATA / "young_straight_and_turn").iterdir() if path.is_dir())
    walks = {way: [steps(next((person / way).glob("*.c3d"))) for person in people] for way in ("straight", "turn")}
    for place, person in enumerate(people[: 2 if quick else None]):
        chosen = (place + 1) % len(people)
        others = [k for k in range(len(people)) if k not in (place, chosen)]
        straight, turn = ([walks[way][k] for k in others] for way in ("straight", "turn"))
        f = fit_fourier_ridge(stacked(straight), walks["straight"][chosen])
        exo = fit_fourier_ridge(stacked(turn), walks["turn"][chosen])
        missed = [replace(each, y=each.y - f(each.x)) for each in (*turn, walks["turn"][chosen])]
        g = fit_fourier_ridge(stacked(missed[:-1]), missed[-1])
        for word, test in (("turn", walks["turn"][place]), ("straight", walks["straight"][place])):
            predicted = {"mean of the others' turns (null)": np.tile(stacked(turn).y.mean(axis=0), (len(test), 1)),
                    "Nominal": f(test.x), "Augmented": f(test.x) + g(test.x), "Exo": exo(test.x)}  # fmt: skip
            for model, values in predicted.items():
                if word == "straight" and model != "Nominal":
                    continue
                for k, joint in enumerate(JOINTS):
                    missed_of = np.sqrt(np.mean((values - test.y)[:, k] ** 2))
                    yield Number(f"{model} on {word}", f"{joint}: RMSE [N m/kg]", person.name, float(missed_of))


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
    others = np.array([np.delete(change, k, axis=0).mean(axis=0) for k in range(len(PEOPLE))])
    for own, by_others, person in zip(change, others, PEOPLE, strict=True):
        yield Number("no setting known (null)", "RMSE [W]", person, float(own.std()))
        yield Number("setting known, mean of the others", "RMSE [W]", person, float((by_others - own).std()))
    explained = float(1 - np.mean((others - change) ** 2) / np.mean(change**2))
    yield Number("setting known, mean of the others", "within persons: R2 [1]", "", explained)
