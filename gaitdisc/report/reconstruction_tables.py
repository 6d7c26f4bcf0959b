"""What a reconstruction found, in tables and in sentences: RMSE, relative L2 and R2, each under its own name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gaitdisc.report.search_table import search_sentences
from gaitdisc.report.table import Table
from gaitdisc.report.wording import counted, label, listed, number, plain
from gaitdisc.results.reconstruction import CALIBRATED, FLOORS, Reconstruction

if TYPE_CHECKING:
    import rich.table

WITH_SENSORS, COVERAGE = "with sensors [1]", "coverage [%]"  # left out where there is little room
BESIDE = ("shred", "fourier ridge", "delay ridge", "linear", *FLOORS)
NOT_MSE = (
    "The dissertation calls the norm of the error by the norm of the measured values “MSE” (Eq. 2.21, Table 5.2) and "
    "prints it in degrees; it has no unit. It is compared with the relative L2 here, and with no number in degrees."
)


def models_table(done: Reconstruction) -> Table:
    """Every model, over the participants."""
    numbers: Any = done.over_participants().rename_axis("model").reset_index()
    angles = _has_angles(done)
    rows = tuple(
        (
            f"{row['model']}{' *' if row['model'] == done.recommended else ''}",
            *((_spread(row, "rmse_deg", 2),) if angles else ()),
            _spread(row, "relative_l2", 3),
            *((_plain(row["relative_l2_whole"], 3),) if angles else ()),
            _spread(row, "r2", 3),
            f"{100 * row['coverage']:.0f}",
            f"{row['seconds']:.2f}",
        )
        for _, row in numbers.iterrows()
    )
    with_sensors = "“with sensors”: the sensors counted as states without error, as Table 5.2 does; " if angles else ""
    people = counted(len(done.participants), "participant")
    caption = (
        f"Models on the test windows: mean over n = {people} [95 % interval of the mean], {_judged(done)}. "
        f"Split: {done.split}. Relative L2: norm of the error by norm of the measured values about zero; "
        f"{with_sensors}R²: median over what is reconstructed; "
        f"coverage: share inside an interval that was made for 90 %; seconds: processor time of a fit. * recommended: "
        f"the cheapest within 2 % of the least error on the windows that models are chosen by."
    )
    columns = (
        "model",
        *(("RMSE [deg]",) if angles else ()),
        "relative L2 [1]",
        *((WITH_SENSORS,) if angles else ()),
        "R² [1]",
        COVERAGE,
        "fit [s]",
    )
    return Table("models", caption, columns, rows, numbers)


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
        f"RMSE of every state [its unit], mean over n = {counted(len(done.participants), 'participant')}; relative L2 "
        f"and R² of {done.recommended}. Intervals over strides, participant by participant, stand in errors.csv."
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
    what = f"RMSE of {_judged(done)} [deg]" if angles else "Relative L2 of all that is reconstructed [1]"
    caption = f"{what}, by participant; strides: those of the test part."
    return Table("participants", caption, ("participant", "strides", *done.models), rows, done.summary)


def reconstruction_sentences(done: Reconstruction) -> list[str]:
    """What is told from which sensors, how well, by which model, and what history and a network buy."""
    best = done.recommended
    over: Any = done.over_participants()
    sensors, kinds = listed([label(channel.name) for channel in done.sensors]), list(done.models)
    row = over.loc[best]
    angles = _has_angles(done)
    rmse = f"an RMSE of {_plain(row['rmse_deg'], 2)} deg over the angles and " if angles else ""
    noun = "future state" if _ahead(done) else "other state"
    what = counted(len(done.states), noun) if angles else _quantities(done)
    sentences = [
        f"From {sensors} {what} {'is' if len(done.states) == 1 else 'are'} reconstructed with {rmse}a relative L2 of "
        f"{_plain(row['relative_l2'], 3)} (median R² {_plain(row['r2'], 2)}; mean of "
        f"{counted(len(done.participants), 'participant')}) by {best}, which is recommended.",
    ]
    compared = [kind for kind in BESIDE if kind in kinds and kind != best]
    if compared:
        measure, digits, unit = ("rmse_deg", 2, " deg") if angles else ("relative_l2", 3, "")
        words = [f"{kind} {_plain(over.loc[kind, measure], digits)}{unit}" for kind in compared]
        sentences.append(f"Beside it: {listed(words)}.")
    sentences += _won(done, best, "rmse_deg" if angles else "relative_l2")
    sentences += _after_calibration(done, best) if angles else []
    sentences += search_sentences(done.search) if done.search is not None else []
    if "leaks" in done.split:
        sentences.append("The split leaks: these errors say how well windows are interpolated in time, not more.")
    if len(done.participants) < 3:
        sentences.append("The numbers describe these participants and nobody else.")
    return [*sentences, NOT_MSE] if angles else sentences


def _won(done: Reconstruction, best: str, measure: str) -> list[str]:
    """In how many participants the recommended model errs least, and who else does."""
    wide: Any = done.summary.pivot_table(index="participant", columns="model", values=measure)
    least = wide[[model for model in wide.columns if not model.endswith(CALIBRATED.format(""))]].idxmin(axis=1)
    people, own = len(least), int((least == best).sum())
    if people < 2:
        return []
    if own == people:
        return [f"It errs least in every one of {people} participants."]
    counts = least[least != best].value_counts(sort=False).sort_values(ascending=False, kind="stable")
    others = [f"{model} in {count}" for model, count in counts.items()]
    return [f"It errs least in {own} of {people} participants, {listed(others)}."]


def _after_calibration(done: Reconstruction, best: str) -> list[str]:
    if CALIBRATED.format(best) not in done.models:
        return []
    over: Any = done.over_participants()["rmse_deg"]
    before, after = float(over[best]), float(over[CALIBRATED.format(best)])
    return [
        f"Corrected by a few strides of the person whose states are known, it errs by {_plain(after, 2)} instead of "
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
    return bool(set(done.sensors) & set(done.states))  # the present of a sensor is read, not told


def _judged(done: Reconstruction) -> str:
    if not _has_angles(done):
        return "all that is reconstructed"
    return "all angles" if _ahead(done) else "the angles that no sensor measures"


def _quantities(done: Reconstruction) -> str:
    units = listed(list(dict.fromkeys(channel.unit for channel in done.states)))
    return f"{counted(len(done.states), 'channel')} [{units}]"


def _spread(row: Any, measure: str, digits: int) -> str:
    mean, low, high = (float(row[f"{measure}{end}"]) for end in ("", "_low", "_high"))
    return _plain(mean, digits) + (f" [{_plain(low, digits)}, {_plain(high, digits)}]" if math.isfinite(low) else "")


def _plain(value: Any, digits: int) -> str:
    return number(float(value), digits) if math.isfinite(float(value)) else "–"


def _rmse(value: Any, unit: str) -> str:
    if unit == "deg" or not float(value):
        return _plain(value, 2)
    leading = math.floor(math.log10(float(value))) if math.isfinite(float(value)) else 0
    return _plain(value, max(0, 2 - leading))  # three digits of volts, metres and newtons alike
