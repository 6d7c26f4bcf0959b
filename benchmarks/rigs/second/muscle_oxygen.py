"""Oxygen in the thigh muscle of a cyclist through bouts of 4 minutes of work and the rest before and after.

Saturation every 2 s; bouts 1, 2 and 4 are learned, bout 3 is unseen. The bouts' times stand in the source's R/data.R.
"""

import numpy as np

REPOSITORY = "jemarnold/mnirs"
COMMIT = "a7ce18dec9d79a9268d40c34b942169cb19d4f91"
FILES = {"inst/extdata/moxy_intervals.csv": "1e7dcca0514f4a939c3e19b08406759604944e15cfd3163345d1fae4afc72f79"}


def read_trials(files):
    """Learned and unseen trials."""
    rows = [line.split(",") for line in files["inst/extdata/moxy_intervals.csv"].decode("utf-8-sig").splitlines()]
    saturation = np.array([row[2] for row in rows if len(row) > 5 and row[2].isdigit()], float)
    clock = 2.0 * np.arange(len(saturation))
    bouts = []
    for begin, end in ((124, 364), (848, 1088), (1210, 1450), (486, 726)):
        time = clock[(clock >= begin - 60) & (clock < end + 90)]
        bouts.append(
            {
                "time": time,
                "work": ((time >= begin) & (time < end)).astype(float),
                "saturation": saturation[(time / 2).astype(int)],
            }
        )
    bouts = [bouts[0], bouts[3], bouts[2], bouts[1]]
    return bouts[:3], bouts[3:]
