"""The hip motor of an exoskeleton swings its leg: torque, angle of the joint, speed by the drive, every 10 ms (of 5).

Pieces of 1.1 s of one recording: four are learned, two are unseen.
"""

import io

import numpy as np

REPOSITORY = "qleonardolp/XsensEposAccbasedControl"
COMMIT = "48bc55149ce71ac123353dca2f7efaee1ed0e6d6"
FILE = "ACC_BASED_CONTROL/data/log_thread_abc_solto.txt"
FILES = {FILE: "872b5421c85778668d06fd29410f9e3af497acd4631464ede921c50ce8449e8a"}


def read_trials(files):
    """Learned and unseen trials."""
    rows = np.genfromtxt(io.BytesIO(files[FILE]), delimiter=",")
    pieces = []
    for begin in 11.1 + 1.1 * np.arange(6):
        time = np.arange(0, 1.09, 0.01)
        columns = {"torque": 9, "angle": 4, "speed": 5}
        pieces.append(
            {"time": time, **{k: np.interp(begin + time, rows[:, 0], rows[:, c]) for k, c in columns.items()}}
        )
    return pieces[0:2] + pieces[3:5], [pieces[2], pieces[5]]
