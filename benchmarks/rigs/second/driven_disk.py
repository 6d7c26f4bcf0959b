"""A disk on springs is driven by a motor whose frequency rises slowly; magnets 3 mm away brake it.

Angles of disk and driver every 40 ms (of 20), pieces of 16 s; four are learned, three between them are unseen.
"""

import numpy as np

REPOSITORY = "TravisHester-L/AdvLab-Lab03"
COMMIT = "093d38ae7d2966e9f2d727a75fbaddb4e091f21b"
FILES = {"data/raw/Run2_3mm.csv": "d6d76ad1b4f01b1edfe718b0da65f4a596b7d18d3189fc60847277a47e3cdda0"}


def read_trials(files):
    """Learned and unseen trials."""
    lines = files["data/raw/Run2_3mm.csv"].decode("utf-8-sig").splitlines()[1:]
    rows = np.array([line.split(",")[:3] for line in lines if all(line.split(",")[:3])], float)

    def cut(begin):
        piece = rows[(rows[:, 0] >= begin) & (rows[:, 0] < begin + 16)][::2]
        return {"time": piece[:, 0], "driver": piece[:, 2], "disk": piece[:, 1]}

    return [cut(begin) for begin in (200, 420, 500, 640)], [cut(begin) for begin in (330, 460, 560)]
