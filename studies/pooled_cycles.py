"""Cycles of short trials pooled as `gaitdisc run` pools them, against the events that the files themselves hold.

    python studies/pooled_cycles.py [DATA] [--quick]

DATA holds the folder young_straight_and_turn. First the folder as it is; then with the files' events withheld, so that
contacts and foot offs are those of markers, moved by the steps that the plates saw. Differences are found minus the
file's own [ms].
"""

from __future__ import annotations

from command_line import GAIT, QUICK, command_line

GIVEN = command_line(__name__, __doc__, GAIT, QUICK)  # before the slow imports

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import gaitdisc as gd
from gaitdisc.ingest.new_study import draft_study
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study import Study
from gaitdisc.processing.pooled import pool_cycles

ONE_EVENT_S = 0.2  # farther apart is no pair
EVENTS = {"contacts": "initial contact", "foot offs": "foot off"}


def study_of(data: Path, quick: bool = False) -> Study:
    """The laboratory's folder as `gaitdisc new` finds it; one person for a quick look."""
    folder = data / "young_straight_and_turn"
    return draft_study(folder / "HC030A" if quick else folder)[0]


def pooled(study: Study, withhold: bool = False) -> tuple[list[gd.PooledCycles], dict[str, gd.Trial]]:
    """Cycles of everybody, and the trials as they were read, by name."""
    found, trials = [], {}
    with gd.C3DReader() as reader:
        for person in study.participants:

            def read(planned, person=person):
                trial = read_planned_trial(study, person, planned, reader)
                trials[trial.name] = trial
                return replace(trial, events=()) if withhold else trial

            found += pool_cycles(study, person, read)
    return found, trials


def differences_ms(found: Sequence[gd.PooledCycles], trials: dict[str, gd.Trial], kind: str) -> np.ndarray:
    """Events of kept cycles minus the files' own, each file's event once [ms]."""
    columns = ("start_s", "end_s") if kind == "contacts" else ("foot_off_s",)
    apart = []
    for one in found:
        trial = trials[one.name]
        for side in "rl":
            own = np.array([e.time for e in trial.events if (e.label, e.side) == (EVENTS[kind], side)])
            rows = one.kept[one.kept["side"] == side]
            times = np.unique(np.concatenate([rows[column].dropna() for column in columns]))
            for at in times:
                if len(own) and np.abs(own - at).min() <= ONE_EVENT_S:
                    apart.append(1e3 * (at - own[np.argmin(np.abs(own - at))]))
    return np.array(apart)


def counts(found: Sequence[gd.PooledCycles]) -> list[tuple[str, str]]:
    """How many walks, cycles, cycles on a plate, and cycles of live EMG channels."""
    kept = [one for one in found if len(one.kept)]
    muscles = [name for one in kept for name in (c.name for c in one.channels) if name.startswith("emg_")]
    emg = 0
    for one in kept:
        feet = one.kept["side"].to_numpy()
        for column, channel in ((k, each) for k, each in enumerate(one.channels) if each.quantity == "emg"):
            emg += int(np.isfinite(one.curves[feet == channel.side, :, column]).all(axis=1).sum())
    both = sum(min(map(one.counted, "lr")) > 0 for one in kept)
    return [
        ("walks with a kept cycle of each foot", f"{both} of {len(found)}"),
        ("cycles kept", str(sum(len(one.kept) for one in kept))),
        ("cycles left out", str(sum(len(one.left_out) for one in found))),
        ("cycles on a plate", str(sum(int(one.kept["kinetic"].sum()) for one in kept))),
        ("live EMG channels, cycles of them", f"{len(muscles)}, {emg}"),
    ]


def against_events(found: Sequence[gd.PooledCycles], trials: dict[str, gd.Trial]) -> list[tuple[str, str, str]]:
    """Events found without the file's own, straight and in turns: median, 95 % of the absolute differences, n."""
    rows = []
    for kind in EVENTS:
        for word in ("straight", "turn"):
            apart = differences_ms([one for one in found if one.condition == word], trials, kind)
            if len(apart):
                said = f"median {np.median(apart):+.0f} ms, 95 % within {np.percentile(np.abs(apart), 95):.0f} ms"
                rows.append((f"{kind}, {word}", said, f"n = {len(apart)}"))
    return rows


if __name__ == "__main__":
    study, began = study_of(GIVEN.data, GIVEN.quick), time.perf_counter()
    found, _ = pooled(study)
    seconds = time.perf_counter() - began
    for row in (*counts(found), ("from files to cycles", f"{seconds:.1f} s")):
        print(*row, sep=": ")
    for row in against_events(*pooled(study, withhold=True)):
        print(*row, sep=": ")
