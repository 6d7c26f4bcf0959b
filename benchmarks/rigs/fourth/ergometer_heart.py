"""A man on an ergometer: power in steps up to 250 W and down again, heart rate, every 5 s (means; steps of 2 min).

The first 20 min are learned, the 8 min after them are unseen.
"""

import csv
import io
from datetime import datetime

import numpy as np

REPOSITORY = "HelmutQualtinger/kinomap"
COMMIT = "758ed6b129bd38cbfd8859fcaf4f36651abb9482"
FILES = {
    "race.csv": "cebc40da50c3d86bd5f6f1550a04cfa192de34308470f859125a2c545b2a03d9",
}
MEASURED = "d4f81a99252bc60789ed8f6c99d97753a0a4b9b67c6d1f95060f00038f269fe2"


def read_trials(files):
    """Learned and unseen trials."""
    rows = csv.DictReader(io.StringIO(files["race.csv"].decode()))
    rows = [row for row in rows if row["Power"] and row["Heart rate"]]
    clock = np.array([datetime.fromisoformat(row["Date"]).timestamp() for row in rows])
    clock -= clock[0]
    power, rate = (np.array([row[name] for row in rows], float) for name in ("Power", "Heart rate"))
    time = np.arange(10.0, 1680.0, 5.0)
    windows = [(clock >= t - 2.5) & (clock < t + 2.5) for t in time]
    columns = {"time": time, "power": [power[w].mean() for w in windows], "heart": [rate[w].mean() for w in windows]}
    columns = {name: np.array(column) for name, column in columns.items()}
    return [{k: v[:238] for k, v in columns.items()}], [{k: v[238:] for k, v in columns.items()}]
