"""Real people on one convention, a runner in windows, and what is forecast or carried over from others."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from chapter3.record import rk4_step
from chapter3.sindy import fit_sindy
from further import Number
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.models.trained_network import TrainedNetwork
from gaitdisc.models.trainer import train
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.reconstruction.calibration import calibrate, first_strides
from gaitdisc.reconstruction.reconstruct import persistence, phase_average
from gaitdisc.reconstruction.sensed_walks import SensedWalk, read_walks
from gaitdisc.reconstruction.state_errors import coverage, half_widths
from gaitdisc.reconstruction.window_model import (
    ENSEMBLE,
    WITHOUT_NETWORK,
    Ensemble,
    Sensing,
    WindowModel,
    fit_reconstructor,
    latent_states,
)
from gaitdisc.reconstruction.windows import Lags, Parts, split_by_subject, split_by_trial, split_within, stacked

from .gait import DATA, RUNS, SENSORS, TREADMILL, cohort, exotendon, first_person

JOINTS = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
ANGLES = tuple(f"{joint}_{side}" for side in "rl" for joint in JOINTS)
CUTOFF_HZ, RATE_HZ = 6.0, 100
MOST_WINDOWS = 600  # of one person: as many as a long walk has would outweigh everybody else
SAGITTAL = SENSORS["3 sagittal"]
TOLD = tuple(name for name in ANGLES if name not in SAGITTAL)  # of the angles that every real person has
LAGS = Lags(25, 4)
Values = NDArray[np.float64]
AHEAD_S, STEP, RANK, SINDY_RANK = (0.04, 0.12, 0.2, 0.4, 0.8), 4, 12, 4
STRIDES, WEIGHT = 10, 10  # of a person whom no model saw


@dataclass(frozen=True, eq=False)
class Person:
    """One person's walks, low-passed; `group` is what was walked."""

    name: str
    group: str
    recordings: tuple[gd.Recording, ...]

    def windows(self, windows_of: Callable[[gd.Recording, np.ndarray], gd.Samples]) -> list[gd.Samples]:
        """Windows of every walk, thinned evenly to as many as a person may have."""
        every = [windows_of(one, np.zeros(len(one.time))) for one in self.recordings]
        step = max(1, -(-sum(len(each) for each in every) // MOST_WINDOWS))
        return [each.rows(slice(None, None, step)) for each in every]


def angles(path: Path) -> gd.Recording:
    """Ten angles of a file, low-passed, at 100 Hz."""
    read = gd.read(path).stream("kinematics").selected(ANGLES)
    low = gd.lowpass(read, CUTOFF_HZ)
    every = round(low.rate_hz / RATE_HZ)
    return gd.Recording(low.time[::every], low.values[::every], low.channels)


def turning() -> list[Person]:
    """Six children, each a straight walk and a turn of one or two strides."""
    folder = DATA / "young_straight_and_turn"
    people = sorted(path for path in folder.iterdir() if path.is_dir())
    both = [[next((person / way).glob("*.c3d")) for way in ("straight", "turn")] for person in people]
    return [Person(p.name, "straight", tuple(map(angles, files))) for p, files in zip(people, both, strict=True)]


def real_people() -> list[Person]:
    """Eight who walk (six children, straight on) and two who run."""
    children = [Person(each.name, "walking, children", each.recordings[:1]) for each in turning()]
    with np.load(DATA / "treadmill_walk_ik" / "addbio_expert3_ik.npz") as packed:
        kept = [list(packed["columns"]).index(name) for name in ANGLES]
        channels = tuple(children[0].recordings[0].channels)
        walks = [np.asarray(packed[f"S01DE{number}"], float)[:, kept] for number in TREADMILL]
    belt = tuple(gd.lowpass(gd.Recording(np.arange(len(v)) / RATE_HZ, v, channels), CUTOFF_HZ) for v in walks)
    moco = angles(DATA / "opensim_walks" / "moco_3dwalking" / "coordinates.sto")
    runs = DATA / "exotendon_run"
    first = angles(runs / RUNS["welk007"]["natural"]), angles(runs / "welk002" / "manual_ik.mot")
    adults = [Person("S01", "walking, adults", belt), Person("moco", "walking, adults", (moco,))]
    return [*children, *adults, *(Person(n, "running", (one,)) for n, one in zip(RUNS, first, strict=True))]


def runner() -> tuple[SensedWalk, tuple[gd.Channel, ...]]:
    """A minute of one runner, and the states that no sagittal sensor measures and that are angles."""
    walks = read_walks(first_person(exotendon(DATA)), SAGITTAL, "natural")
    angles = [channel for channel in walks.channels if channel.unit == "deg" and channel.name not in SAGITTAL]
    return next(iter(walks.people.values()))[0], tuple(angles)


def parts_of(walk: SensedWalk, angles: tuple[gd.Channel, ...], lags: Lags) -> tuple[Sensing, Parts]:
    """Fitted, checked and tested windows, in time."""
    what = Sensing(SAGITTAL, tuple(channel.name for channel in angles), lags, walk.recording.rate_hz)
    return what, split_within([what.windows(walk.recording, walk.phi)], "temporal", what.reach_s)


def rmse(missed: Values) -> float:
    """Over windows and angles [deg]."""
    return float(np.sqrt(np.mean(missed**2)))


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


def components(done: WindowModel, parts: Parts, rank: int) -> tuple[Values, Values, Values]:
    """Mean latent state, its first directions, and the fitted part's course along them (time, component)."""
    states = latent_states(done, parts.training[0])
    mean = states.mean(axis=0)
    axes = np.linalg.svd(states - mean, full_matrices=False)[2][:rank].T
    return mean, axes, (states - mean) @ axes


def linear(done: WindowModel, parts: Parts) -> Callable[[Values, int], Values]:
    """Carry the latent state on by the linear map of one step."""
    mean, axes, course = components(done, parts, RANK)
    step = np.linalg.lstsq(course[:-STEP], course[STEP:], rcond=None)[0]
    decoded = partial(getattr(done.model, "decoded"))  # noqa: B009
    return lambda states, n: decoded(mean + (states - mean) @ axes @ np.linalg.matrix_power(step, n // STEP) @ axes.T)


def sparse(done: WindowModel, parts: Parts) -> Callable[[Values, int], Values]:
    """Carry the latent state on by sparse equations of its first components, by Runge-Kutta steps of 0.01 s."""
    mean, axes, course = components(done, parts, SINDY_RANK)
    names = tuple(f"z{k + 1}" for k in range(SINDY_RANK))
    time, rates = parts.training[0].time, np.gradient(course, 0.01, axis=0)
    rate = fit_sindy(gd.Samples(course, rates, names, tuple(f"d({n})/dt" for n in names), time, 0 * time), degree=2)

    def carried(states: Values, n: int) -> Values:
        z = (states - mean) @ axes
        for _ in range(n):
            z = rk4_step(rate, z, 0.01)
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


def speed(quick: bool) -> Iterator[Number]:
    """Every walk by models of the others, without and with the duration of its strides."""
    walker = next(person for person in real_people() if person.name == "S01")
    plain = Sensing(SAGITTAL, TOLD, LAGS, 100.0)
    windows = [plain.windows(one, np.zeros(len(one.time))).rows(slice(None, None, 4)) for one in walker.recordings]
    given = [with_duration(*each) for each in zip(windows, walker.recordings, strict=True)]
    for kind in ("delay ridge",) if quick else ("delay ridge", "fourier ridge"):
        for name, each in (("", windows), ("stride's duration given", given)):
            what = replace(plain, sensors=(*SAGITTAL, "stride_s") if name else SAGITTAL)
            for place in range(len(each)):
                parts = split_by_trial(each, [place], plain.reach_s)
                done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
                missed = rmse(done(parts.tested()) - parts.tested().y)
                yield Number(f"{kind}, {name}".strip(", "), "RMSE [deg]", f"walk {place + 1}", missed)


def with_duration(windows: gd.Samples, walk: gd.Recording) -> gd.Samples:
    """Windows whose every reading has the stride's duration beside it: the knee's period, by its autocorrelation."""
    knee = walk["knee_angle_r"] - walk["knee_angle_r"].mean()
    lasts = float(50 + np.argmax(np.correlate(knee, knee, "full")[len(knee) - 1 :][50:200])) / 100
    x = windows.x.reshape(len(windows), -1, len(SAGITTAL))
    x = np.concatenate([x, np.full((*x.shape[:2], 1), lasts)], axis=2).reshape(len(windows), -1)
    names = tuple(f"{k} {name}" for k in range(LAGS.count) for name in (*SAGITTAL, "stride_s"))
    return replace(windows, x=x, inputs=names)


def simulated(quick: bool, recordings: Path) -> Iterator[Number]:
    """A real walker by models of simulated ones, from right hip, knee and ankle."""
    people = read_walks(cohort(recordings, 3, 24.0), SAGITTAL, "nominal").people
    what = Sensing(SAGITTAL, TOLD, LAGS, 100.0)
    each = [stacked([what.windows(walk.recording, walk.phi) for walk in walks]) for walks in people.values()]
    fitted, checked = stacked(each[:-1]), each[-1]
    real = next(person for person in real_people() if person.name == "S01")
    own = [what.windows(one, np.zeros(len(one.time))) for one in real.recordings]
    parts = split_by_trial(own, [8, 9, 10, 11], what.reach_s)
    test, few_real = parts.tested(), parts.training[0]
    mean, size = few_real.x.mean(axis=0), few_real.x.std(axis=0)
    moved = replace(test, x=(test.x - mean) / size * fitted.x.std(axis=0) + fitted.x.mean(axis=0))
    for kind in ("delay ridge",) if quick else ("delay ridge", "fourier ridge", "shred"):
        done = fit_reconstructor(kind, what, fitted, checked)
        found = {"as simulated": done(test), "readings aligned": done(moved)}
        if isinstance(done.model, TrainedNetwork):
            # with the simulated mean and covariance in place of the real ones (CORAL)
            states, own, others = (latent_states(done, each) for each in (test, few_real, fitted))
            roots = []
            for one in (own, others):
                values, vectors = np.linalg.eigh(np.cov(one.T) + 1e-4 * np.eye(one.shape[1]))
                roots.append((vectors * np.sqrt(values)) @ vectors.T)
            states = (states - own.mean(axis=0)) @ np.linalg.solve(*roots) + others.mean(axis=0)
            found["latent states aligned"] = done.model.decoded(states)
        found["linear correction by ten strides' states"] = calibrate(done, few_real.rows(slice(1100)))(test)
        if kind in WITHOUT_NETWORK:
            found["fitted to the person"] = fit_reconstructor(kind, what, parts.fitted(), parts.checked())(test)
        for name, values in found.items():
            missed, row = values - test.y, f"{kind}: {name}"
            yield Number(row, "RMSE [deg]", "", rmse(missed))
            yield Number(row, "means taken off [deg]", "", rmse(missed - missed.mean(axis=0)))
    yield Number("the person's own mean (null)", "RMSE [deg]", "", rmse(few_real.y.mean(axis=0) - test.y))


def few(quick: bool) -> Iterator[Number]:
    """Each condition of one runner by models of the other, then by ten strides."""
    walks = read_walks(first_person(exotendon(DATA)), SAGITTAL)
    both: tuple[SensedWalk, ...] = next(iter(walks.people.values()))
    what = Sensing(SAGITTAL, TOLD, LAGS, walks.rate_hz)
    windows = [what.windows(walk.recording, walk.phi) for walk in both]
    for place, walk in enumerate(both):
        parts = split_by_trial(windows, [place], what.reach_s)
        strides, rest = first_strides(parts.test, STRIDES, what.reach_s)
        test, column = parts.tested().rows(rest), f"{walk.recording.condition} tested"
        for kind in ("delay ridge", "fourier ridge") if quick else ("delay ridge", "fourier ridge", "shred"):
            done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
            found = {"as it is": done, "linear correction": calibrate(done, strides)}
            inner = strides.last_block(0.2, what.reach_s)
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
