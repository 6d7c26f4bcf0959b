"""Chapter 5 and 6.2.3 beyond their figures, on real recordings: the text's own network, real people, forecasts.

    python studies/ch5_further.py [FOLDER] [--tables text latent population ahead turns] [--keep] [--quick]
    python studies/ch5_further.py --print TABLE

`text`: SHRED as the dissertation's code has it, on 100 readings, beside ours: a runner, and a field (12 months).
`latent`: the latent state of Fig. 5.1 beside the states' modes, drawn into FOLDER. `population`: each of ten real
people by models of the others. `ahead`: forecasts of running by a model for each time ahead, and by carrying SHRED's
latent state on (linear, SINDy). `turns`: forecasts of children who turn, by models of the other children.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

TABLES = ("text", "latent", "population", "ahead", "turns")
GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", "a file for each table that was computed, and the figure", Path("ch5_further")),
    argument("--tables", "which of them are computed", list(TABLES)),
    argument("--keep", "write studies/ch5_further.csv as well", False),
    argument("--print", "compute nothing; print this table", "", metavar="TABLE"),
    QUICK,
)  # before the slow imports

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from ch5_fields import fields
from ch5_gait import DATA, SENSORS, exotendon, first_person
from further import Made, Number, main
from numpy.typing import NDArray
from real_people import real_people, turning

import gaitdisc as gd
from gaitdisc.batch.reconstruct_study import ReconstructionSettings
from gaitdisc.batch.sensed_walks import SensedWalk, sensed_walks
from gaitdisc.chapters.fields.reconstruct_field import reconstruct_field
from gaitdisc.chapters.fields.routes import fixed_at_random
from gaitdisc.chapters.regression.sindy import fit_sindy
from gaitdisc.report.figure import save_figures
from gaitdisc.report.latent_course_figure import LATENT, MODES, course_numbers, latent_course_figure
from gaitdisc.sensing.forecast import persistence, phase_average
from gaitdisc.sensing.latent_states import latent_states, leading
from gaitdisc.sensing.reconstructor import KINDS, OF_TEXT, WITHOUT_NETWORK, Reconstructor, Sensing, fit_reconstructor
from gaitdisc.sensing.splits import RANDOM, Parts, split_by_subject, split_within
from gaitdisc.sensing.windows import Lags

SAGITTAL = SENSORS["3 sagittal"]
AHEAD_S, STEP, RANK, SINDY_RANK = (0.04, 0.12, 0.2, 0.4, 0.8), 4, 12, 4
Values = NDArray[np.float64]


def runner() -> tuple[SensedWalk, tuple[gd.Channel, ...]]:
    """A minute of one runner, and the states that no sagittal sensor measures and that are angles."""
    walks = sensed_walks(first_person(exotendon(DATA)), SAGITTAL, "natural")
    told = [channel for channel in walks.channels if channel.unit == "deg" and channel.name not in SAGITTAL]
    return next(iter(walks.people.values()))[0], tuple(told)


def parts_of(walk: SensedWalk, told: tuple[gd.Channel, ...], lags: Lags) -> tuple[Sensing, Parts]:
    """Fitted, checked and tested windows, in time."""
    what = Sensing(SAGITTAL, tuple(channel.name for channel in told), lags, walk.recording.rate_hz)
    return what, split_within([what.windows(walk.recording, walk.phi)], "temporal", what.reach_s)


def rmse(missed: Values) -> float:
    """Over windows and angles [deg]."""
    return float(np.sqrt(np.mean(missed**2)))


def text(quick: bool) -> Iterator[Number]:
    """Each kind on its own windows: ours 25 readings over a second, the text's 100."""
    kinds = (*WITHOUT_NETWORK[1:], OF_TEXT) if quick else (*KINDS, OF_TEXT)
    field, task, _ = next(each for each in fields() if each[1].name.startswith("Pacific"))
    for rule in ("temporal",) if quick else ("temporal", RANDOM):
        for one in reconstruct_field(
            field, fixed_at_random(field, 3, 0), replace(task, rule=rule), kinds, floors=False
        ):
            yield Number(one.model, f"Pacific, {rule}: R2 [1]", "", one.r2)
            yield Number(one.model, f"Pacific, {rule}: fit [s]", "", one.seconds)
    walk, told = runner()
    for kind in () if quick else kinds:
        settings = ReconstructionSettings(spacing_s=0.01 if kind == OF_TEXT else 0.04)
        what, parts = parts_of(walk, told, settings.lags(walk.recording.rate_hz))
        done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
        yield Number(kind, "runner: RMSE [deg]", "", rmse(done(parts.judged()) - parts.judged().y))
        yield Number(kind, "runner: fit [s]", "", done.seconds)


def latent(quick: bool) -> Iterator[Number]:
    """What the leading components of the latent state hold of the states' modes, on windows that were not fitted."""
    walk, told = runner()
    what, parts = parts_of(walk, told, Lags(25, 4))
    done = fit_reconstructor("shred", what, parts.fitted().rows(slice(600 if quick else None)), parts.checked())
    windows = parts.judged()
    states, modes = (leading(each, 5) for each in (latent_states(done, windows), windows.y / windows.y.std(axis=0)))
    courses = {word: course_numbers(windows.phi, each[:, :3]) for word, each in ((LATENT, states), (MODES, modes))}
    save_figures([latent_course_figure(courses, "latent-course", "Running, test part, as Fig. 5.1")], GIVEN.folder)
    for count in (1, 2, 3, 5):
        told_of = states[:, :count] @ np.linalg.lstsq(states[:, :count], modes, rcond=None)[0]
        for mode in range(3):
            held = 1 - np.mean((modes[:, mode] - told_of[:, mode]) ** 2)
            yield Number(f"{count} component{'s' * (count > 1)}", f"mode {mode + 1}: R2 [1]", "", float(held))


def population(quick: bool) -> Iterator[Number]:
    """Each person by models of the others; the next in the list is who they are chosen by."""
    people = real_people()
    what = Sensing(SAGITTAL, tuple(n for n in people[0].recordings[0].names if n not in SAGITTAL), Lags(13, 4), 100.0)
    windows = [person.windows(what.windows) for person in people]
    for place, person in enumerate(people):
        parts = split_by_subject(windows, place)
        judged, fitted = parts.judged(), parts.fitted()
        yield Number("mean of the others", person.group, person.name, rmse(fitted.y.mean(axis=0) - judged.y))
        for kind in WITHOUT_NETWORK if quick else KINDS:
            missed = fit_reconstructor(kind, what, fitted, parts.checked())(judged) - judged.y
            yield Number(kind, person.group, person.name, rmse(missed))
            yield Number(f"{kind}, own means known", person.group, person.name, rmse(missed - missed.mean(axis=0)))


def ahead(quick: bool) -> Iterator[Number]:
    """Errors of every forecast at the times that all of them reach."""
    walk, told = runner()
    what, parts = parts_of(walk, told, Lags(25, 4))
    present = fit_reconstructor("shred", what, parts.fitted().rows(slice(600 if quick else None)), parts.checked())
    carried = {"latent state, linear": linear(present, parts), "latent state, SINDy": sparse(present, parts)}
    for ahead_s in AHEAD_S[::4] if quick else AHEAD_S:
        whole, later = parts_of(walk, told, Lags(25, 4, round(100 * ahead_s)))
        judged, found = later.judged(), {}
        for kind in ("delay ridge", "fourier ridge") if quick else ("delay ridge", "fourier ridge", "shred"):
            found[kind] = fit_reconstructor(kind, whole, later.fitted(), later.checked())(judged)
        found["persistence"] = persistence(later.test, ahead_s)
        found["phase average"] = phase_average(later.training).told(later.test, ahead_s)
        for name, model in carried.items():  # windows of the present that end where these do
            found[name] = model(latent_states(present, judged), round(100 * ahead_s))
        known = np.isfinite(np.hstack(list(found.values()))).all(axis=1) | np.isinf(found["latent state, SINDy"][:, 0])
        for name, values in found.items():
            yield Number(name, f"{ahead_s:g} s", "", rmse((values - judged.y)[known]))


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


MADE = {
    "text": Made(text, "3 sensors; split in time unless said; one fit each"),
    "latent": Made(latent, "SHRED, runner, split in time, n = 1 run"),
    "population": Made(population, "RMSE of 7 angles [deg], one person left out"),
    "ahead": Made(ahead, "RMSE of 12 angles [deg], runner, split in time, n = 1 run"),
    "turns": Made(turns, "RMSE of 10 angles [deg], one child left out"),
}

if __name__ == "__main__":
    main(GIVEN, MADE, Path(__file__).with_suffix(".csv"))
