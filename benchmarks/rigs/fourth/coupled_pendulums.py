"""Two pendulums joined by a spring, one of them let go: places of both in steps of a converter, every 0.1 s (of 0.05).

The first 36 s are learned, the next 24 s are unseen. The two places are read in turn: both are brought to the same
times by splines.
"""

import io

import numpy as np
from scipy.interpolate import CubicSpline

REPOSITORY = "samudpa/physics-lab"
COMMIT = "793ae8feaa5a7e5aebf1cdc94be94566faeec827"
FOLDER = "lab1/second_semester/oscillazioni_accoppiate/data/"
FILES = {
    FOLDER + "coupled_pendulum_beats.txt": "93a9e074117d0efbe242658159137511b276e3b96c6ef19e26804e9ab561af99",
}
MEASURED = "1b461df35daea15199886ab5cd15df45d921aae69646924a75da7bd58be4a7cc"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    first, left, second, right = np.loadtxt(io.StringIO(content.decode()), unpack=True)
    time = np.arange(2.0, 62.0, 0.1)
    columns = {"time": time, "left": CubicSpline(first, left)(time), "right": CubicSpline(second, right)(time)}
    return [{k: v[:360] for k, v in columns.items()}], [{k: v[360:] for k, v in columns.items()}]
