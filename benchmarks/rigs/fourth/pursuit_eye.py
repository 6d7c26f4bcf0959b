"""The eye of a person follows a dot that swings to and fro by 10 degrees once in 4 s: eye tracker, every 40 ms (of 2).

One recording to the right is learned; one to the left, until the person blinks, is unseen. The clock of the dot was not
recorded with the eye: it is set 0.16 s back, the same for both, so that the eye is 0.1 s late, as eyes are.
"""

import io

import numpy as np
from scipy.io import loadmat

REPOSITORY = "semtu/smooth-pursuit"
COMMIT = "cb4702d116bb2a56cee89883185bb5db00f11ea0"
FILES = {
    "SPtest.mat": "24d3206848b381ef4d43d8187e29a618b2377df559599f2d0717be7d43ca19ee",
}
MEASURED = "22e3dffd89d860739eebc400d18dae56193704d36587c0705754225f8d654545"


def read_trials(files):
    """Learned and unseen trials."""
    recordings = loadmat(io.BytesIO(files["SPtest.mat"]))["DATsp"][:2, 1]
    trials = []
    for rows, side, end in zip(recordings, (1, -1), (12, 10), strict=True):
        time = np.arange(0, end, 0.04)
        dot = side * 5 * (1 - np.cos(np.pi / 2 * (time + 0.16)))
        trials.append({"time": time, "dot": dot, "eye": np.interp(time, rows[:, 3] - rows[0, 3], rows[:, 0])})
    return trials[:1], trials[1:]
