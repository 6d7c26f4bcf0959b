"""Chapter 5 and 6.2.3 beyond their figures, and what came after them, on real recordings.

    python studies/ch5_further.py [FOLDER] [--tables text latent population ahead turns ...] [--keep] [--quick]
    python studies/ch5_further.py --print TABLE

`text`: SHRED as the dissertation's code has it, beside ours. `latent`: the latent state of Fig. 5.1 beside the states'
modes. `population`: each of ten real people by models of the others. `ahead`: forecasts of running by a model for each
time ahead, and by carrying SHRED's latent state on. `turns`: forecasts of children who turn.

Later methods, each beside what the program does already. `few`: a runner in a condition that no model saw, after ten
strides of it. `speed`: how long a stride lasts, as one more input (parametric models). `spread`: the interval that five
SHREDs' spread gives (UQ-SHRED). `simulated`: models of simulated walkers on a real one (DA-SHRED), with readings or
latent states aligned.
"""

from __future__ import annotations

from pathlib import Path

from command_line import tables_line

TABLES = ("text", "latent", "population", "ahead", "turns", "few", "speed", "spread", "simulated")
GIVEN = tables_line(__name__, __doc__, "ch5_further", TABLES)  # before the slow imports

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd
from ch5_fields import fields
from chapter5.people import SAGITTAL, ahead, few, parts_of, real_people, rmse, runner, simulated, speed, spread, turns
from chapter5.reconstruct_field import reconstruct_field
from chapter5.routes import fixed_at_random
from further import Made, Number, main

from gaitdisc.processing.curves_figure import LATENT, course_numbers, draw_course
from gaitdisc.reconstruction.reconstruct_study import ReconstructionSettings
from gaitdisc.reconstruction.window_model import (
    KINDS,
    OF_TEXT,
    WITHOUT_NETWORK,
    Sensing,
    fit_reconstructor,
    latent_states,
    leading,
)
from gaitdisc.reconstruction.windows import RANDOM, Lags, split_by_subject
from gaitdisc.report.figure import Figure, save_figures
from gaitdisc.report.panels import Room, in_style, legend, panels

MODES = "modes of the states"


def text(quick: bool) -> Iterator[Number]:
    """Each kind on its own windows: ours 25 readings over a second, the text's 100."""
    kinds = (*WITHOUT_NETWORK[1:], OF_TEXT) if quick else (*KINDS, OF_TEXT)
    field, task, _ = next(each for each in fields() if each[1].name.startswith("Pacific"))
    for rule in ("temporal",) if quick else ("temporal", RANDOM):
        route = fixed_at_random(field, 3, 0)
        for one in reconstruct_field(field, route, replace(task, rule=rule), kinds, floors=False):
            yield Number(one.model, f"Pacific, {rule}: R2 [1]", "", one.r2)
            yield Number(one.model, f"Pacific, {rule}: fit [s]", "", one.seconds)
    walk, angles = runner()
    for kind in () if quick else kinds:
        settings = ReconstructionSettings(spacing_s=0.01 if kind == OF_TEXT else 0.04)
        what, parts = parts_of(walk, angles, settings.lags(walk.recording.rate_hz))
        done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
        yield Number(kind, "runner: RMSE [deg]", "", rmse(done(parts.tested()) - parts.tested().y))
        yield Number(kind, "runner: fit [s]", "", done.seconds)


def latent(quick: bool) -> Iterator[Number]:
    """What the leading components of the latent state hold of the states' modes, on windows that were not fitted."""
    walk, angles = runner()
    what, parts = parts_of(walk, angles, Lags(25, 4))
    done = fit_reconstructor("shred", what, parts.fitted().rows(slice(600 if quick else None)), parts.checked())
    windows = parts.tested()
    states, modes = (leading(each, 5) for each in (latent_states(done, windows), windows.y / windows.y.std(axis=0)))
    courses = {word: course_numbers(windows.phi, each[:, :3]) for word, each in ((LATENT, states), (MODES, modes))}
    save_figures([course_figure(courses, "latent-course", "Running, test part, as Fig. 5.1")], GIVEN.folder)
    for count in (1, 2, 3, 5):
        estimated = states[:, :count] @ np.linalg.lstsq(states[:, :count], modes, rcond=None)[0]
        for mode in range(3):
            held = 1 - np.mean((modes[:, mode] - estimated[:, mode]) ** 2)
            yield Number(f"{count} component{'s' * (count > 1)}", f"mode {mode + 1}: R2 [1]", "", float(held))


@in_style
def course_figure(courses: dict[str, pd.DataFrame], name: str, source: str) -> Figure:
    """Draw the latent state and the modes side by side.

    courses: title of each panel -> its `course_numbers`
    """
    drawn, (row,) = panels(1, len(courses), 2.1, Room(across=0.7, top=0.5))
    for axes, (title, numbers) in zip(row, courses.items(), strict=True):
        draw_course(axes, numbers)
        axes.set_title(title)
    legend(drawn, row[0].get_lines())
    caption = (
        f"{source}. Principal components in time, each of standard deviation 1; shaded: standard deviation of 2 %."
    )
    numbers = pd.concat([each.assign(panel=title) for title, each in courses.items()], ignore_index=True)
    return Figure(name, caption, "Components of the latent state and of the states over the stride", numbers, drawn)


def population(quick: bool) -> Iterator[Number]:
    """Each person by models of the others; the next in the list is who they are chosen by."""
    people = real_people()
    what = Sensing(SAGITTAL, tuple(n for n in people[0].recordings[0].names if n not in SAGITTAL), Lags(13, 4), 100.0)
    windows = [person.windows(what.windows) for person in people]
    for place, person in enumerate(people):
        parts = split_by_subject(windows, place)
        test, fitted = parts.tested(), parts.fitted()
        yield Number("mean of the others", person.group, person.name, rmse(fitted.y.mean(axis=0) - test.y))
        for kind in WITHOUT_NETWORK if quick else KINDS:
            missed = fit_reconstructor(kind, what, fitted, parts.checked())(test) - test.y
            yield Number(kind, person.group, person.name, rmse(missed))
            yield Number(f"{kind}, own means known", person.group, person.name, rmse(missed - missed.mean(axis=0)))


MADE = {
    "text": Made(text, "3 sensors; split in time unless said; one fit each"),
    "latent": Made(latent, "SHRED, runner, split in time, n = 1 run"),
    "population": Made(population, "RMSE of 7 angles [deg], one person left out"),
    "ahead": Made(ahead, "RMSE of 12 angles [deg], runner, split in time, n = 1 run"),
    "turns": Made(turns, "RMSE of 10 angles [deg], one child left out", "children"),
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
