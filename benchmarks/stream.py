"""One sample streamed: how long `Stream.update` takes for each kind of model, beside torch called on the window.

    python benchmarks/stream.py [--samples 5000]

Real walks (treadmill_walk_ik, three sensors, 15 states, 25 readings 0.04 s apart).
Calls are timed one by one, on one thread; beside them stands the largest difference between what is streamed and what
is computed over the recording, in standard deviations of the state (torch computes the networks in float32).
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(__name__, __doc__, argument("--samples", "streamed one by one", 5000))  # before the slow imports

import os
import time
from collections.abc import Callable, Iterable

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from sensing_walks import treadmill_walks

from gaitdisc.reconstruction.model_folder import Stream
from gaitdisc.reconstruction.window_model import KINDS, fit_reconstructor
from gaitdisc.reconstruction.windows import cut_windows

GOAL_MS = 0.2


def main() -> None:
    count = GIVEN.samples
    [person] = treadmill_walks()
    [walks] = person.walks.people.values()
    what = person.what
    parts = person.parts()
    recording = walks[0].recording
    readings = np.resize(recording.selected(what.sensors).values, (count, len(what.sensors)))
    windows = cut_windows(recording, what.sensors, what.states, what.lags, walks[0].phi)
    sd = windows.y.std(axis=0)
    print(f"{'model':<18}{'median ms':>10}{'99 % ms':>10}{'torch ms':>10}  largest difference [sd]")
    for kind in KINDS:
        done = fit_reconstructor(kind, what, parts.fitted(), parts.checked())
        stream = Stream(done)
        streamed = np.array([stream.update(reading) for reading in readings[: len(recording.time)]])
        apart = np.abs(streamed[what.lags.reach :] - done(windows)) / sd
        each = timed(stream.update, readings)
        whole = timed(done, [windows.rows(slice(row, row + 1)) for row in range(200)])
        line = f"{kind:<18}{np.median(each):>10.3f}{np.quantile(each, 0.99):>10.3f}{np.median(whole):>10.3f}"
        print(f"{line}  {apart.max():.1e}{'' if np.median(each) <= GOAL_MS else '  goal missed'}")


def timed(call: Callable, given: Iterable) -> NDArray[np.float64]:
    """Milliseconds of each call."""
    found = []
    for one in given:
        begun = time.perf_counter()
        call(one)
        found.append(1e3 * (time.perf_counter() - begun))
    return np.array(found)


if __name__ == "__main__":
    main()
