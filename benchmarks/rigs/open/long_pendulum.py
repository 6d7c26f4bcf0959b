"""A pendulum of 1.47 m from a film: pieces of 10 s at 30 Hz at the start of the swing."""

import numpy as np

REPOSITORY = "jiarui-wen/PHY180-Pendulum-Project"
COMMIT = "625797ec3db63cbcd2c203fac5b6399f9e945f5b"
FILES = {"report2/8047.txt": "d93e1a684b61779c05c1d71af2936359091bdb0a5d4c836b87922d2be6b173de"}


def read_trials(files):
    """Learned and unseen trials."""
    rows = [
        line.split()[:3]
        for line in files["report2/8047.txt"].decode("utf-8-sig").splitlines()[2:]
        if len(line.split()) > 2
    ]
    table = np.array(rows, float)
    angle = np.arctan2(table[:, 1], -table[:, 2])
    pieces = [{"time": np.arange(300) / 30, "swing": angle[i : i + 300]} for i in (0, 300, 600)]
    return pieces[:2], pieces[2:]
