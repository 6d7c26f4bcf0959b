"""File dialects, events against plates, and dead EMG channels in real recordings.

    python studies/real_files.py [DATA]

DATA holds the folders young_straight_and_turn, opensim_walks and c3d_reader_samples. Each row is a promise and what was
found.
"""

from __future__ import annotations

from command_line import GAIT, command_line

GIVEN = command_line(__name__, __doc__, GAIT)  # before the slow imports

import csv
from pathlib import Path

import numpy as np
from markdown_table import markdown_table

import gaitdisc as gd

Row = tuple[str, str, str]
MUSCLES = {"Rect": "rf", "Hams": "ham", "Gast": "gas", "Tib Ant": "ta"}  # the manifest's words


def run(data: Path) -> list[Row]:
    """Every row."""
    people, dialects = young_people(data / "young_straight_and_turn"), opensim_dialects(data / "opensim_walks")
    return [*people, *dialects, *encodings(data / "c3d_reader_samples")]


def young_people(folder: Path) -> list[Row]:
    """Plates against events in ms; live EMG channels as the manifest has them."""
    with (folder / "manifest.csv").open(encoding="utf-8") as file:
        manifest = {row["file"]: row["live_emg"] for row in csv.DictReader(file)}
    differences: list[float] = []
    agree, files = 0, sorted(folder.rglob("*.c3d"))
    walks = [file for file in files if file.parent.name != "static"]
    with gd.C3DReader() as reader:
        for file in files:
            trial = gd.read(file, reader=reader)
            wanted = {f"emg_{MUSCLES[n[2:]]}_{n[0].lower()}" for n in manifest[file.name].split("|") if n}
            dead = {finding.channel for finding in gd.check(trial).findings if finding.severity == "refused"}
            live = set(trial.stream("emg").names) - dead
            agree += {name for name in live if name.split("_")[1] in MUSCLES.values()} == wanted
            if file in walks:  # plate minus event at every contact that both have, where there are both
                seen = gd.contacts_by_detector(trial)
                events, plates = seen.get("events", {}), seen.get("force", {})
                for side in set(events) & set(plates):
                    differences += (1e3 * events[side].compared(plates[side]).difference_s).tolist()
    low, middle, high = np.percentile(differences, [25, 50, 75])
    quartiles = f"quartiles {low:+.0f} and {high:+.0f}, n = {len(differences)} contacts"
    found = f"plate minus event {middle:+.0f} ms (median; {quartiles})"
    return [
        (f"young_straight_and_turn, {len(walks)} walks", "events and plates compared", found),
        (f"young_straight_and_turn, {len(files)} files", "dead EMG as in manifest.csv", f"{agree} files agree exactly"),
    ]


def opensim_dialects(folder: Path) -> list[Row]:
    """Every text dialect is read; EMG, force and kinematics of one walk on one time base."""
    files = sorted(file for file in folder.rglob("*") if file.suffix in (".mot", ".sto", ".trc", ".c3d"))
    refused = []
    for file in files:
        try:
            gd.read(file)
        except gd.GaitdiscError as error:
            refused.append(str(error))
    walk = [folder / "mrs_emg_walking" / name for name in ("IK_gait.mot", "GRF_gait.mot", "EMG_gait.mot")]
    both = gd.read(walk).on_one_base(100.0)
    span = f"{len(both.names)} channels at {both.rate_hz:g} Hz, {both.time[0]:.2f} to {both.time[-1]:.2f} s"
    return [
        (
            f"opensim_walks, {len(files)} files",
            "every dialect read",
            f"{len(files) - len(refused)} read" + "".join(refused),
        ),
        ("opensim_walks/mrs_emg_walking", "one time base", span),
    ]


def encodings(folder: Path) -> list[Row]:
    """The encodings of one trial are equal; what cannot be read is refused in words."""
    points, refused = {}, []
    files = sorted(folder.rglob("*.c3d"))
    with gd.C3DReader() as reader:
        for file in files:
            try:
                trial = gd.read(file, reader=reader)
            except gd.GaitdiscError:
                refused.append(file.name)
                continue
            if file.parent.name == "c3d_org_sample01":
                points[file.name] = trial.stream("markers").values
    first = next(iter(points.values()))
    apart = max(float(np.nanmax(np.abs(values - first))) for values in points.values())
    equal, words = f"{len(points)} encodings, {1e3 * apart:.2f} mm apart at most", f"refused: {', '.join(refused)}"
    all_files, promise = f"c3d_reader_samples, {len(files)} files", "read, or refused in words"
    return [
        ("c3d_reader_samples/sample01", "encodings equal", equal),
        (all_files, promise, f"{len(files) - len(refused)} read; {words}"),
    ]


if __name__ == "__main__":
    print(markdown_table("recordings | promise | found", run(GIVEN.data)))
