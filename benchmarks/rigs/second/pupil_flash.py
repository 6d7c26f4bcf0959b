"""A pupil narrows after a flash of light of 1 s: diameter against its mean before the flash, 30 Hz, 5 s.

Five flashes are learned, three later ones are unseen; rows 27 to 34 of the file (one person, one kind of flash).
"""

import numpy as np

REPOSITORY = "PyPlr/cvd_pupillometry"
COMMIT = "89ae399e536dbadf6d21604dde9bc068462f6fe8"
FILES = {"notebooks/example_plrs.csv": "fbb1b6b95c0c674fb94e2b399b6328c7c253e8622283a6e7f24a59b32761e979"}


def read_trials(files):
    """Learned and unseen trials."""
    rows = np.array([line.split(",") for line in files["notebooks/example_plrs.csv"].decode().split()], float)
    time = rows[0, :601:4]
    trials = []
    for pupil in rows[26:34]:
        change = 100 * (pupil / pupil[:100].mean() - 1)
        trials.append({"time": time, "light": ((time >= 1) & (time < 2)).astype(float), "pupil": change[:601:4]})
    return trials[:5], trials[5:]
