"""The two gait studies of chapter 5: sensor sets of Table 5.2, walks, disturbances, tables and figures."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from command_line import SHARED
from further import decades
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.channel import vocabulary
from gaitdisc.cohort.demonstration import write_demonstration
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Quality, Study
from gaitdisc.ingest.study_file import load_study
from gaitdisc.reconstruction.page import NOT_MSE
from gaitdisc.reconstruction.reconstruct_study import ReconstructionSettings, reconstruct_study
from gaitdisc.reconstruction.reconstruction import CALIBRATED, mean_over_people
from gaitdisc.reconstruction.sensed_walks import read_walks
from gaitdisc.reconstruction.state_errors import angle_columns
from gaitdisc.reconstruction.window_model import (
    KINDS,
    MASKED,
    OF_TEXT,
    WITHOUT_NETWORK,
    Sensing,
    WindowModel,
    fit_reconstructor,
    sensing,
)
from gaitdisc.reconstruction.windows import Parts, fill_readings, split_within, with_missing
from gaitdisc.report.figure import Figure
from gaitdisc.report.page import Block
from gaitdisc.report.panels import RECONSTRUCTED, Room, draw_box, in_style, legend, legend_lines, panels
from gaitdisc.report.table import Table, save_table
from gaitdisc.words import counted, listing, number, unit_text

SENSORS = {
    "3 random": ("pelvis_rotation", "pelvis_tz", "hip_adduction_r"),
    "3 sagittal": ("hip_flexion_r", "knee_angle_r", "ankle_angle_r"),
    "1 random": ("pelvis_tz",),
    "1 sagittal": ("ankle_angle_r",),
}  # of Table 5.2: "randomly" and "non-randomly chosen"
PRINTED = ["sensors", "model", "mean", "sd"]
NOTHING_PRINTED = pd.DataFrame(columns=pd.Index(PRINTED))
PELVIS = ("3 random", "1 random")  # the embedded cohort has no pelvis, and cannot have these
SAGITTAL = "3 sagittal"
WALK_S, PEOPLE = 60.0, 12
TEXT_SPACING_S = 0.01  # of the 100 readings that the text's network has
DATA = SHARED / "gait"
TREADMILL = range(504, 516)
RUNS = {
    "welk007": {
        "natural": "c3d_Trimmed_running_natural2_manual_scaling_ik.mot",
        "exotendon": "c3d_Trimmed_running_exotendon3_manual_scaling_ik.mot",
    },
    "welk002": {"natural": "welk002"},
}
MEASURES = ("rmse_deg", "relative_l2", "relative_l2_whole", "r2", "coverage", "seconds")
LESS_THAN_NOTHING = (
    "A relative L2 above 1 is worse than estimating zero; the table prints such values for linear and SDN, so its norm "
    "may be of something else than angles about zero. It has no model that sees history without being a network, and "
    "does not say how time was split or how long the history was: no claim of better or worse is made."
)
STEP, PITCH = 0.23, 1.4  # from one box to the next, and from one sensor set to the next
NOISES = (0.0, 0.01, 0.02, 0.05, 0.10)
SHARES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
DISTURBED = ("disturbance", "level", "model", "rmse_deg")
Walks = Sequence[tuple[gd.Recording, NDArray[np.float64]]]  # of one person, with the place in the stride (time,) [%]
AXES = {"noise": "noise of the sensors [% of their standard deviation]", "missing": "missing readings [%]"}


class Wanted(NamedTuple):
    """What is computed, and where it goes."""

    quick: bool
    folder: Path
    data: Path = DATA
    kinds: tuple[str, ...] = tuple(KINDS)
    seeds: int = 1

    def cell(self, study: Study, sensors: str, place: str, **settings: Any) -> dict[str, pd.DataFrame]:
        """Summary and errors of one sensor set in one data set, by seed; what is in the folder is not redone."""
        found, kinds = [], WITHOUT_NETWORK if self.quick else self.kinds
        both = {
            "models": ReconstructionSettings(kinds=tuple(k for k in kinds if k != OF_TEXT), **settings),
            "text": ReconstructionSettings(kinds=(OF_TEXT,), spacing_s=TEXT_SPACING_S, **settings),
        }
        for seed, (name, one) in product(range(self.seeds), both.items()):
            kept = self.folder / place / sensors.replace(" ", "_") / f"{name}-{seed}"
            if not set(one.kinds) & set(kinds):
                continue
            if not (kept / "summary.csv").exists():
                reconstruct_study(study, SENSORS[sensors], replace(one, seed=seed))[0].save(kept)
            found.append({each: pd.read_csv(kept / f"{each}.csv").assign(seed=seed) for each in ("summary", "errors")})
        return {each: pd.concat([one[each] for one in found]).assign(sensors=sensors) for each in ("summary", "errors")}


def printed(kind: str) -> pd.DataFrame:
    """Values of Table 5.2: sensors, model, mean, sd."""
    rows = tomllib.loads((Path(__file__).parents[1] / "ch5_printed.toml").read_text(encoding="utf-8"))["row"]
    models = ("shred", "shallow decoder", "linear")
    found = [(row["sensors"], model, *row[model]) for row in rows if row["kind"] == kind for model in models]
    return pd.DataFrame(found, columns=pd.Index(PRINTED))


def first_person(study: Study) -> Study:
    """The study with its first participant alone."""
    return study.model_copy(update={"participants": study.participants[:1]}).placed(study.folder)


def cohort(folder: Path, people: int = PEOPLE, walk_s: float = WALK_S) -> Study:
    """The embedded cohort, walking; ten joint angles, no pelvis and no trunk."""
    if not (folder / "study.toml").exists():
        write_demonstration(folder, walk_s, people)
    return load_study(folder)


def treadmill(data: Path, folder: Path) -> Study:
    """One person of treadmill_walk_ik, twelve walks of 21 s, all 18 states."""
    folder.mkdir(parents=True, exist_ok=True)
    with np.load(data / "treadmill_walk_ik" / "addbio_expert3_ik.npz") as packed:
        named = [vocabulary().named(str(name)) for name in packed["columns"]]
        kept, channels = zip(*((k, channel) for k, channel in enumerate(named) if channel), strict=True)
        for number in TREADMILL:
            values = np.asarray(packed[f"S01DE{number}"], float)[:, kept]
            gd.write(gd.Recording(np.arange(len(values)) / 100.0, values, channels), folder / f"{number}.mot")
    trials = tuple(PlannedTrial(condition="walk", files=(f"{number}.mot",)) for number in TREADMILL)
    return _study("treadmill_walk_ik", ("walk", "none"), (Participant(id="S01", trials=trials),)).placed(folder)


def exotendon(data: Path) -> Study:
    """Two runners of exotendon_run, one of them without and with the device."""
    folder = data / "exotendon_run"
    found = {path.name: path.relative_to(folder) for path in sorted(folder.rglob("*.mot"))}
    found["welk002"] = next(path for path in found.values() if path.parts[0] == "welk002")
    people = []
    for who, runs in RUNS.items():
        trials = tuple(PlannedTrial(condition=word, files=(str(found[name]),)) for word, name in runs.items())
        people.append(Participant(id=who, trials=trials))
    return _study("exotendon_run", ("natural", "exotendon"), tuple(people)).placed(folder)


def _study(title: str, words: tuple[str, str], people: tuple[Participant, ...]) -> Study:
    both = Conditions(nominal=words[0], device=words[1])
    return Study(title=title, conditions=both, participants=people, quality=Quality(late_change="report"))


def walkers(wanted: Wanted) -> dict[str, Study]:
    """Who walked, by name."""
    recordings = wanted.folder / "recordings"
    if wanted.quick:
        return {"cohort": cohort(recordings, 1, 30.0)}
    found = {"cohort": cohort(recordings)}
    if wanted.data.is_dir():
        found["treadmill_walk_ik"] = treadmill(wanted.data, wanted.folder / "treadmill")
        found["exotendon_run"] = exotendon(wanted.data)
    return found


def sensor_sets_table(summary: pd.DataFrame, printed: pd.DataFrame, name: str, rule: str) -> Table:
    """One row a data set, sensor set and model: n people, of each of whom the seeds' mean is taken.

    summary: `summary` of reconstructions, with columns `data`, `sensors` and `seed`
    printed: sensors, model, mean, sd: of the dissertation
    """
    found = []
    for keys, own in summary.groupby(["data", "sensors", "model"], sort=False):
        people, seeds = (own.groupby(by)[list(MEASURES)].mean() for by in ("participant", "seed"))
        found.append(dict(zip(("data", "sensors", "model"), keys, strict=True)) | {"n": len(people)})
        found[-1] |= {"seeds": len(seeds), "least": seeds["rmse_deg"].min(), "greatest": seeds["rmse_deg"].max()}
        for measure in MEASURES:
            mean, sd, half = mean_over_people(people[measure].to_numpy(float))
            found[-1] |= {measure: mean, f"{measure}_sd": sd}
            found[-1] |= {f"{measure}_low": mean - half, f"{measure}_high": mean + half}
    numbers = pd.DataFrame(found)
    numbers["of_text"] = numbers["model"].replace(OF_TEXT, "shred")
    numbers = numbers.merge(printed.rename(columns={"model": "of_text"}), "left", ["sensors", "of_text"])
    rows: Any = numbers.itertuples()
    cells = tuple(
        (str(row.data), str(row.sensors), str(row.model), str(row.n), *_measures(row), f"{row.seconds:.2f}")
        for row in rows
    )
    columns = (
        "data", "sensors", "model", "n", "RMSE [deg]", "its seeds", "relative L2 [1]", "R² [1]",
        "relative L2 with sensors ± sd [1]", "printed “MSE” ± sd", "fit [s]",
    )  # fmt: skip
    caption = (
        f"Mean over n participants [95 % interval of the mean, from three participants], angles that no sensor "
        f"measures; its seeds: least and greatest mean of a seed, and how many seeds; R²: median of the angles. Split: "
        f"{rule}. {NOT_MSE} {LESS_THAN_NOTHING}"
    )
    return Table(name, caption, columns, cells, numbers)


def _measures(row: Any) -> tuple[str, ...]:
    low, high, found = row.rmse_deg_low, row.rmse_deg_high, number(row.rmse_deg, 2)
    interval = f" [{number(low, 2)}, {number(high, 2)}]" if np.isfinite(low) else ""
    whole, printed = _with_sd(row.relative_l2_whole, row.relative_l2_whole_sd), _with_sd(row.mean, row.sd)
    seeds = f"{number(row.least, 2)} to {number(row.greatest, 2)}, {row.seeds}" if row.seeds > 1 else "1"
    return found + interval, seeds, number(row.relative_l2, 3), number(row.r2, 3), whole, printed


def _with_sd(mean: float, sd: float) -> str:
    if not np.isfinite(mean):
        return "–"
    return number(mean, 3) + (f" ± {number(sd, 3)}" if np.isfinite(sd) else "")


def calibration_sentences(table: pd.DataFrame) -> list[str]:
    """What ten strides of a new person take off the error, by model and sensor set."""
    said = []
    for sensors, own in table.groupby("sensors", sort=False):
        rmse = own.groupby("model")["rmse_deg"].mean()
        pairs = [(model, rmse[model], rmse.get(CALIBRATED.format(model))) for model in KINDS if model in rmse]
        words = [f"{n} {a:.2f} to {b:.2f} deg ({100 * (b / a - 1):+.0f} %)" for n, a, b in pairs if b is not None]
        said.append(f"{sensors}, by ten strides: {', '.join(words)}.")
    return said


@in_style
def sensor_sets_figure(errors: pd.DataFrame, data: str, name: str, rule: str) -> Figure:
    """One panel a unit, one group of boxes a sensor set, one box a model.

    errors: `errors` of reconstructions, with a column `sensors`
    """
    shown = errors[errors["model"].isin(list(RECONSTRUCTED))]
    units = [unit for unit in ("deg", "m") if (shown["unit"] == unit).any()]
    models = [model for model in RECONSTRUCTED if (shown["model"] == model).any()]
    drawn, grid = panels(1, len(units), 2.3, Room(left=0.6, across=0.7, bottom=0.5))
    for axes, unit in zip(grid[0], units, strict=True):
        rows = shown[(shown["unit"] == unit) & np.isfinite(shown["rmse"])]
        sets = list(dict.fromkeys(shown.loc[shown["unit"] == unit, "sensors"]))
        for (sensors, model), own in rows.groupby(["sensors", "model"], sort=False):
            at = PITCH * sets.index(sensors) + STEP * (models.index(str(model)) - (len(models) - 1) / 2)
            draw_box(axes, own["rmse"].to_numpy(float), at, RECONSTRUCTED[str(model)].colour)
        decades(axes)
        axes.set_xticks([PITCH * place for place in range(len(sets))], sets)
        axes.set_xlim(-PITCH / 2, PITCH * (len(sets) - 0.5))
        axes.set_ylabel(f"RMSE of a state [{unit_text(unit)}]")
    legend(drawn, legend_lines({model: {"color": RECONSTRUCTED[model].colour} for model in models}))
    people = shown["participant"].nunique()
    caption = (
        f"{data}, n = {counted(people, 'participant')}: RMSE of every state that no sensor measures, by sensor set and "
        f"model; a box over participants and states, median and quartiles, whiskers to the smallest and the largest. "
        f"Split: {rule}. Note the logarithmic axis, and that angles and translations have one each."
    )
    alt = f"Boxes of the error of {listing(models)} for {counted(shown['sensors'].nunique(), 'sensor set')}."
    kept = ["sensors", "participant", "model", "state", "unit", "rmse"]
    return Figure(name, caption, alt, shown[kept], drawn)


def disturbed(study: Study, folder: Path, quick: bool) -> Block:
    """Noise and missing readings, for the first person of the cohort."""
    file, person = folder / "disturbed.csv", study.participants[0].id
    if not file.exists():
        kinds = WITHOUT_NETWORK if quick else tuple(KINDS)
        walks = read_walks(study, SENSORS[SAGITTAL], "nominal")
        names = tuple(channel.name for channel in walks.channels)
        what = sensing(names, SENSORS[SAGITTAL], ReconstructionSettings().lags(walks.rate_hz), walks.rate_hz)
        channels = [channel for channel in walks.channels if channel.name in what.states]
        own = [(walk.recording, walk.phi) for walk in walks.people[person]]
        masked = (MASKED,) if "shred" in kinds else ()
        missing = against_missing(own, what, channels, (*kinds, *masked))
        rows = [*against_noise(own, what, channels, kinds), *missing]
        save_table(pd.DataFrame(rows, columns=pd.Index(DISTURBED)), file)
    figure = disturbance_figure(pd.read_csv(file), f"{person}, {SAGITTAL} sensors")
    return Block("disturbed", "Noise and missing readings", (), (figure,))


def noisy(recording: gd.Recording, sensors: Sequence[str], share: float, seed: int) -> gd.Recording:
    """Add white noise to the readings of the sensors, and to nothing else.

    share: standard deviation of the noise, by that of the sensor in this trial
    """
    rng = np.random.default_rng(seed)
    values = recording.values.copy()
    for name in sensors:
        column = recording.index(name)
        values[:, column] += share * np.nanstd(values[:, column]) * rng.standard_normal(len(values))
    return recording.with_values(values)


def against_noise(walks: Walks, what: Sensing, channels: Sequence[gd.Channel], kinds: Sequence[str]) -> Iterator[tuple]:
    """RMSE of every kind of model against noise, temporal split; fitted to and tested on the same noise.

    returns: disturbance (`noise`), level [share of the sensor's standard deviation], model, rmse_deg (angles)
    """
    for level in NOISES:
        parts = _disturbed_parts(walks, what, lambda walk, k, level=level: noisy(walk, what.sensors, level, k))
        for kind in kinds:
            done = fit_reconstructor(kind, what, parts.fitted(), parts.checked(), 0)
            yield "noise", level, kind, _rmse(done, parts.tested(), channels)


def against_missing(
    walks: Walks, what: Sensing, channels: Sequence[gd.Channel], kinds: Sequence[str]
) -> Iterator[tuple]:
    """RMSE of every kind of model against missing readings, temporal split; fitted to walks that lack none.

    Readings are lost one by one, each sensor by itself. The sensor's last known reading stands in their place; the
    masked SHRED alone is given which are missing.

    returns: disturbance (`missing`), level [share of the readings], model, rmse_deg (angles)
    """
    parts = _disturbed_parts(walks, what, lambda walk, _: walk)
    fitted = {kind: fit_reconstructor(kind, what, parts.fitted(), parts.checked(), 0) for kind in kinds}
    for level in SHARES:
        for kind, done in fitted.items():

            def lost(walk: gd.Recording, k: int, done: WindowModel = done, level: float = level) -> gd.Recording:
                holed = with_missing(walk, what.sensors, level, 0.0, k)
                return holed if done.kind == MASKED else fill_readings(holed, what.sensors, "last", done.sensor_means)

            test = _disturbed_parts(walks, what, lost).tested()
            yield "missing", level, kind, _rmse(done, test, channels)


def _disturbed_parts(walks: Walks, what: Sensing, disturbed: Callable[[gd.Recording, int], gd.Recording]) -> Parts:
    windows = [what.windows(disturbed(walk, k), phi, missing=True) for k, (walk, phi) in enumerate(walks)]
    return split_within(windows, "temporal", what.reach_s)


def _rmse(done: WindowModel, test: gd.Samples, channels: Sequence[gd.Channel]) -> float:
    return float(np.sqrt(np.mean((done(test) - test.y)[:, angle_columns(channels)] ** 2)))


@in_style
def disturbance_figure(found: pd.DataFrame, whose: str) -> Figure:
    """One panel a disturbance, one line a model.

    found: disturbance, level, model, rmse_deg
    """
    kinds = [word for word in AXES if (found["disturbance"] == word).any()]
    models = list(dict.fromkeys(found["model"]))
    drawn, grid = panels(1, len(kinds), 2.1, Room(left=0.6, across=0.6))
    for axes, kind in zip(grid[0], kinds, strict=True):
        for model, rows in found[found["disturbance"] == kind].groupby("model", sort=False):
            axes.plot(100 * rows["level"], rows["rmse_deg"], linewidth=1.1, **_look(str(model)))
        axes.set(xlabel=AXES[kind], ylabel="RMSE [deg]")
        decades(axes)
    legend(drawn, legend_lines({model: _look(model) for model in models}))
    caption = (
        f"{whose}: RMSE of the angles that no sensor measures, temporal split. Left: white noise on the sensors, in "
        f"the fitted and the test part alike. Right: readings lost one by one in the test part; models were "
        f"fitted to walks that lack none, the last known reading stands for a lost one, and masked shred is "
        f"given which are lost."
    )
    return Figure("disturbed", caption, f"Error of {listing(models)} against noise and missing readings.", found, drawn)


def _look(model: str) -> dict[str, Any]:
    look = RECONSTRUCTED[model]
    return {"color": look.colour, "linestyle": look.line, "marker": look.mark, "markersize": 3}
