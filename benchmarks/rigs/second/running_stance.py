"""A person runs on a treadmill that measures force: vertical force of single stances, 300 Hz.

Eight stances are learned, five later ones are unseen; the force of the flight after a stance is taken as zero.
"""

from itertools import pairwise

import numpy as np

REPOSITORY = "alcantarar/dryft"
COMMIT = "f9c014bcfd8381d7f2bf3f7b23de9b8cf8dcd3f9"
FILES = {"dryft/sample/custom_drift_S001runT25.csv": "4415d509f0b7474be5b6224e1a4823d7cf3aadf1af9f6366b6bef6c2b920ca0a"}


def read_trials(files):
    """Learned and unseen trials."""
    force = np.array(files["dryft/sample/custom_drift_S001runT25.csv"].split(), float)
    edges = np.flatnonzero(np.diff((force > 60).astype(int))) + 1
    stances = []
    for begin, end in pairwise(edges):
        if 60 < end - begin < 100 and force[begin] > 60:
            zero = np.median(force[end + 8 : end + 20])
            stances.append({"time": np.arange(end - begin) / 300, "force": force[begin:end] - zero})
    return stances[5:13], stances[13:18]
