"""An inertial sensor is fixed to the axle of a motor that swings: commanded speed, and speed by the sensor's gyroscope.

Every 4 ms, pieces of 1 s, of swings at 3, 5 and 7 Hz; six are learned, three later ones are unseen.
"""

import io

import numpy as np

REPOSITORY = "dongdaming1966/mcar_simulate"
COMMIT = "c0ab50990b77ce8a2778b6d4f85a3d352923972c"
FILES = {
    "data/10_18_2.dat": "ed6572be2a655d816bab91aba6cf850bcd6ce31afd9b3a0da89589cd88c03039",
    "data/10_18_3.dat": "189df10f73a04b505b32d4b3f6a370ac90cdce27c7a1aec1a20a97d3212a4b6d",
    "data/10_18_4.dat": "e96de692b995149f5c13cccf041b1c549b97e41edc1f012330ee84e06f5cd7a8",
}


def read_trials(files):
    """Learned and unseen trials."""
    learned, unseen = [], []
    for content in files.values():
        rows = np.genfromtxt(io.BytesIO(content))
        for begin, trials in ((500, learned), (1200, learned), (2200, unseen)):
            piece = rows[begin : begin + 500 : 2]
            trials.append({"time": np.arange(250) * 0.004, "command": piece[:, 3], "gyro": piece[:, 1]})
    return learned, unseen
