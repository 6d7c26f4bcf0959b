"""Tables of pooled cycles: how many, spatiotemporal values, and those left out with their reasons."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from gaitdisc.processing.leg_curves import FEET
from gaitdisc.processing.pooled_cycles import CYCLE_COLUMNS, SPATIOTEMPORAL, PooledCycles
from gaitdisc.recording import PERCENT, Recording
from gaitdisc.report.table import Table
from gaitdisc.words import NONE, SIDE_WORDS, counted, number

WHO = ("participant", "group", "session", "condition")
VALUES = {  # column -> words, unit, digits
    "speed_m_per_s": ("speed", "m/s", 2),
    "cadence_per_min": ("cadence", "steps/min", 0),
    "stride_s": ("stride time", "s", 2),
    "step_s": ("step time", "s", 2),
    "stride_m": ("stride length", "m", 2),
    "step_m": ("step length", "m", 2),
    "width_m": ("step width", "m", 2),
    "stance_percent": ("stance", "%", 1),
    "swing_percent": ("swing", "%", 1),
    "single_support_percent": ("single support", "%", 1),
    "double_support_percent": ("double support", "%", 1),
}


def all_cycles(cycles: Sequence[PooledCycles]) -> pd.DataFrame:
    """Every cycle of everybody, kept or left out, one row each."""
    return _stack([_name_rows(pooled, pooled.cycles) for pooled in cycles if len(pooled.cycles)], CYCLE_COLUMNS)


def all_means(cycles: Sequence[PooledCycles]) -> pd.DataFrame:
    """Mean curves of everybody, one row a channel, side and percent."""
    columns = ("channel", "unit", "side", "percent", "n", "mean", "sd")
    return _stack([_name_rows(pooled, pooled.mean_curves()) for pooled in cycles if len(pooled.kept)], columns)


def mean_recordings(cycles: Sequence[PooledCycles]) -> dict[str, Recording]:
    """Mean cycle of each foot of everybody as a recording, by participant, session, condition and side.

    Percent of the cycle becomes time, 0 to the mean duration of the cycles; a channel without a side is that over the
    cycles of the foot; one that is not known over the whole cycle is left out.
    """
    recordings = {}
    for pooled in cycles:
        means = pooled.mean_curves()
        known = {channel.name: channel for channel in pooled.channels}
        for side in sorted(set(means["side"])):
            grid = means[means["side"] == side].pivot_table("mean", "percent", "channel")
            grid = grid[[name for name in known if name in grid and bool(np.isfinite(grid[name]).all())]]
            duration_s = float(pooled.kept.loc[pooled.kept["side"] == side, "stride_s"].mean())
            if grid.empty or not len(grid.columns):
                continue
            words = (pooled.subject, pooled.session, pooled.condition, side)
            time, channels = grid.index.to_numpy(float) / 100 * duration_s, [known[str(name)] for name in grid.columns]
            mean = Recording(time, grid.to_numpy(float), tuple(channels), pooled.subject, pooled.condition)
            recordings["_".join(word.replace(" ", "-") for word in words if word)] = mean
    return recordings


def all_curves(cycles: Sequence[PooledCycles]) -> pd.DataFrame:
    """Every kept cycle of everybody, one row a cycle, channel and percent; channels without a value are not there."""
    columns = ("trial", "side", "start_s", "channel", "unit", "percent", "value")
    tables = []
    for pooled in cycles:
        curves = pooled.curves
        for row, cycle in enumerate(pooled.kept.itertuples(index=False)):
            for column, channel in enumerate(pooled.channels):
                values = curves[row, :, column]
                if np.isfinite(values).any():
                    words = (cycle.trial, cycle.side, cycle.start_s, channel.name, channel.unit, PERCENT, values)
                    tables.append(_name_rows(pooled, pd.DataFrame(dict(zip(columns, words, strict=True)))))
    return _stack(tables, columns)


def all_spatiotemporal(cycles: Sequence[PooledCycles]) -> pd.DataFrame:
    """Spatiotemporal values of everybody: n, mean and standard deviation over kept cycles, by side."""
    rows = []
    for pooled in cycles:
        who, feet = _who(pooled).values(), pooled.kept["side"].to_numpy()
        for side in FEET:
            for value in SPATIOTEMPORAL:
                values = pooled.kept[value].to_numpy(float)[feet == side]
                known = values[~np.isnan(values)]
                spread = float(known.std(ddof=1)) if len(known) > 1 else np.nan
                rows.append((*who, value, side, len(known), float(known.mean()) if len(known) else np.nan, spread))
    return pd.DataFrame(rows, columns=pd.Index([*WHO, "value", "side", "n", "mean", "sd"]))


def _who(pooled: PooledCycles) -> dict[str, str]:
    return dict(zip(WHO, (pooled.subject, pooled.group, pooled.session, pooled.condition), strict=True))


def _name_rows(pooled: PooledCycles, table: pd.DataFrame) -> pd.DataFrame:
    """Table behind the columns that say whose it is."""
    return table.assign(**_who(pooled))[[*WHO, *table.columns]]


def _stack(tables: Sequence[pd.DataFrame], columns: Sequence[str]) -> pd.DataFrame:
    """Tables of `_name_rows` under each other; of none the columns."""
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=pd.Index([*WHO, *columns]))


def overview_table(cycles: Sequence[PooledCycles]) -> Table:
    """Who has how many cycles of which foot, from how many trials, and what placed the contacts."""
    rows, records = [], []
    for pooled in cycles:
        kinetic = pooled.kept[pooled.kept["kinetic"].astype(bool)]
        muscles = emg_counts(pooled)
        several = len(pooled.detectors) > 1
        by = ", ".join(f"{name} ({count})" if several else name for name, count in pooled.detectors.items())
        record = {
            **_who(pooled), "trials": pooled.trials, **{f"kept_{side}": pooled.counted(side) for side in FEET},
            **{f"left_out_{side}": int((pooled.left_out["side"] == side).sum()) for side in FEET},
            **{f"kinetic_{side}": int((kinetic["side"] == side).sum()) for side in FEET},
            "emg_channels": len(muscles), "emg_cycles": sum(muscles.values()), "detectors": by,
            "contact_offset_s": pooled.contact_offset_s, "foot_off_offset_s": pooled.foot_off_offset_s,
            "offset_steps": pooled.offset_steps, "over_ground": pooled.over_ground,
        }  # fmt: skip
        live = sum(count > 0 for count in muscles.values())
        rows.append((
            pooled.subject, pooled.group or NONE, pooled.where, str(pooled.trials),
            *(f"{record[f'kept_{side}']} / {record[f'left_out_{side}']}" for side in FEET),
            f"{record['kinetic_l']}, {record['kinetic_r']}",
            f"{live} usable, {record['emg_cycles']} cycles" if live else NONE, by or NONE, offset_words(pooled),
        ))  # fmt: skip
        records.append(record)
    columns = (
        "participant", "group", "session, condition", "trials", "left: kept / dropped", "right: kept / dropped",
        "on a plate (left, right)", "EMG", "contacts by", "shift of contacts",
    )  # fmt: skip
    caption = (
        f"Cycles pooled over trials, n = {len(cycles)} sessions and conditions. On a plate: cycles in which the foot "
        "was alone on one plate for the entire stance. EMG: usable channels, and cycles with all of them."
    )
    return Table("cycle_counts", caption, columns, tuple(rows), pd.DataFrame(records))


def emg_counts(pooled: PooledCycles) -> dict[str, int]:
    """Kept cycles of its own foot in which each EMG channel is live."""
    feet = pooled.kept["side"].to_numpy()
    columns = {column: c for column, c in enumerate(pooled.channels) if c.quantity == "emg"}
    if not columns:
        return {}
    curves = pooled.curves
    return {
        channel.name: int(np.isfinite(curves[feet == channel.side, :, column]).all(axis=1).sum())
        for column, channel in columns.items()
    }


def offset_words(pooled: PooledCycles) -> str:
    """By how much contacts of markers or angles were moved, and on how many steps that rests."""
    late = [name for name in pooled.detectors if name in ("markers", "angles")]
    if not late:
        return NONE
    if pooled.contact_offset_s is None:
        return "not shifted: no step was recorded by a plate or marked by an event"
    steps = counted(pooled.offset_steps, "step")
    return f"{1000.0 * pooled.contact_offset_s:+.0f} ms ({steps} recorded by a plate or marked by an event)"


def spatiotemporal_table(sets: Sequence[PooledCycles], name: str) -> Table:
    """Spatiotemporal values of one person, mean ± standard deviation (n) for each foot, session and condition."""
    numbers = all_spatiotemporal(sets)
    records: Any = numbers.to_dict("records")
    known = {(row["value"], row["side"], row["session"], row["condition"]): row for row in records}
    rows = []
    for value, (words, unit, digits) in VALUES.items():
        cells = []
        for pooled in sets:
            for side in FEET:
                row = known[value, side, pooled.session, pooled.condition]
                cells.append(mean_cell(row["mean"], row["sd"], row["n"], digits))
        if set(cells) != {NONE}:
            rows.append((f"{words} [{unit}]", *cells))
    columns = ("value", *(f"{SIDE_WORDS[side]}" for _ in sets for side in FEET))
    groups = (("", 1), *((pooled.where, 2) for pooled in sets))
    caption = f"{sets[0].subject}: spatiotemporal values, mean ± standard deviation (number of cycles)."
    return Table(f"spatiotemporal-{name}", caption, columns, tuple(rows), numbers, groups)


def tabulate_left_out(sets: Sequence[PooledCycles], name: str) -> Table | None:
    """Cycles of one person that are left out, each with its reason; None where there are none."""
    numbers = all_cycles([pooled for pooled in sets if len(pooled.left_out)])
    numbers = numbers[~numbers["kept"].astype(bool)].reset_index(drop=True) if len(numbers) else numbers
    if not len(numbers):
        return None
    rows = []
    for row in numbers.itertuples(index=False):
        where, span = f"{row.session} {row.condition}".strip(), f"{row.start_s:.2f} to {row.end_s:.2f}"
        rows.append((where, str(row.trial), SIDE_WORDS[str(row.side)], span, str(row.reason)))
    headings = ("session, condition", "trial", "side", "from, to [s]", "why")
    caption = f"{sets[0].subject}: cycles left out, n = {len(rows)}."
    return Table(f"left_out-{name}", caption, headings, tuple(rows), numbers)


def mean_cell(mean: float, spread: float, count: int, digits: int) -> str:
    """Mean ± standard deviation (count), as a cell has it."""
    if not count:
        return NONE
    sd = f" ± {spread:.{digits}f}" if np.isfinite(spread) else ""
    return f"{number(mean, digits)}{sd} ({count})"
