"""A phone swings on a rod: its acceleration along the path, without gravity, every 0.1 s (of 0.01).

Swings let go at 15 and 45 degrees are learned, one let go at 25 degrees is unseen; 36 s of each.
"""

import io

import numpy as np

REPOSITORY = "harinlee83/Dynamics-of-Cell-Phone-Pendulum"
COMMIT = "5f6bf2379de9ce4731f2bd299c6635d9d9fdc978"
FOLDER = "csv files/l2LongTheta"
FILES = {
    FOLDER + "15.csv": "b660ef8e019a2b1972df746433742e3df13e9b79d95e8dcc7a448ba9a53f5ba1",
    FOLDER + "45.csv": "2b38b46dfa2bb80c7be360a5fa99b760c380ca47b91918c7a5a77484cf13fa18",
    FOLDER + "25.csv": "0b26a4bda8cf379f00e34ec102e7da317c6136713db012641b09b24c243ed249",
}
MEASURED = "267bdc75729c574af1e1d2095dac5d682a712d36640c0a24b1ebf50b80a7146a"


def read_trials(files):
    """Learned and unseen trials."""
    swings = []
    for content in files.values():
        rows = np.genfromtxt(io.StringIO(content.decode()), delimiter=",", skip_header=1)
        seconds = 3 + np.arange(360) * 0.1
        swings.append({"time": seconds - 3, "acceleration": np.interp(seconds, rows[:, 0], rows[:, 1])})
    return swings[:2], swings[2:]
