"""Breaths of a sedated patient on a ventilator: flow and airway pressure at 50 Hz; one trial for each breath."""

import numpy as np

REPOSITORY = "slhowe/vent"
COMMIT = "970dcc9f519a08274ae77b97d055da85008c560c"
FILES = {"expiration_parameters/RM-8.49.35.366.txt": "46fccdae568afdebc40b099be81134b144b2c6968febb5fddb2a9442e21fccd4"}


def read_trials(files):
    """Learned and unseen trials."""
    breaths = []
    for line in next(iter(files.values())).decode().splitlines():
        if line.startswith("BS"):
            breaths.append([])
        elif breaths and line.count(",") == 1 and not line.startswith("B"):
            breaths[-1].append([float(v) for v in line.split(",")])
    tables = [np.array(b) for b in breaths if len(b) > 60][:9]
    trials = [{"time": 0.02 * np.arange(len(b)), "flow": b[:, 0] / 60, "pressure": b[:, 1]} for b in tables]
    return trials[:6], trials[6:]
