"""Ball on a beam (DaISy): angle of the beam and position of the ball every 0.1 s, pieces of 6 s."""

import numpy as np

REPOSITORY = "Rafa7046/Non_Linear_Identification"
COMMIT = "e5c9b006b0a2ec1650bc018a5fb38d2f4363d4c7"
FILES = {"src/data/ball-and-beam.csv": "07c1ba1f2facdf8045a49d368a99f01e3ff261b12acb1fe3c934917bc2753170"}


def read_trials(files):
    """Learned and unseen trials."""
    rows = files["src/data/ball-and-beam.csv"].decode().split()[1:]
    angle, place = np.array([row.split(",") for row in rows], float).T
    pieces = [
        {"time": 0.1 * np.arange(60), "tilt": angle[i : i + 60], "place": place[i : i + 60]} for i in range(20, 920, 60)
    ]
    return pieces[:10], pieces[10:]
