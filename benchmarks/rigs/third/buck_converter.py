"""A buck converter is switched between two levels: control voltage and output voltage, means of 40 us (four samples).

One recording of 10 ms is learned, another one is unseen.
"""

import io

import numpy as np

REPOSITORY = "wilsonrljr/sysidentpy-data"
COMMIT = "72715362eadcf860fdbd77d88b5d7e92b6143a83"
FILES = {
    "datasets/buck/buck_id.csv": "d244920026305463079732a91f62968bc30121f651a5699279b42b7ee637c3e7",
    "datasets/buck/buck_valid.csv": "adaaa29d0b677eaf7a3b36267f7fd8dc0afd6e9c1d7d054547a0e3f945e0c685",
}


def read_trials(files):
    """Learned and unseen trials."""
    trials = []
    for content in files.values():
        rows = np.genfromtxt(io.BytesIO(content), delimiter=",", skip_header=1)[:992].reshape(-1, 4, 3).mean(axis=1)
        trials.append({"time": np.arange(248) * 4e-5, "control": rows[:, 1], "output": rows[:, 2]})
    return trials[:1], trials[1:]
