"""A person stands on two force plates for 60 s: force on the ground and centre of pressure, forwards, every 40 ms.

Eight pieces of 3 s are learned, four between them are unseen.
"""

import numpy as np

REPOSITORY = "Nikita868/PSYC9080"
COMMIT = "bb177d3151873def897ae2166d8c265ac0ef40b0"
FILE = "Signal-Processing/Example data/Static standing/PDS01CF1grf.txt"
FILES = {FILE: "f7d7187cb9571d018982175efb5a6e7c2f0de90566d79bd17a3a0977ea1e4a9e"}


def read_trials(files):
    """Learned and unseen trials."""
    names, *lines = files[FILE].decode().splitlines()
    rows = np.array([line.split("\t") for line in lines], float)
    force, centre = (rows[:, names.split("\t").index(name)] for name in ("GRFNET_X", "COPNET_X"))
    cuts = [slice(begin, begin + 300, 4) for begin in range(100, 5700, 480)]
    pieces = [{"time": np.arange(75) * 0.04, "force": force[cut], "pressure": 100 * centre[cut]} for cut in cuts]
    return pieces[0::3] + pieces[1::3], pieces[2::3]
