"""The two gait studies of chapter 5: sensor sets of Table 5.2, walks, disturbances, tables and figures."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from command_line import SHARED
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc import Channel, Recording, Samples
from gaitdisc.channel import vocabulary
from gaitdisc.cohort.demonstration import write_demonstration
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Quality, Study
from gaitdisc.ingest.study_file import load_study
from gaitdisc.reconstruction.page import NOT_MSE, write_reconstruction_report
from gaitdisc.reconstruction.reconstruct_study import ReconstructionSettings, reconstruct_study
from gaitdisc.reconstruction.reconstruction import mean_over_people
from gaitdisc.reconstruction.state_errors import angle_columns
from gaitdisc.reconstruction.window_model import MASKED, Sensing, WindowModel, fit_reconstructor
from gaitdisc.reconstruction.windows import Parts, fill_readings, split_within, with_missing
from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import RECONSTRUCTED, Room, decades, draw_box, in_style, legend, panels
from gaitdisc.report.table import Table
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
WALK_S, PEOPLE = 60.0, 12
DATA = SHARED / "gait"
TREADMILL = range(504, 516)
RUNS = {
    "welk007": {
        "natural": "c3d_Trimmed_running_natural2_manual_scaling_ik.mot",
        "exotendon": "c3d_Trimmed_running_exotendon3_manual_scaling_ik.mot",
    },
    "welk002": {"natural": "welk002"},
}
NOISES = (0.0, 0.01, 0.02, 0.05, 0.10)
SHARES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
DISTURBED = ("disturbance", "level", "model", "rmse_deg")
Walks = Sequence[tuple[Recording, NDArray[np.float64]]]  # of one person, with the place in the stride (time,) [%]
MEASURES = ("rmse_deg", "relative_l2", "relative_l2_whole", "r2", "coverage", "seconds")
LESS_THAN_NOTHING = (
    "A relative L2 above 1 is worse than estimating zero; the table prints such values for linear and SDN, so its norm "
    "may be of something else than angles about zero. It has no model that sees history without being a network, and "
    "does not say how time was split or how long the history was: no claim of better or worse is made."
)
STEP, PITCH = 0.23, 1.4  # from one box to the next, and from one sensor set to the next
AXES = {"noise": "noise of the sensors [% of their standard deviation]", "missing": "missing readings [%]"}


@dataclass(frozen=True, eq=False)
class Result:
    """One of the two studies."""

    table: pd.DataFrame
    page: Path


def printed(kind: str) -> pd.DataFrame:
    """Values of Table 5.2: sensors, model, mean, sd."""
    rows = tomllib.loads((Path(__file__).parents[1] / "ch5_printed.toml").read_text(encoding="utf-8"))["row"]
    models = ("shred", "shallow decoder", "linear")
    found = [(row["sensors"], model, *row[model]) for row in rows if row["kind"] == kind for model in models]
    return pd.DataFrame(found, columns=pd.Index(PRINTED))


def cell(study: Study, sensors: str, settings: ReconstructionSettings, folder: Path) -> dict[str, pd.DataFrame]:
    """Summary and errors of one sensor set in one data set, with their report; what is in the folder is not redone."""
    if not (folder / "report.html").exists():
        done, _ = reconstruct_study(study, SENSORS[sensors], settings)
        done.save(folder)
        write_reconstruction_report(done, folder)
    return {name: pd.read_csv(folder / f"{name}.csv").assign(sensors=sensors) for name in ("summary", "errors")}


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


def noisy(recording: Recording, sensors: Sequence[str], share: float, seed: int) -> Recording:
    """Add white noise to the readings of the sensors, and to nothing else.

    share: standard deviation of the noise, by that of the sensor in this trial
    """
    rng = np.random.default_rng(seed)
    values = recording.values.copy()
    for name in sensors:
        column = recording.index(name)
        values[:, column] += share * np.nanstd(values[:, column]) * rng.standard_normal(len(values))
    return recording.with_values(values)


def against_noise(walks: Walks, what: Sensing, channels: Sequence[Channel], kinds: Sequence[str]) -> pd.DataFrame:
    """RMSE of every kind of model against noise, temporal split; fitted to and tested on the same noise.

    returns: disturbance (`noise`), level [share of the sensor's standard deviation], model, rmse_deg (angles)
    """
    rows = []
    for level in NOISES:
        parts = _disturbed_parts(walks, what, lambda walk, k, level=level: noisy(walk, what.sensors, level, k))
        for kind in kinds:
            done = fit_reconstructor(kind, what, parts.fitted(), parts.checked(), 0)
            rows.append(("noise", level, kind, _rmse(done, parts.tested(), channels)))
    return pd.DataFrame(rows, columns=pd.Index(DISTURBED))


def against_missing(walks: Walks, what: Sensing, channels: Sequence[Channel], kinds: Sequence[str]) -> pd.DataFrame:
    """RMSE of every kind of model against missing readings, temporal split; fitted to walks that lack none.

    Readings are lost one by one, each sensor by itself. The sensor's last known reading stands in their place; the
    masked SHRED alone is given which are missing.

    returns: disturbance (`missing`), level [share of the readings], model, rmse_deg (angles)
    """
    parts = _disturbed_parts(walks, what, lambda walk, _: walk)
    fitted = {kind: fit_reconstructor(kind, what, parts.fitted(), parts.checked(), 0) for kind in kinds}
    rows = []
    for level in SHARES:
        for kind, done in fitted.items():

            def lost(walk: Recording, k: int, done: WindowModel = done, level: float = level) -> Recording:
                holed = with_missing(walk, what.sensors, level, 0.0, k)
                return holed if done.kind == MASKED else fill_readings(holed, what.sensors, "last", done.sensor_means)

            test = _disturbed_parts(walks, what, lost).tested()
            rows.append(("missing", level, kind, _rmse(done, test, channels)))
    return pd.DataFrame(rows, columns=pd.Index(DISTURBED))


def _disturbed_parts(walks: Walks, what: Sensing, disturbed: Callable[[Recording, int], Recording]) -> Parts:
    windows = [what.windows(disturbed(walk, k), phi, missing=True) for k, (walk, phi) in enumerate(walks)]
    return split_within(windows, "temporal", what.reach_s)


def _rmse(done: WindowModel, test: Samples, channels: Sequence[Channel]) -> float:
    return float(np.sqrt(np.mean((done(test) - test.y)[:, angle_columns(channels)] ** 2)))


def sensor_sets_table(summary: pd.DataFrame, printed: pd.DataFrame, name: str, rule: str) -> Table:
    """One row a data set, sensor set and model.

    summary: `summary` of reconstructions, with columns `data` and `sensors`
    printed: sensors, model, mean, sd: of the dissertation
    """
    found = []
    for keys, own in summary.groupby(["data", "sensors", "model"], sort=False):
        found.append(dict(zip(("data", "sensors", "model"), keys, strict=True)) | {"n": len(own)})
        for measure in MEASURES:
            mean, sd, half = mean_over_people(own[measure].to_numpy(float))
            found[-1] |= {measure: mean, f"{measure}_sd": sd}
            found[-1] |= {f"{measure}_low": mean - half, f"{measure}_high": mean + half}
    numbers = pd.DataFrame(found).merge(printed, "left", ["sensors", "model"])
    rows: Any = numbers.itertuples()
    cells = tuple(
        (str(row.data), str(row.sensors), str(row.model), str(row.n), *_measures(row), f"{row.seconds:.2f}")
        for row in rows
    )
    columns = (
        "data", "sensors", "model", "n", "RMSE [deg]", "relative L2 [1]", "R² [1]", "relative L2 with sensors ± sd [1]",
        "printed “MSE” ± sd", "fit [s]",
    )  # fmt: skip
    caption = (
        f"Mean over participants [95 % interval of the mean, from three participants], angles that no sensor measures; "
        f"R²: median of the angles. Split: {rule}. {NOT_MSE} {LESS_THAN_NOTHING}"
    )
    return Table(name, caption, columns, cells, numbers)


def _measures(row: Any) -> tuple[str, ...]:
    low, high, found = row.rmse_deg_low, row.rmse_deg_high, number(row.rmse_deg, 2)
    interval = f" [{number(low, 2)}, {number(high, 2)}]" if np.isfinite(low) else ""
    whole, printed = _with_sd(row.relative_l2_whole, row.relative_l2_whole_sd), _with_sd(row.mean, row.sd)
    return found + interval, number(row.relative_l2, 3), number(row.r2, 3), whole, printed


def _with_sd(mean: float, sd: float) -> str:
    if not np.isfinite(mean):
        return "–"
    return number(mean, 3) + (f" ± {number(sd, 3)}" if np.isfinite(sd) else "")


@in_style
def sensor_sets_figure(errors: pd.DataFrame, data: str, name: str, rule: str) -> Figure:
    """One panel a unit, one group of boxes a sensor set, one box a model.

    errors: `errors` of reconstructions, with a column `sensors`
    """
    from matplotlib.lines import Line2D

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
    legend(drawn, [Line2D([], [], color=RECONSTRUCTED[model].colour, label=model) for model in models])
    people = shown["participant"].nunique()
    caption = (
        f"{data}, n = {counted(people, 'participant')}: RMSE of every state that no sensor measures, by sensor set and "
        f"model; a box over participants and states, median and quartiles, whiskers to the smallest and the largest. "
        f"Split: {rule}. Note the logarithmic axis, and that angles and translations have one each."
    )
    alt = f"Boxes of the error of {listing(models)} for {counted(shown['sensors'].nunique(), 'sensor set')}."
    kept = ["sensors", "participant", "model", "state", "unit", "rmse"]
    return Figure(name, caption, alt, shown[kept], drawn)


@in_style
def disturbance_figure(found: pd.DataFrame, whose: str) -> Figure:
    """One panel a disturbance, one line a model.

    found: disturbance, level, model, rmse_deg
    """
    from matplotlib.lines import Line2D

    kinds = [word for word in AXES if (found["disturbance"] == word).any()]
    models = list(dict.fromkeys(found["model"]))
    drawn, grid = panels(1, len(kinds), 2.1, Room(left=0.6, across=0.6))
    for axes, kind in zip(grid[0], kinds, strict=True):
        for model, rows in found[found["disturbance"] == kind].groupby("model", sort=False):
            axes.plot(100 * rows["level"], rows["rmse_deg"], markersize=3, linewidth=1.1, **_look(str(model)))
        axes.set(xlabel=AXES[kind], ylabel="RMSE [deg]")
        decades(axes)
    legend(drawn, [Line2D([], [], label=model, markersize=3, **_look(model)) for model in models])
    caption = (
        f"{whose}: RMSE of the angles that no sensor measures, temporal split. Left: white noise on the sensors, in "
        f"the fitted and the test part alike. Right: readings lost one by one in the test part; models were "
        f"fitted to walks that lack none, the last known reading stands for a lost one, and masked shred is "
        f"given which are lost."
    )
    return Figure("disturbed", caption, f"Error of {listing(models)} against noise and missing readings.", found, drawn)


def _look(model: str) -> dict[str, Any]:
    look = RECONSTRUCTED[model]
    return {"color": look.colour, "linestyle": look.line, "marker": look.mark}
