"""The page of a reconstruction: answer, models, states and curves, self-contained, every number beside it as CSV."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from gaitdisc.reconstruction.reconstruction import CALIBRATED, FLOORS, WORTH, Reconstruction, enough_sensors
from gaitdisc.report.figure import Figure, file_names, save_figures
from gaitdisc.report.page import write_page
from gaitdisc.report.panels import MEASURED, RECONSTRUCTED, Room, in_style, legend, legend_lines, panels_for, sheets
from gaitdisc.report.table import Table, provenance_tables, save_tables, tabulate_findings, tabulate_refusals
from gaitdisc.words import NONE, counted, label, listing, number, plain, spoken, unit_text

if TYPE_CHECKING:
    import rich.table
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

WITH_SENSORS, COVERAGE = "with sensors [1]", "coverage [%]"  # left out where there is little room
BESIDE = ("shred", "fourier ridge", "delay ridge", "linear", *FLOORS)
MOST_PANELS = 16
MOST_DRAWN = 4  # participants whose curves stand in the page; the numbers of all are in errors.csv and curves.csv
NOT_MSE = (
    "The dissertation calls the norm of the error divided by the norm of the measured values “MSE” (Eq. 2.21, Table "
    "5.2) and prints it in degrees, but it has no unit. Compare the “MSE” with the relative L2 here, not with numbers "
    "in degrees."
)
_plain = partial(number, none=NONE)
FINDINGS = "Findings in the recordings, n = {}; windows on plateaus and filled gaps are used unchanged."


def models_table(done: Reconstruction) -> Table:
    """Every model, over the participants."""
    numbers: Any = done.over_participants().rename_axis("model").reset_index()
    angles = _has_angles(done)
    columns: dict[str, Callable[[Any], str]] = {
        "model": lambda row: f"{row['model']}{' *' if row['model'] == done.recommended else ''}",
        "RMSE [deg]": lambda row: _spread(row, "rmse_deg", 2),
        "relative L2 [1]": lambda row: _spread(row, "relative_l2", 3),
        WITH_SENSORS: lambda row: _plain(row["relative_l2_whole"], 3),
        "R² [1]": lambda row: _spread(row, "r2", 3),
        COVERAGE: lambda row: f"{100 * row['coverage']:.0f}",
        "fit [s]": lambda row: f"{row['seconds']:.2f}",
    }
    shown = [column for column in columns if angles or column not in ("RMSE [deg]", WITH_SENSORS)]
    rows = tuple(tuple(columns[column](row) for column in shown) for _, row in numbers.iterrows())
    with_sensors = "“with sensors”: sensors are included as states without error, as in Table 5.2; " if angles else ""
    people = counted(len(done.participants), "participant")
    caption = (
        f"Models on the test windows: errors of {_what_is_tested(done)}, mean over n = {people} [95 % CI of the mean]. "
        f"Split: {done.split}. Relative L2: norm of the error divided by norm of the measured values about zero; "
        f"{with_sensors}R²: median over reconstructed channels; coverage: share of samples inside the 90 % interval; "
        "fit: processor time. * recommended: the cheapest model within 2 % of the smallest error on the validation "
        "windows."
    )
    return Table("models", caption, tuple(shown), rows, numbers)


def states_table(done: Reconstruction) -> Table:
    """RMSE of every state and model, mean over participants, with relative L2 and R2 of the recommended model."""
    over: Any = done.over_states()
    units = {channel.name: channel.unit for channel in done.states}
    rows = []
    for state, unit in units.items():
        best = state, done.recommended
        errors = [_rmse(over["rmse"][state, model], unit) for model in done.models]
        rows.append((label(state), unit, *errors, _plain(over["relative_l2"][best], 3), _plain(over["r2"][best], 3)))
    caption = (
        f"RMSE of every state [unit of the state], mean over n = {counted(len(done.participants), 'participant')}; "
        f"relative L2 and R² of {done.recommended}. errors.csv has the intervals over the strides of each participant."
    )
    columns = ("state", "unit", *done.models, "relative L2", "R²")
    return Table("states", caption, columns, tuple(rows), over.reset_index())


def participants_table(done: Reconstruction) -> Table:
    """RMSE of the angles for every participant and model."""
    angles = _has_angles(done)
    measure = "rmse_deg" if angles else "relative_l2"
    wide: Any = done.summary.pivot_table(index="participant", columns="model", values=measure)[list(done.models)]
    strides: Any = done.summary.groupby("participant")["strides"].first()
    rows = tuple(
        (str(row[0]), str(int(strides[row[0]])), *(_plain(value, 2 if angles else 3) for value in row[1:]))
        for row in wide.itertuples()
    )
    what = f"RMSE of {_what_is_tested(done)} [deg]" if angles else "Relative L2 of all reconstructed channels [1]"
    caption = f"{what}, by participant; strides: those of the test part."
    return Table("participants", caption, ("participant", "strides", *done.models), rows, done.summary)


def reconstruction_sentences(done: Reconstruction) -> list[str]:
    """What is reconstructed from which sensors, how well, by which model, and what history and a network buy."""
    best = done.recommended
    over: Any = done.over_participants()
    sensors, kinds = listing([spoken(channel.name) for channel in done.sensors]), list(done.models)
    row = over.loc[best]
    angles = _has_angles(done)
    rmse = f"RMSE of the angles {_plain(row['rmse_deg'], 2)} deg, " if angles else ""
    noun = "future state" if _ahead(done) else "other state"
    units = listing(list(dict.fromkeys(channel.unit for channel in done.states)))
    what = counted(len(done.states), noun) if angles else f"{counted(len(done.states), 'channel')} [{units}]"
    sentences = [
        f"The recommended model, {best}, reconstructs {what} from {sensors}: {rmse}relative L2 error "
        f"{_plain(row['relative_l2'], 3)}, median R² {_plain(row['r2'], 2)} (mean over "
        f"{counted(len(done.participants), 'participant')})."
    ]
    compared = [kind for kind in BESIDE if kind in kinds and kind != best]
    if compared:
        measure, digits, unit = ("rmse_deg", 2, " deg") if angles else ("relative_l2", 3, "")
        words = [f"{kind} {_plain(over.loc[kind, measure], digits)}{unit}" for kind in compared]
        sentences.append(f"For comparison: {listing(words)}.")
    sentences += _count_wins(done, best, "rmse_deg" if angles else "relative_l2")
    sentences += _after_calibration(done, best) if angles else []
    sentences += search_sentences(done.search) if done.search is not None else []
    if "leaks" in done.split:
        sentences.append("The split leaks: these errors show only how well windows are interpolated in time.")
    if len(done.participants) < 3:
        sentences.append("The numbers describe these participants only.")
    return [*sentences, NOT_MSE] if angles else sentences


def _count_wins(done: Reconstruction, best: str, measure: str) -> list[str]:
    """In how many participants the recommended model errs least, and who else does."""
    wide: Any = done.summary.pivot_table(index="participant", columns="model", values=measure)
    least = wide[[model for model in wide.columns if not model.endswith(CALIBRATED.format(""))]].idxmin(axis=1)
    people, wins = len(least), int((least == best).sum())
    if people < 2:
        return []
    if wins == people:
        return [f"The recommended model has the smallest error in all {people} participants."]
    counts = least[least != best].value_counts(sort=False).sort_values(ascending=False, kind="stable")
    others = [f"{model} in {count}" for model, count in counts.items()]
    return [f"The recommended model has the smallest error in {wins} of {people} participants, {listing(others)}."]


def _after_calibration(done: Reconstruction, best: str) -> list[str]:
    if CALIBRATED.format(best) not in done.models:
        return []
    over: Any = done.over_participants()["rmse_deg"]
    before, after = float(over[best]), float(over[CALIBRATED.format(best)])
    return [
        f"After correction with a few measured strides of the person, the error is {_plain(after, 2)} deg instead of "
        f"{_plain(before, 2)} deg ({100 * (after / before - 1):+.0f} %)."
    ]


def reconstruction_text(done: Reconstruction) -> rich.table.Table:
    """Print the models for a terminal of 80 columns."""
    from rich import box
    from rich.table import Table as Printed

    shown = models_table(done)
    table = Printed(box=box.SIMPLE, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    chosen = [k for k, column in enumerate(shown.columns) if column not in (WITH_SENSORS, COVERAGE)]
    for k in chosen:
        table.add_column(plain(shown.columns[k]), justify="left" if k == 0 else "right")
    for row in shown.rows:
        table.add_row(*(plain(row[k]) for k in chosen))
    return table


def _has_angles(done: Reconstruction) -> bool:
    return any(channel.unit == "deg" for channel in done.states)


def _ahead(done: Reconstruction) -> bool:
    return bool(set(done.sensors) & set(done.states))  # the present of a sensor is read, not reconstructed


def _what_is_tested(done: Reconstruction) -> str:
    if not _has_angles(done):
        return "all reconstructed channels"
    return "all angles" if _ahead(done) else "the angles that no sensor measures"


def _spread(row: Any, measure: str, digits: int) -> str:
    mean, low, high = (float(row[f"{measure}{end}"]) for end in ("", "_low", "_high"))
    return _plain(mean, digits) + (f" [{_plain(low, digits)}, {_plain(high, digits)}]" if math.isfinite(low) else "")


def _rmse(value: Any, unit: str) -> str:
    if unit == "deg" or not float(value):
        return _plain(value, 2)
    leading = math.floor(math.log10(float(value))) if math.isfinite(float(value)) else 0
    return _plain(value, max(0, 2 - leading))  # three digits of volts, metres and newtons alike


@in_style
def reconstruction_figures(done: Reconstruction, participant: str, name: str) -> list[Figure]:
    """One panel a state: the mean of what was measured with its spread, and what the models reconstruct."""
    curves = pick_curves(done, participant)
    return [
        _figure(done, participant, curves[curves["state"].isin([channel.name for channel in part])], f"{name}-{k + 1}")
        for k, part in enumerate(sheets(list(done.states), MOST_PANELS, name).values())
    ]


def pick_curves(done: Reconstruction, participant: str) -> pd.DataFrame:
    """Curves of one person, of the models that are drawn: linear, the recommended one, SHRED."""
    shown = {"linear", done.recommended, "shred"}
    return done.curves[(done.curves["participant"] == participant) & done.curves["model"].isin(shown)]


def states_key(models: list[str]) -> list[Artist]:
    """Handles of the legend: what was measured, and the models."""
    from matplotlib.patches import Patch

    looks = {model: RECONSTRUCTED[model.removesuffix(", calibrated")] for model in models}
    return [Patch(color=MEASURED.colour, alpha=0.2, label="measured, mean ± sd"), *legend_lines(looks)]


def _figure(done: Reconstruction, participant: str, numbers: pd.DataFrame, name: str) -> Figure:
    units = {channel.name: channel.unit for channel in done.states}
    states, models = list(dict.fromkeys(numbers["state"])), list(dict.fromkeys(numbers["model"]))
    drawn, cells = panels_for(len(states), 4, 1.1, Room(left=0.6, across=0.6, down=0.46))
    for axes, state in zip(cells, states, strict=True):
        draw_state(axes, numbers[numbers["state"] == state])
        axes.set_title(label(state), fontsize=7.4)
        axes.set_ylabel(f"[{unit_text(units[state])}]", fontsize=6.8, labelpad=1)
        axes.set_xlim(0, 100)
        axes.set_xticks([0, 50, 100])
    for axes in cells[-4:]:
        axes.set_xlabel("stride [%]", labelpad=1)
    legend(drawn, states_key(models))
    strides = int(done.summary.loc[done.summary["participant"] == participant, "strides"].iloc[0])
    caption = (
        f"{participant}: measured and reconstructed states over the stride, test windows only, n = "
        f"{counted(strides, 'stride')}. Band: measured, mean ± standard deviation; lines: mean of the estimates of "
        f"each model from {counted(len(done.sensors), 'sensor')}. Split: {done.split}."
    )
    by = ", ".join(models)
    alt = f"{counted(len(states), 'state')} of {participant} over the stride, measured, and reconstructed by {by}."
    return Figure(f"reconstruction-{name}", caption, alt, numbers, drawn)


def draw_state(axes: Axes, numbers: pd.DataFrame) -> None:
    """Draw one person's rows of `Reconstruction.curves` of a state: measured with its spread, and each estimate."""
    for place, (model, rows) in enumerate(numbers.groupby("model", sort=False)):
        if place == 0:
            low, high = rows["measured"] - rows["measured_sd"], rows["measured"] + rows["measured_sd"]
            axes.fill_between(rows["percent"], low, high, color=MEASURED.colour, alpha=0.2, linewidth=0)
        look = RECONSTRUCTED[str(model).removesuffix(", calibrated")]
        axes.plot(rows["percent"], rows["reconstructed"], color=look.colour, linestyle=look.line, linewidth=1.1)


def search_table(search: pd.DataFrame) -> Table:
    """Best set of every size, from a reconstruction's `search`."""
    chosen = enough_sensors(search)
    rows = tuple(
        (
            f"{row['sensors']}{' *' if k == chosen else ''}",
            listing([label(name) for name in str(row["names"]).split(", ")]),
            number(float(row["loss"]) ** 0.5, 3),
            number(float(row["rmse_deg"]), 2),
            str(row["fits"]),
            f"{row['seconds']:.1f}",
        )
        for k, row in search.reset_index(drop=True).iterrows()
    )
    caption = (
        "Best set of sensors of every size for all participants together, by ridge regression on the sensors' history. "
        "All sets of up to three sensors were tried; then the sensor with the largest gain was added. Sets were chosen "
        "by the RMSE of all angles on the validation windows, with exact sensors. Not measured: RMSE of such angles "
        f"on the test windows. * the smallest set that one more sensor improves by less than {100 * WORTH:.0f} %; "
        "otherwise the largest."
    )
    columns = ("sensors", "which", "all angles [deg]", "not measured [deg]", "regressions", "processor time [s]")
    return Table("search", caption, columns, rows, search)


def search_sentences(search: pd.DataFrame) -> list[str]:
    """How many sensors are enough by a reconstruction's `search`, and what one more would bring."""
    chosen = enough_sensors(search)
    row = search.iloc[chosen]
    names = listing([spoken(name) for name in str(row["names"]).split(", ")])
    size = int(row["sensors"])
    if chosen + 1 < len(search):
        less = 1 - (float(search["loss"].iloc[chosen + 1]) / float(row["loss"])) ** 0.5
        words = f"{counted(size, 'sensor').capitalize()} {'is' if size == 1 else 'are'} enough: {names}. One more "
        words += f"sensor reduces the error of all angles by {100 * less:.0f} %"
    else:
        words = f"The best set of {counted(size, 'sensor')} is {names}; it may not be enough, because no larger set "
        words += "was tried"
    cost = f"{counted(int(search['fits'].sum()), 'regression')}, {search['seconds'].sum():.1f} s"
    return [f"{words} (search: {cost})."]


def write_reconstruction_report(done: Reconstruction, folder: Path) -> Path:
    """Write the report of a reconstruction: `report.html`, `figures/` and `tables/`."""
    tables = {
        "models": models_table(done),
        "states": states_table(done),
        **({"search": search_table(done.search)} if done.search is not None else {}),
        "participants": participants_table(done),
        "left_out": tabulate_refusals(done.refusals, "left-out", f"Left out, n = {len(done.refusals)}."),
        "findings": tabulate_findings(done.findings, FINDINGS.format(len(done.findings)), "finding"),
        **provenance_tables(done.provenance),
    }
    save_tables(tables.values(), folder)
    names = file_names(done.participants[:MOST_DRAWN])
    drawn = [figure for person, name in names.items() for figure in reconstruction_figures(done, person, name)]
    shown = {
        "done": done,
        "sentences": reconstruction_sentences(done),
        "figures": save_figures(drawn, folder),
        "tables": tables,
        "method": method_sentences(done),
        "undrawn": len(done.participants) - len(names),
    }
    return write_page("reconstruction", shown, folder)


def method_sentences(done: Reconstruction) -> list[str]:
    """How the numbers were made."""
    return [
        f"A window contains {done.history} (Eqs. 5.1-5.7). It lies within one trial and has no missing values.",
        f"Split of the windows: {done.split}. Scales and weights come from the training windows only. Penalties, "
        "widths and the epoch of the weights are chosen on the validation windows. Errors are those of the test "
        "windows, which are separated from the others by the length of a window and 0.3 s.",
        "All recordings were low-passed by a zero-lag filter, which uses future samples. A live reconstruction would "
        "be delayed by the filter's length, or would be noisier.",
        "RMSE is in the unit of the state. The 95 % confidence interval of the RMSE comes from 1,000 resamples of the "
        "strides. Angles and positions are never averaged together.",
        *(f"{name}: {words}." for name, words in done.models.items()),
    ]
