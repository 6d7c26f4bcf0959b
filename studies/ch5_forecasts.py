"""Forecasts: by a model for each time ahead, and by carrying SHRED's latent state on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from ch5_runner import SAGITTAL, Values, parts_of, rmse, runner
from chapter3.sindy import fit_sindy
from further import Number
from real_people import turning

import gaitdisc as gd
from gaitdisc.sensing.forecast import persistence, phase_average
from gaitdisc.sensing.reconstructor import WITHOUT_NETWORK, Reconstructor, Sensing, fit_reconstructor, latent_states
from gaitdisc.sensing.splits import Parts, split_by_subject
from gaitdisc.sensing.windows import Lags

AHEAD_S, STEP, RANK, SINDY_RANK = (0.04, 0.12, 0.2, 0.4, 0.8), 4, 12, 4


def ahead(quick: bool) -> Iterator[Number]:
    """Errors of every forecast at the times that all of them reach."""
    walk, angles = runner()
    what, parts = parts_of(walk, angles, Lags(25, 4))
    present = fit_reconstructor("shred", what, parts.fitted().rows(slice(600 if quick else None)), parts.checked())
    carried = {"latent state, linear": linear(present, parts), "latent state, SINDy": sparse(present, parts)}
    for ahead_s in AHEAD_S[::4] if quick else AHEAD_S:
        whole, later = parts_of(walk, angles, Lags(25, 4, round(100 * ahead_s)))
        test, found = later.tested(), {}
        for kind in ("delay ridge", "fourier ridge") if quick else ("delay ridge", "fourier ridge", "shred"):
            found[kind] = fit_reconstructor(kind, whole, later.fitted(), later.checked())(test)
        found["persistence"] = persistence(later.test, ahead_s)
        found["phase average"] = phase_average(later.training).forecast(later.test, ahead_s)
        for name, model in carried.items():  # windows of the present that end where these do
            found[name] = model(latent_states(present, test), round(100 * ahead_s))
        known = np.isfinite(np.hstack(list(found.values()))).all(axis=1) | np.isinf(found["latent state, SINDy"][:, 0])
        for name, values in found.items():
            yield Number(name, f"{ahead_s:g} s", "", rmse((values - test.y)[known]))


def components(done: Reconstructor, parts: Parts, rank: int) -> tuple[Values, Values, Values]:
    """Mean latent state, its first directions, and the fitted part's course along them (time, component)."""
    states = latent_states(done, parts.training[0])
    mean = states.mean(axis=0)
    axes = np.linalg.svd(states - mean, full_matrices=False)[2][:rank].T
    return mean, axes, (states - mean) @ axes


def linear(done: Reconstructor, parts: Parts) -> Callable[[Values, int], Values]:
    """Carry the latent state on by the linear map of one step."""
    mean, axes, course = components(done, parts, RANK)
    step = np.linalg.lstsq(course[:-STEP], course[STEP:], rcond=None)[0]
    decoded = partial(getattr(done.model, "decoded"))  # noqa: B009
    return lambda states, n: decoded(mean + (states - mean) @ axes @ np.linalg.matrix_power(step, n // STEP) @ axes.T)


def sparse(done: Reconstructor, parts: Parts) -> Callable[[Values, int], Values]:
    """Carry the latent state on by sparse equations of its first components, by Runge-Kutta steps of 0.01 s."""
    mean, axes, course = components(done, parts, SINDY_RANK)
    names = tuple(f"z{k + 1}" for k in range(SINDY_RANK))
    time, rates = parts.training[0].time, np.gradient(course, 0.01, axis=0)
    rate = fit_sindy(gd.Samples(course, rates, names, tuple(f"d({n})/dt" for n in names), time, 0 * time), degree=2)

    def carried(states: Values, n: int) -> Values:
        z = (states - mean) @ axes
        for _ in range(n):
            k1 = rate(z)
            k2 = rate(z + 0.005 * k1)
            k3 = rate(z + 0.005 * k2)
            z = z + 0.01 / 6 * (k1 + 2 * k2 + 2 * k3 + rate(z + 0.01 * k3))
        return getattr(done.model, "decoded")(mean + z @ axes.T)  # noqa: B009

    return carried


def turns(quick: bool) -> Iterator[Number]:
    """Every child's turn and straight walk, by models of the other children's turns and straight walks."""
    children = turning()
    for ahead_s in (0.1, 0.2) if quick else (0.1, 0.2, 0.3):
        what = Sensing(SAGITTAL, children[0].recordings[0].names, Lags(8, 4, round(100 * ahead_s)), 100.0)
        windows = [child.windows(what.windows) for child in children]
        for place, child in enumerate(children):
            parts = split_by_subject(windows, place)
            for way, trial in zip(("straight", "turn"), windows[place], strict=True):
                column, held = f"{way}, {ahead_s:g} s", persistence([trial], ahead_s)
                known = np.isfinite(held).all(axis=1)
                if known.any():
                    yield Number("persistence", column, child.name, rmse((held - trial.y)[known]))
                for kind in WITHOUT_NETWORK[1:] if known.any() else ():
                    done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
                    yield Number(kind, column, child.name, rmse((done(trial) - trial.y)[known]))
