"""A capacitor discharges through a resistor.

Voltage every 10 s, one discharge of 3 minutes; its first 2 minutes are learned.
"""

import numpy as np

REPOSITORY = "alexarmesz/Discharging-Capacitor"
COMMIT = "2000e54a43508df2e75c465244d2dd95c974fbf7"
FILES = {"values.txt": "d6a7fd6ac21ee2fbc5f7075e2a9f7f48b83c370e15cbeed1a36a07be4470246b"}


def read_trials(files):
    """Learned and unseen trials."""
    volts = np.array(files["values.txt"].split(), float)
    discharge = {"time": 10.0 * np.arange(len(volts)), "volts": volts}
    return [{k: v[:13] for k, v in discharge.items()}], [{k: v[13:] for k, v in discharge.items()}]
