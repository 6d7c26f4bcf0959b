"""A young athlete on an ergometer, power raised by steps to exhaustion, then rest: power and oxygen uptake.

Recorded at each heartbeat, here the mean of each 10 s. One trial: the first 17 min are learned (rest, steps), the last
8 are unseen (last steps, recovery).
"""

import numpy as np

REPOSITORY = "xcai66/Calibration-of-Heart-Rate-Reserve-for-Graded-Cycle-Ergometry"
COMMIT = "91005a1265907681961a08b9399b144a13abe7f4"
FILES = {
    "01_sources/actes_test_measure.csv": "14a9df027caf00ee1dc39f1493e708c27a7da88794ff69a59442326ef7aa0516",
}
MEASURED = "a8ccbb2c676888637d4575bb738e777ec609713c5eebfc38cbb84e7128badbbf"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    rows = [line.split(",") for line in content.decode().splitlines()[1:]]
    beats = np.array([(r[1], r[4], r[3]) for r in rows if r[0] == "5"], float)
    bins = np.floor((beats[:, 0] + 120) / 10).astype(int)
    power, uptake = (np.array([beats[bins == k, c].mean() for k in range(149)]) for c in (1, 2))
    run = {"time": np.arange(149) * 10.0, "power": power, "uptake": uptake}
    return [{c: v[:104] for c, v in run.items()}], [{c: v[104:] for c, v in run.items()}]
