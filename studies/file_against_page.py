"""How far the curves behind a page lie from what the file itself holds: angles, moments, powers, every cycle.

    python studies/file_against_page.py OUT [--half develop] [--people WHO ...]

The same people as in faults_on_pages.py, with all their trials. `gaitdisc export` gives each cycle at 101 points; the
file's own values are taken between its frames at these very points, by lines and by a cubic spline, and whichever lies
nearer counts, so that the table shows filters, signs and axes and not the way of interpolation. A channel may be the
negative of the file's (moments are internal, conventions.md); which is, is printed.
"""

from __future__ import annotations

from command_line import SHARED, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "folder of the tables and of the runs", type=str, metavar="OUT"),
    argument("--half", "develop, kept or both", "develop"),
    argument("--people", "only these", nargs="+", type=str, default=None),
    argument("--others", "people of other laboratories", str(SHARED / "people")),
)  # before the slow imports

import csv
import re
import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from as_a_user import rows_of, told
from c3d_in_place import InPlace
from faults_on_pages import jobs_of, laid_out
from markdown_table import markdown_table
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

AXES = {"flexion": 0, "angle": 0, "tilt": 0, "adduction": 1, "inversion": 1, "list": 1, "rotation": 2}
LIMITS = {"deg": 0.01, "N m/kg": 0.001, "W/kg": 0.01}
COLUMNS = ("person", "trial", "channel", "unit", "cycles", "sign", "rms", "largest")


def of_file(file: InPlace, channel: str, side: str) -> NDArray[np.float64] | None:
    """What the file holds under a channel's name, over its frames; nothing where it holds none."""
    parts, leg = channel.split("_"), side.upper()
    joint = "Foot" if channel.startswith("foot_progression") else parts[0].capitalize()
    if parts[-1] == "moment":
        label, factor = f"{leg}{joint}Moment", 1e-3
    elif "power" in parts:
        label, factor = f"{leg}{joint}Power", 1.0
    else:
        label, factor = (f"{leg}FootProgressAngles" if joint == "Foot" else f"{leg}{joint}Angles"), 1.0
    try:
        values = factor * file.points[:, file.point(label)].astype(float)
    except LookupError:
        return None
    values[values[:, 3] < 0] = np.nan
    if label.endswith("Power"):
        return values[:, int(np.nanargmax(np.nanstd(values[:, :3], axis=0)))]
    return values[:, 2 if joint == "Foot" else AXES[parts[1]]]


def apart(
    file: InPlace, held: NDArray[np.float64], start_s: float, end_s: float, curve: NDArray[np.float64]
) -> tuple[NDArray[np.float64], int]:
    """Difference of a curve to the file's values at its points, and the sign with which they are compared."""
    frames = np.linspace(start_s, end_s, len(curve)) * file.points_rate
    known = np.isfinite(held)
    own = np.flatnonzero(known)
    lines = np.interp(frames, np.arange(len(held)), np.where(known, held, np.nan))
    cubic = CubicSpline(own, held[own])(frames) if len(own) > 3 else lines
    found = [(curve - sign * values, sign) for values in (lines, cubic) for sign in (1, -1)]
    return min(found, key=lambda one: np.nan_to_num(np.nanmean(one[0] ** 2), nan=np.inf))


def of_person(job: Any) -> list[dict[str, Any]]:
    """Rows of a person: each channel of each trial, over all its cycles."""
    folder = job.out / "healthy" / f"{job.who} file"
    if not (folder / "study" / "run" / "run.json").exists():
        laid_out(folder, job.who, job.files, tuple(job.files))
        told("new", folder / "study", "--from", folder / "rec")
        told("run", folder / "study", "-q")
    told("export", folder / "study" / "run", "--out", folder / "tables")
    files = files_of(folder / "study")
    ends = {
        (row["condition"], row["trial"], row["side"], round(float(row["start_s"]), 4)): float(row["end_s"])
        for row in rows_of(folder / "tables" / "cycles.csv")
        if row["kept"] == "True"
    }
    cycles: dict[tuple[str, ...], dict[float, list[float]]] = defaultdict(lambda: defaultdict(list))
    for row in rows_of(folder / "tables" / "curves.csv"):
        if row["unit"] in LIMITS:
            key = (row["condition"], row["trial"], row["side"], row["channel"], row["unit"])
            cycles[key][float(row["start_s"])].append(float(row["value"]) if row["value"] else np.nan)
    rows = []
    for (condition, trial, side, channel, unit), each in cycles.items():
        own, leg = without_side(channel)
        if leg not in ("", side):
            continue
        file = InPlace(files[condition, trial])
        held = of_file(file, own, side)
        if held is None:
            continue
        differences = [
            apart(file, held, start, ends[condition, trial, side, round(start, 4)], np.array(curve))
            for start, curve in each.items()
        ]
        all_of = np.concatenate([one for one, _ in differences])
        if np.isfinite(all_of).any():
            rms, largest = float(np.sqrt(np.nanmean(all_of**2))), float(np.nanmax(np.abs(all_of)))
            signs = "".join(sorted({"+-"[sign < 0] for _, sign in differences}))
            values = (job.who, f"{condition} {trial}", channel, unit, len(each), signs, rms, largest)
            rows.append(dict(zip(COLUMNS, values, strict=True)))
    return rows


def without_side(channel: str) -> tuple[str, str]:
    """Name of a channel without its side, and the side."""
    match = re.fullmatch(r"(.+)_([lr])(_moment)?", channel)
    return (match[1] + (match[3] or ""), match[2]) if match else (channel, "")


def files_of(study: Path) -> dict[tuple[str, str], Path]:
    """Recording of each trial of a condition, which are counted from 1."""
    settings = tomllib.loads((study / "study.toml").read_text(encoding="utf-8"))
    found: dict[tuple[str, str], Path] = {}
    counts: dict[str, int] = defaultdict(int)
    for trial in settings["participants"][0]["trials"]:
        counts[trial["condition"]] += 1
        found[trial["condition"], str(counts[trial["condition"]])] = study / trial["files"][0]
    return found


if __name__ == "__main__":
    out = Path(GIVEN.out).resolve()
    rows = []
    for job in jobs_of(out, GIVEN.half, GIVEN.people, Path(GIVEN.others), pages=False):
        rows += of_person(job)
        print(f"{job.who}: {len(rows)} channels", flush=True)
    with (out / "values.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows(rows)
    kinds = defaultdict(list)
    for row in rows:
        kinds[without_side(row["channel"])[0], row["unit"]].append(row)
    lines = []
    for (name, unit), own in sorted(kinds.items(), key=lambda item: (item[0][1], item[0][0])):
        rms = [row["rms"] for row in own]
        within = sum(one <= LIMITS[unit] for one in rms)
        signs = "".join(sorted({row["sign"] for row in own}))
        cycles = sum(row["cycles"] for row in own)
        lines.append((name, unit, len(own), cycles, within, f"{np.median(rms):.4f}", f"{max(rms):.4f}", signs))
    print(markdown_table("channel | unit | legs and trials | cycles | within | median rms | largest rms | sign", lines))
