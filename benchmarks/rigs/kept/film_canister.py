"""Warm water in a film canister cools on a table.

Temperature of the water and of the table, every 5 s; run 1 is learned, run 3 is unseen.
"""

import numpy as np

REPOSITORY = "mpc-physical-science/projects"
COMMIT = "5165d22665a3f64d7a10f2b24b94d74487ddec84"
FILES = {
    "labs-testing/cooling/cooling_trials_1.csv": "553189bb240d6c9696a5d91431fbe1f5454b5c35fd0f247fedc4e43dd269bb57"
}


def read_trials(files):
    """Learned and unseen trials."""
    rows = [
        line.split(",")
        for line in files["labs-testing/cooling/cooling_trials_1.csv"].decode("utf-8-sig").splitlines()[2:]
    ]
    runs = []
    for first in (0, 5, 10):
        cells = [row[first : first + 3] for row in rows if len(row) > first + 2 and all(row[first : first + 3])]
        clock, water, room = np.array(cells, float).T
        time = np.arange(0.0, clock[-1], 5.0)
        runs.append({"time": time, "room": np.interp(time, clock, room), "water": np.interp(time, clock, water)})
    return runs[:1], runs[2:]
