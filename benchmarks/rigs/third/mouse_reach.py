"""Students move the pointer from the bottom of the screen to an answer at the top: height of the pointer, every 10 ms.

The trial begins when the hand starts; six reaches are learned, three others are unseen. Lists of times and places stand
as text inside a saved R table; one list is one reach.
"""

import bz2
import re

import numpy as np

REPOSITORY = "PascalKieslich/mousetrap"
COMMIT = "8dbae23ed78fca6150f8cc5a3dedcf1e7f8f0734"
FILE = "data/mt_example_raw.rda"
FILES = {FILE: "b774db78c4f5c93a734ab1c244d12f0771ac2c461800ffe7fde4e5b5c231a2f4"}


def read_trials(files):
    """Learned and unseen trials."""
    lists = [
        np.array(text[1:-1].split(b","), float) for text in re.findall(rb"\[[-0-9, .]+\]", bz2.decompress(files[FILE]))
    ]
    reaches = []
    for clock, place in zip(lists[:38], lists[76:], strict=False):
        up = place[0] - place
        start = np.flatnonzero(up > 0.02 * up[-1])[0] - 1
        time = np.arange(0, 0.599, 0.01)
        moved = np.interp(clock[start] + 1000 * time, clock, up) / 1000
        steady = (
            np.all(np.diff(moved) > -0.002) and moved[30] > 0.9 * moved[-1] and abs(moved[-1] - up[-1] / 1000) < 0.01
        )
        if steady:
            reaches.append({"time": time, "answer": np.full(len(time), up[-1] / 1000), "hand_place": moved})
    return reaches[:6], reaches[6:10]
