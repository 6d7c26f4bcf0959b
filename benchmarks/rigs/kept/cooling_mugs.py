"""Hot water cools in open mugs.

Readings about every 5 minutes, put on a grid of 3; mugs 3 and 5 are learned, mug 4 is unseen.
"""

import numpy as np
from scipy.interpolate import PchipInterpolator

REPOSITORY = "AlekseyLobanov/cooling-down"
COMMIT = "9f85cd5fd009e16b732251f1ba3ab537e2b9c118"
FILES = {"temperature.txt": "cc28248b361721aa12859d78d6cad1d827b53752b7d84d723ba55cf33bad9647"}


def read_trials(files):
    """Learned and unseen trials."""
    mugs = {}
    for line in files["temperature.txt"].decode().splitlines():
        if len(line.split()) == 3:
            clock, mug, degrees = line.split()
            hours, minutes, seconds = map(int, clock.split(":"))
            mugs.setdefault(mug[0], []).append((60 * hours + minutes + seconds / 60, float(degrees)))
    trials = []
    for mug in "354":
        clock, degrees = np.array(mugs[mug]).T
        time = np.arange(clock[0], clock[-1], 3.0)
        trials.append({"time": 60 * time, "water": PchipInterpolator(clock, degrees)(time)})
    return trials[:2], trials[2:]
