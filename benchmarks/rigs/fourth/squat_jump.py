"""A person jumps from the squat on two force plates: force of the right foot and upward speed, every 10 ms.

Three jumps of 0.7 s before the feet leave the ground: two are learned, one is unseen. Weight and speed are taken from
both plates (speed by impulse, from rest).
"""

import io

import numpy as np

REPOSITORY = "andrewlba/ACL_squat_jump"
COMMIT = "6b525710185644a08c61951b806744760980241c"
FILES = {
    "data/BFR010_squat_jump.csv": "98a331c196327c2c4d67a2d0dcd67a90a52a67e08e0569c2d95542730e476495",
}
MEASURED = "75dbaf4e7328467b4f0886ce7b161116c7bc57438e8fec64661956f2ec752172"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    rows = np.genfromtxt(io.StringIO(content.decode("utf-8-sig")), delimiter=",", skip_header=7)
    right, left = rows[:, 2], rows[:, 11]
    both = right + left
    mass = both[:500].mean() / 9.81
    leave = np.flatnonzero((both[1:] < 20) & (both[:-1] >= 20))
    leave = leave[np.r_[True, np.diff(leave) > 1000]]
    jumps = []
    for end in leave:
        cut = slice(end - 700, end, 10)
        speed = np.cumsum((both[end - 700 : end] / mass - 9.81) * 0.001)[::10]
        jumps.append({"time": np.arange(70) * 0.01, "right": right[cut], "speed": speed})
    return jumps[:2], jumps[2:3]
