"""A cart on springs is let go: place every 10 ms, from the first turn; one run is learned, a weaker one is unseen."""

import numpy as np

REPOSITORY = "stecuproductions/Embeded_Systems_Project"
COMMIT = "f15ebfb08aefeafa5f2c6a30dd3e647ef2eee0d3"
FILES = {
    "task 2/experiment_3.csv": "32104ac2b1f53f8f1318ee160a981ac5dbd69efe22ea571ac665c9b112237483",
    "task 2/experiment_1.csv": "abf15ce35a3e9289b3085519e67b8db5fcb06610ff7a0915d3e4f9a3370528cd",
}


def read_trials(files):
    """Learned and unseen trials."""
    runs = []
    for content in files.values():
        lines = content.decode().replace(",", ".").split()
        rows = np.array([line.split(";") for line in lines], float)[14:110]
        runs.append({"time": rows[:, 0], "place": rows[:, 1] / 1000})
    return runs[:1], runs[1:]
