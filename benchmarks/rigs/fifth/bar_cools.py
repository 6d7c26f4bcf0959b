"""A heated metal bar cools in a room: temperature of the bar and of the room, every 10 s.

Recorded every 1.7 s. A piece of 690 s is learned, one of 780 s from the same cooling, 8 minutes later, is unseen.
"""

import io

import numpy as np

REPOSITORY = "gomezferrerf/experimental-newton-cooling-law"
COMMIT = "d03d13936d72168fe93fe9d2d82f9e441e3315db"
FILES = {
    "datos/temperaturas.csv": "4d34c72251b6ff9484a513192457430aa875fecf7dad50b81db7b4084347c3db",
}
MEASURED = "8a06bbf1b25933a3ec9dde492c70923016a6d655512139c090b5800b827125e4"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    rows = np.genfromtxt(io.StringIO(content.decode()), delimiter=",", skip_header=1)
    pieces = []
    for begin, end in ((405.0, 1095.0), (1605.0, 2385.0)):
        seconds = np.arange(begin, end, 10.0)
        near = [np.abs(rows[:, 0] - s) <= 5 for s in seconds]
        columns = {c: np.array([rows[n, k].mean() for n in near]) for c, k in (("room", 4), ("bar", 1))}
        pieces.append({"time": seconds - seconds[0], **columns})
    return pieces[:1], pieces[1:]
