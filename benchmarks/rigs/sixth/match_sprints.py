"""A player sprints again and again in a match: speed from a position system, every 0.1 s.

Each sprint from 1.5 m/s to its greatest speed. Five are learned, five others are unseen. The speeds stand as a vector
inside a saved R table.
"""

import gzip

import numpy as np

REPOSITORY = "aaronzpearson/midsprint"
COMMIT = "99078015089713cc4110aa3370248559e33f06f4"
FILES = {
    "data/player_a.rda": "2b93435e0d7acefbb544ded93a8c44a9c91035cbab965c55c42c6edfd594bb9e",
}
SPRINTS = {256: 283, 747: 770, 968: 991, 1272: 1298, 1562: 1594, 671: 696, 858: 889, 1022: 1048, 1442: 1475, 2511: 2535}
MEASURED = "172fc3fe02bb546e961e73a642ca2e20488d1e34e10860ab1dc43799bc57b2dc"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    table = gzip.decompress(content)
    speed = np.frombuffer(table, ">f8", 2728, table.index(b"\x00\x00\x00\x0e\x00\x00\x0a\xa8") + 8).astype(float)
    trials = []
    for begin, end in SPRINTS.items():
        sprint = speed[begin : end + 1]
        sprint = sprint[np.argmax(sprint >= 1.5) :]
        trials.append({"time": np.arange(len(sprint)) * 0.1, "speed": sprint})
    return trials[:5], trials[5:]
