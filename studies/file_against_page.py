"""How far the curves behind a page lie from what the file itself holds: angles, moments, powers, every cycle.

    python studies/file_against_page.py OUT [--half develop] [--people WHO ...]

The same people as in faults_on_pages.py, with all their trials. `gaitdisc export` gives each cycle at 101 points; the
file's own values are taken between its frames at these very points, by lines and by a cubic spline, and whichever lies
nearer counts. A channel may be the negative of the file's (moments are internal, conventions.md); which is, is printed.
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

import re
import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from as_a_user import told
from c3d_in_place import InPlace
from false_alarms import laid_out
from faults_on_pages import jobs_of
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
    files, counts = {}, defaultdict(int)  # recording of each trial of a condition, which are counted from 1
    for trial in tomllib.loads((folder / "study" / "study.toml").read_text("utf-8"))["participants"][0]["trials"]:
        counts[trial["condition"]] += 1
        files[trial["condition"], str(counts[trial["condition"]])] = folder / "study" / trial["files"][0]
    words, key = {"trial": str}, ["condition", "trial", "side", "start_s"]
    kept = pd.read_csv(folder / "tables" / "cycles.csv", dtype=words).round({"start_s": 4}).query("kept")
    ends = kept.set_index(key)["end_s"]
    curves = pd.read_csv(folder / "tables" / "curves.csv", dtype=words).set_index("start_s")
    rows = []
    of_channel = curves[curves["unit"].isin(LIMITS)].groupby([*key[:3], "channel", "unit"], sort=False)
    for names, each in of_channel:
        condition, trial, side, channel, unit = map(str, names)
        own, leg = without_side(channel)
        file = InPlace(files[condition, trial])
        held = of_file(file, own, side) if leg in ("", side) else None
        if held is None:
            continue
        differences = [
            apart(file, held, start, ends[condition, trial, side, round(start, 4)], each.loc[start, "value"].to_numpy())
            for start in dict.fromkeys(each.index)
        ]
        all_of = np.concatenate([one for one, _ in differences])
        if np.isfinite(all_of).any():
            rms, largest = float(np.sqrt(np.nanmean(all_of**2))), float(np.nanmax(np.abs(all_of)))
            signs = "".join(sorted({"+-"[sign < 0] for _, sign in differences}))
            values = (job.who, f"{condition} {trial}", channel, unit, len(differences), signs, rms, largest)
            rows.append(dict(zip(COLUMNS, values, strict=True)))
    return rows


def without_side(channel: str) -> tuple[str, str]:
    """Name of a channel without its side, and the side."""
    match = re.fullmatch(r"(.+)_([lr])(_moment)?", channel)
    return (match[1] + (match[3] or ""), match[2]) if match else (channel, "")


if __name__ == "__main__":
    out = Path(GIVEN.out).resolve()
    rows = []
    for job in jobs_of(out, GIVEN.half, GIVEN.people, Path(GIVEN.others), pages=False):
        rows += of_person(job)
        print(f"{job.who}: {len(rows)} channels", flush=True)
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    table.to_csv(out / "values.csv", index=False)
    lines = []
    for (unit, name), own in table.groupby(["unit", table["channel"].map(lambda one: without_side(str(one))[0])]):
        within, signs = int((own["rms"] <= LIMITS[str(unit)]).sum()), "".join(sorted(set(own["sign"])))
        rms = (f"{own['rms'].median():.4f}", f"{own['rms'].max():.4f}")
        lines.append((name, unit, len(own), own["cycles"].sum(), within, *rms, signs))
    print(markdown_table("channel | unit | legs and trials | cycles | within | median rms | largest rms | sign", lines))
