"""A seismometer (a boom that hangs like a garden gate) swings free and comes to rest: output every 0.2 s, one swing.

From 36 s after the push on; the first 60 s are learned.
"""

import numpy as np

REPOSITORY = "caspar/PhysicsLab"
COMMIT = "1b4d45d9e915a84ecb80a39498850463bbc2d3be"
FILE = "14_Seismometer/data/seismometer_data_set_Sec01.txt"
FILES = {FILE: "9eddfbe22fb292cb08ba484c9bbd385b97f79e9e21d1e617b5072f49bc06c894"}


def read_trials(files):
    """Learned and unseen trials."""
    lines = [line.split() for line in files[FILE].decode("latin-1").splitlines()]
    rows = np.array([line for line in lines if len(line) == 2 and line[0][0].isdigit()], float)
    rows = rows[(rows[:, 0] >= 36) & (rows[:, 0] < 128)][::2]
    swing = {"time": rows[:, 0], "volts": rows[:, 1]}
    return [{k: v[:300] for k, v in swing.items()}], [{k: v[300:] for k, v in swing.items()}]
