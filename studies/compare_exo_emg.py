"""EMG over the stride of eight people under two settings of an ankle exoskeleton, compared point by point.

    python studies/compare_exo_emg.py [DATA] [OUT]

DATA holds the folder ankle_exo_emg_grf (by default ../shared/data/gait, or GAITDISC_DATA/gait); OUT gets the report.
The source gives 30 points of each stride, brought to 101 here by lines; what EMG is scaled by is not known.
"""

from __future__ import annotations

from pathlib import Path

from command_line import GAIT, argument, command_line

OUT = argument("out", "where the report goes (default: no report)", nargs="?", type=Path)
GIVEN = command_line(__name__, __doc__, GAIT, OUT)  # before the slow imports

import numpy as np
import pandas as pd
from ankle_exo_emg import EASIEST, HARDEST
from ankle_exo_walks import PEOPLE
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.comparison.compare import compare_people
from gaitdisc.comparison.page import write_mismatch_report
from gaitdisc.comparison.sentences import mismatch_sentences
from gaitdisc.processing.pooled_cycles import STRIDE_COLUMNS, WalkSummary
from gaitdisc.recording import PERCENT

FORCES = 6  # the first six signals are ground forces


def run(data: Path, first: str = EASIEST, second: str = HARDEST) -> gd.Mismatch:
    """Mismatch of two settings, second minus first, paired over the eight people."""
    stored = np.load(data / "ankle_exo_emg_grf" / "assisted.npz")
    signals = [str(name) for name in stored["signals"]][FORCES:]
    walks = {one: [summary(stored[f"x_{who}{one}"], signals, who, one) for who in PEOPLE] for one in (first, second)}
    return compare_people(walks[first], walks[second])


def summary(strides: NDArray[np.float64], signals: list[str], person: str, condition: str) -> WalkSummary:
    """Strides of one walk on 101 points: EMG alone."""
    bins = np.linspace(0.0, 100.0, strides.shape[2])
    emg = np.asarray(strides[:, FORCES:], float)
    curves = np.stack([[np.interp(PERCENT, bins, curve) for curve in stride] for stride in emg])
    channels = tuple(gd.Channel(f"emg_{signal.lower()}", "emg", "1", signal[-1].lower()) for signal in signals)
    table = pd.DataFrame(columns=pd.Index(STRIDE_COLUMNS))
    return WalkSummary(person, condition, 0.0, 0.0, "source", channels, np.swapaxes(curves, 1, 2), table, (), {})


if __name__ == "__main__":
    found = run(GIVEN.data)
    print(" ".join(mismatch_sentences(found)))
    print(found.summary.round(3).to_string())
    print(found.regions.round(3).to_string())
    if GIVEN.out:
        print(write_mismatch_report(found, GIVEN.out))
