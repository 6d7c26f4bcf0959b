"""Oxygen uptake of a cyclist through bouts of 5 minutes at 265 W, means over 15 s, one record of 34 minutes.

Two bouts and the rest after them are learned, what follows is unseen. The bouts' times are events of the file.
"""

import numpy as np

REPOSITORY = "jemarnold/epl"
COMMIT = "b52ac48d8c7ca22f51a5e5811d0ff9d92bf4927c"
FILES = {"inst/extdata/parvo_binned.CSV": "d903720320576f1a2bb2b5d98116367e381e354f49fabab61622987721da90c0"}


def read_trials(files):
    """Learned and unseen trials."""
    lines = [
        line.split(",")
        for line in files["inst/extdata/parvo_binned.CSV"].decode("latin-1").splitlines()
        if line[:1].isdigit()
    ]
    rows = np.array([line[:5] for line in lines if len(line) > 14], float)
    time = np.arange(14.8 * 60, 48.9 * 60, 15.0)
    work = np.array([any(60 * b <= t < 60 * b + 300 for b in (15, 24, 33, 42)) for t in time])
    record = {"time": time, "watts": 265.0 * work, "uptake": np.interp(time, 60 * rows[:, 0], rows[:, 3])}
    return [{k: v[:70] for k, v in record.items()}], [{k: v[70:] for k, v in record.items()}]
