"""Models of simulated walkers on a real one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from ch5_gait import cohort
from ch5_runner import LAGS, SAGITTAL, TOLD, Values, rmse
from further import Number
from real_people import real_people

from gaitdisc.batch.sensed_walks import sensed_walks
from gaitdisc.networks.trained_network import TrainedNetwork
from gaitdisc.sensing.calibration import calibrated
from gaitdisc.sensing.reconstructor import WITHOUT_NETWORK, Sensing, fit_reconstructor, latent_states
from gaitdisc.sensing.splits import split_by_trial
from gaitdisc.sensing.windows import stacked


def simulated(quick: bool, recordings: Path) -> Iterator[Number]:
    """A real walker by models of simulated ones, from right hip, knee and ankle."""
    people = sensed_walks(cohort(recordings, 3, 24.0), SAGITTAL, "nominal").people
    what = Sensing(SAGITTAL, TOLD, LAGS, 100.0)
    each = [stacked([what.windows(walk.recording, walk.phi) for walk in walks]) for walks in people.values()]
    fitted, checked = stacked(each[:-1]), each[-1]
    real = next(person for person in real_people() if person.name == "S01")
    own = [what.windows(one, np.zeros(len(one.time))) for one in real.recordings]
    parts = split_by_trial(own, [8, 9, 10, 11], what.reach_s)
    test, few_real = parts.tested(), parts.training[0]
    mean, size = few_real.x.mean(axis=0), few_real.x.std(axis=0)
    moved = replace(test, x=(test.x - mean) / size * fitted.x.std(axis=0) + fitted.x.mean(axis=0))
    offset = few_real.y.mean(axis=0)
    for kind in ("delay ridge",) if quick else ("delay ridge", "fourier ridge", "shred"):
        done = fit_reconstructor(kind, what, fitted, checked)
        found = {"as simulated": done(test), "readings aligned": done(moved)}
        if isinstance(done.model, TrainedNetwork):
            states = aligned(latent_states(done, test), latent_states(done, few_real), latent_states(done, fitted))
            found["latent states aligned"] = done.model.decoded(states)
        found["linear correction by ten strides' states"] = calibrated(done, few_real.rows(slice(1100)))(test)
        if kind in WITHOUT_NETWORK:
            found["fitted to the person"] = fit_reconstructor(kind, what, parts.fitted(), parts.checked())(test)
        for name, values in found.items():
            yield Number(f"{kind}: {name}", "RMSE [deg]", "", rmse(values - test.y))
            yield Number(
                f"{kind}: {name}",
                "means taken off [deg]",
                "",
                rmse((values - test.y) - (values - test.y).mean(axis=0)),
            )
    yield Number("the person's own mean (null)", "RMSE [deg]", "", rmse(offset - test.y))


def aligned(states: Values, real: Values, simulated_states: Values) -> Values:
    """Latent states with the simulated mean and covariance in place of the real ones (CORAL)."""
    roots = []
    for one in (real, simulated_states):
        values, vectors = np.linalg.eigh(np.cov(one.T) + 1e-4 * np.eye(one.shape[1]))
        roots.append((vectors * np.sqrt(values)) @ vectors.T)
    return (states - real.mean(axis=0)) @ np.linalg.solve(roots[0], roots[1]) + simulated_states.mean(axis=0)
