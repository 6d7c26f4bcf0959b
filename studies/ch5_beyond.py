"""What came after the dissertation, on real recordings: each method beside what the program does already.

    python studies/ch5_beyond.py [FOLDER] [--tables few speed spread simulated] [--keep] [--quick]
    python studies/ch5_beyond.py --print TABLE

`few`: a runner in a condition that no model saw, after ten strides of it: the program's linear correction beside models
fitted anew to these strides, to all walks with these strides weighed ten times, and SHRED descended further on them.
`speed`: parametric models: how long a stride lasts, as one more input, on walks left out (twelve walks of one person).
`spread`: the interval that five SHREDs' spread gives (an ensemble UQ-SHRED) beside the conformal one of the program.
`simulated`: models of simulated walkers on a real one (DA-SHRED): as they are, with the readings given the simulated
mean and size, with SHRED's latent states given the simulated mean and covariance; then fitted to that person.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

TABLES = ("few", "speed", "spread", "simulated")
GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", "a file for each table that was computed, and recordings", Path("ch5_beyond")),
    argument("--tables", "which of them are computed", list(TABLES)),
    argument("--keep", "write studies/ch5_beyond.csv as well", False),
    argument("--print", "compute nothing; print this table", "", metavar="TABLE"),
    QUICK,
)  # before the slow imports

import copy
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from ch5_further import parts_of, rmse, runner
from ch5_gait import DATA, SENSORS, cohort, exotendon, first_person
from further import Made, Number, main
from numpy.typing import NDArray
from real_people import ANGLES, real_people

import gaitdisc as gd
from gaitdisc.batch.sensed_walks import SensedWalk, sensed_walks
from gaitdisc.networks.ensemble import Ensemble
from gaitdisc.networks.trained_network import TrainedNetwork
from gaitdisc.networks.trainer import train
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.sensing.calibration import calibrated, first_strides
from gaitdisc.sensing.intervals import coverage, half_widths
from gaitdisc.sensing.latent_states import latent_states
from gaitdisc.sensing.reconstructor import ENSEMBLE, WITHOUT_NETWORK, Sensing, fit_reconstructor
from gaitdisc.sensing.splits import split_by_trial
from gaitdisc.sensing.windows import Lags, stacked

SAGITTAL, STRIDES, WEIGHT = SENSORS["3 sagittal"], 10, 10
TOLD = tuple(name for name in ANGLES if name not in SAGITTAL)
LAGS = Lags(25, 4)
Values = NDArray[np.float64]


def few(quick: bool) -> Iterator[Number]:
    """Each condition of one runner by models of the other, then by ten strides."""
    walks = sensed_walks(first_person(exotendon(DATA)), SAGITTAL)
    both: tuple[SensedWalk, ...] = next(iter(walks.people.values()))
    what = Sensing(SAGITTAL, TOLD, LAGS, walks.rate_hz)
    windows = [what.windows(walk.recording, walk.phi) for walk in both]
    for place, walk in enumerate(both):
        parts = split_by_trial(windows, [place], what.reach_s)
        first = first_strides(parts.test, STRIDES, what.reach_s)
        judged, column = parts.judged().rows(first.rest), f"{walk.recording.condition} tested"
        for kind in ("delay ridge", "fourier ridge") if quick else ("delay ridge", "fourier ridge", "shred"):
            done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
            found = {"as it is": done, "linear correction": calibrated(done, first.strides)}
            inner = first.strides.last_block(0.2, what.reach_s)
            if isinstance(done.model, TrainedNetwork):
                found["descended further"] = replace(done, model=descended(done.model, *inner))
            else:
                found["ten strides alone"] = fit_reconstructor(kind, what, *inner)
                repeated = stacked([parts.fitted(), *[inner[0]] * WEIGHT])
                found[f"all, these {WEIGHT} times"] = fit_reconstructor(kind, what, repeated, inner[1])
            for name, model in found.items():
                yield Number(f"{kind}: {name}", column, "", rmse(model(judged) - judged.y))


def descended(model: TrainedNetwork, fitted: gd.Samples, checked: gd.Samples) -> TrainedNetwork:
    """A network that goes on from its weights, at a tenth of the rate, on a person's own strides."""
    settings = TrainingSettings(epochs=5, batch=128, learning_rate=1e-3, decays=(0.01,))
    return train(fitted, lambda *_: copy.deepcopy(model.network), settings, check=checked).network


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
                missed = rmse(done(parts.judged()) - parts.judged().y)
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


def spread(quick: bool) -> Iterator[Number]:
    """Coverage and width of 90 % intervals on the test part of a run."""
    walk, told = runner()
    what, parts = parts_of(walk, told, LAGS)
    training = parts.fitted().rows(slice(600)) if quick else parts.fitted()
    done, judged = fit_reconstructor(ENSEMBLE, what, training, parts.checked()), parts.judged()
    half, missed = half_widths(done(parts.checked()) - parts.checked().y), done(judged) - judged.y
    ensemble = done.model
    assert isinstance(ensemble, Ensemble)
    sd, checked = (1.645 * ensemble.spread(each.x) for each in (judged, parts.checked()))
    scaled = sd * np.quantile(np.abs(done(parts.checked()) - parts.checked().y) / checked, 0.9, axis=0)
    for name, width in (("spread of five", sd), ("spread, scaled on the checked part", scaled),
                        ("conformal (the program's)", np.tile(half, (len(judged), 1)))):  # fmt: skip
        for k, channel in enumerate(told):
            inside = coverage((np.abs(missed) / width)[:, [k]], np.ones(1))
            yield Number(name, "covered [%]", channel.name, 100 * float(inside[0]))
            yield Number(name, "half width [deg]", channel.name, float(width[:, k].mean()))
    yield Number("(for scale: RMSE of the mean of five)", "half width [deg]", "", rmse(missed))


def simulated(quick: bool) -> Iterator[Number]:
    """A real walker by models of simulated ones, from right hip, knee and ankle."""
    people = sensed_walks(cohort(GIVEN.folder / "recordings", 3, 24.0), SAGITTAL, "nominal").people
    what = Sensing(SAGITTAL, TOLD, LAGS, 100.0)
    each = [stacked([what.windows(walk.recording, walk.phi) for walk in walks]) for walks in people.values()]
    fitted, checked = stacked(each[:-1]), each[-1]
    real = next(person for person in real_people() if person.name == "S01")
    own = [what.windows(one, np.zeros(len(one.time))) for one in real.recordings]
    parts = split_by_trial(own, [8, 9, 10, 11], what.reach_s)
    judged, few_real = parts.judged(), parts.training[0]
    mean, size = few_real.x.mean(axis=0), few_real.x.std(axis=0)
    moved = replace(judged, x=(judged.x - mean) / size * fitted.x.std(axis=0) + fitted.x.mean(axis=0))
    offset = few_real.y.mean(axis=0)
    for kind in ("delay ridge",) if quick else ("delay ridge", "fourier ridge", "shred"):
        done = fit_reconstructor(kind, what, fitted, checked)
        found = {"as simulated": done(judged), "readings aligned": done(moved)}
        if isinstance(done.model, TrainedNetwork):
            told = done.model.decoded(aligned(latent_states(done, judged), latent_states(done, few_real),
                                              latent_states(done, fitted)))  # fmt: skip
            found["latent states aligned"] = told
        found["linear correction by ten strides' states"] = calibrated(done, few_real.rows(slice(1100)))(judged)
        if kind in WITHOUT_NETWORK:
            found["fitted to the person"] = fit_reconstructor(kind, what, parts.fitted(), parts.checked())(judged)
        for name, values in found.items():
            yield Number(f"{kind}: {name}", "RMSE [deg]", "", rmse(values - judged.y))
            yield Number(
                f"{kind}: {name}",
                "means taken off [deg]",
                "",
                rmse((values - judged.y) - (values - judged.y).mean(axis=0)),
            )
    yield Number("the person's own mean (null)", "RMSE [deg]", "", rmse(offset - judged.y))


def aligned(states: Values, real: Values, simulated_states: Values) -> Values:
    """Latent states with the simulated mean and covariance in place of the real ones (CORAL)."""
    roots = []
    for one in (real, simulated_states):
        values, vectors = np.linalg.eigh(np.cov(one.T) + 1e-4 * np.eye(one.shape[1]))
        roots.append((vectors * np.sqrt(values)) @ vectors.T)
    return (states - real.mean(axis=0)) @ np.linalg.solve(roots[0], roots[1]) + simulated_states.mean(axis=0)


MADE = {
    "few": Made(few, "RMSE of 7 angles [deg], welk007, ten strides known, n = 1 person"),
    "speed": Made(speed, "7 angles, treadmill, one walk left out"),
    "spread": Made(spread, "90 % intervals, runner, split in time, n = 12 angles"),
    "simulated": Made(simulated, "7 angles, S01's last four walks, fitted to simulated walkers"),
}

if __name__ == "__main__":
    main(GIVEN, MADE, Path(__file__).with_suffix(".csv"))
