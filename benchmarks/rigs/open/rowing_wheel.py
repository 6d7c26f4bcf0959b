"""Flywheel of a rowing machine between the strokes of a person.

Impulses of its magnet, resampled at 30 ms; one trial for each recovery.
"""

import numpy as np
from scipy.signal import find_peaks

REPOSITORY = "laberning/openrowingmonitor"
COMMIT = "03abd72da18acb0307f355be53670c3254a93ffd"
FILES = {"recordings/RX800.csv": "507fc10b5bf335b0a954b003773640eec2aa1f068020065ca817c4fc20523da5"}


def read_trials(files):
    """Learned and unseen trials."""
    gaps = np.array(files["recordings/RX800.csv"].split(), float)
    clock, rate = np.cumsum(gaps)[2:], 1 / gaps[2:]
    rate[1:-1] = np.median([rate[:-2], rate[1:-1], rate[2:]], axis=0)
    peaks = find_peaks(rate, distance=40, prominence=4)[0]
    trials = []
    for begin, end in zip(peaks, [*peaks[1:], len(rate) - 1], strict=True):
        low = begin + np.argmin(rate[begin : end + 1])
        time = np.arange(float(clock[begin]) + 0.15, float(clock[low]) - 0.05, 0.03)
        trials.append({"time": time, "rate": np.interp(time, clock, rate)})
    return trials[:6], trials[6:]
