"""What came after the dissertation, on real recordings: each method beside what the program does already.

    python studies/ch5_beyond.py [FOLDER] [--tables few speed spread simulated] [--keep] [--quick]
    python studies/ch5_beyond.py --print TABLE

`few`: a runner in a condition that no model saw, after ten strides of it. `speed`: how long a stride lasts, as one more
input (parametric models). `spread`: the interval that five SHREDs' spread gives (UQ-SHRED). `simulated`: models of
simulated walkers on a real one (DA-SHRED), with readings or latent states aligned.
"""

from __future__ import annotations

from pathlib import Path

from command_line import tables_line

TABLES = ("few", "speed", "spread", "simulated")
GIVEN = tables_line(__name__, __doc__, "ch5_beyond", TABLES)  # before the slow imports

import copy
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from chapter5.gait import DATA, exotendon, first_person
from chapter5.people import LAGS, SAGITTAL, TOLD, parts_of, rmse, runner, simulated, speed
from further import Made, Number, main

import gaitdisc as gd
from gaitdisc.models.trained_network import TrainedNetwork
from gaitdisc.models.trainer import train
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.reconstruction.calibration import calibrate, first_strides
from gaitdisc.reconstruction.sensed_walks import SensedWalk, read_walks
from gaitdisc.reconstruction.state_errors import coverage, half_widths
from gaitdisc.reconstruction.window_model import ENSEMBLE, Ensemble, Sensing, fit_reconstructor
from gaitdisc.reconstruction.windows import split_by_trial, stacked

STRIDES, WEIGHT = 10, 10


def few(quick: bool) -> Iterator[Number]:
    """Each condition of one runner by models of the other, then by ten strides."""
    walks = read_walks(first_person(exotendon(DATA)), SAGITTAL)
    both: tuple[SensedWalk, ...] = next(iter(walks.people.values()))
    what = Sensing(SAGITTAL, TOLD, LAGS, walks.rate_hz)
    windows = [what.windows(walk.recording, walk.phi) for walk in both]
    for place, walk in enumerate(both):
        parts = split_by_trial(windows, [place], what.reach_s)
        first = first_strides(parts.test, STRIDES, what.reach_s)
        test, column = parts.tested().rows(first.rest), f"{walk.recording.condition} tested"
        for kind in ("delay ridge", "fourier ridge") if quick else ("delay ridge", "fourier ridge", "shred"):
            done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
            found = {"as it is": done, "linear correction": calibrate(done, first.strides)}
            inner = first.strides.last_block(0.2, what.reach_s)
            if isinstance(done.model, TrainedNetwork):
                found["descended further"] = replace(done, model=descended(done.model, *inner))
            else:
                found["ten strides alone"] = fit_reconstructor(kind, what, *inner)
                repeated = stacked([parts.fitted(), *[inner[0]] * WEIGHT])
                found[f"all, these {WEIGHT} times"] = fit_reconstructor(kind, what, repeated, inner[1])
            for name, model in found.items():
                yield Number(f"{kind}: {name}", column, "", rmse(model(test) - test.y))


def descended(model: TrainedNetwork, fitted: gd.Samples, checked: gd.Samples) -> TrainedNetwork:
    """A network that goes on from its weights, at a tenth of the rate, on a person's own strides."""
    settings = TrainingSettings(epochs=5, batch=128, learning_rate=1e-3, decays=(0.01,))
    return train(fitted, lambda *_: copy.deepcopy(model.network), settings, check=checked).network


def spread(quick: bool) -> Iterator[Number]:
    """Coverage and width of 90 % intervals on the test part of a run."""
    walk, angles = runner()
    what, parts = parts_of(walk, angles, LAGS)
    training = parts.fitted().rows(slice(600)) if quick else parts.fitted()
    done, test = fit_reconstructor(ENSEMBLE, what, training, parts.checked()), parts.tested()
    half, missed = half_widths(done(parts.checked()) - parts.checked().y), done(test) - test.y
    ensemble = done.model
    assert isinstance(ensemble, Ensemble)
    sd, checked = (1.645 * ensemble.spread(each.x) for each in (test, parts.checked()))
    scaled = sd * np.quantile(np.abs(done(parts.checked()) - parts.checked().y) / checked, 0.9, axis=0)
    for name, width in (("spread of five", sd), ("spread, scaled on the checked part", scaled),
                        ("conformal (the program's)", np.tile(half, (len(test), 1)))):  # fmt: skip
        for k, channel in enumerate(angles):
            inside = coverage((np.abs(missed) / width)[:, [k]], np.ones(1))
            yield Number(name, "covered [%]", channel.name, 100 * float(inside[0]))
            yield Number(name, "half width [deg]", channel.name, float(width[:, k].mean()))
    yield Number("(for scale: RMSE of the mean of five)", "half width [deg]", "", rmse(missed))


MADE = {
    "few": Made(few, "RMSE of 7 angles [deg], welk007, ten strides known, n = 1 person"),
    "speed": Made(speed, "7 angles, one person on a treadmill, one walk left out", "walks"),
    "spread": Made(spread, "90 % intervals, one runner, split in time", "angles"),
    "simulated": Made(
        lambda quick: simulated(quick, GIVEN.folder / "recordings"),
        "7 angles, S01's last four walks, fitted to simulated walkers",
    ),
}

if __name__ == "__main__":
    main(GIVEN, MADE, Path(__file__).with_suffix(".csv"))
