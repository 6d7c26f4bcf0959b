"""Heart rate of a runner in the minutes after a shuttle run to exhaustion, every 4 s from breath to breath.

One day is learned, another day is unseen.
"""

import csv
import io

import numpy as np

REPOSITORY = "Oxford-NIL/YoYoTest"
COMMIT = "ef457e48ee19129847ed43911445b325ef0d1728"
FILES = {
    "FirstRound/D06/D06_COSMED_1.csv": "06285192ebf04678a5a4c0cec68e287dfa063ef26fc3d25e883b12357cb64462",
    "SecondRound/D06/D06_COSMED_2.csv": "fbc50b82248048994f00149b32305854d875b8c5e088f78edf56f2b08c4bdddf",
}


def read_trials(files):
    """Learned and unseen trials."""
    trials = []
    for content, stop in zip(files.values(), (1693, 1576), strict=True):
        lines = list(csv.reader(io.StringIO(content.decode(errors="replace"))))
        rate = lines[0].index("HR")
        rows = np.array([(line[0], line[rate]) for line in lines[2:] if len(line) > rate and line[rate]], float)
        rows = rows[rows[:, 1] > 40]
        time = np.arange(stop + 25, min(stop + 300, rows[-1, 0] - 2), 4.0)
        trials.append({"time": time, "hr": np.interp(time, rows[:, 0], rows[:, 1])})
    return trials[:1], trials[1:]
