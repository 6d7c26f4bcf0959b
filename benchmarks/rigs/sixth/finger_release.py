"""A finger joint is bent by another person and let go: its angle from cameras, every 6.7 ms.

One trial: the first 0.28 s are learned, the last 0.12 are unseen.
"""

import io

import numpy as np

REPOSITORY = "PanosTsakonas/Fitting_Matrix"
COMMIT = "b69617882917c7c90155ec0d89e91dc653c58caf"
FILES = {
    "Profile likelihood/New_data.csv": "699f8a53219325ab99d1f26d7bdd7bb087598020052bd62c5234d2afdf3e8a7c",
}
MEASURED = "0bbfbb70489ab8a00286a89c9076271878c55c7bdd2ed1b3f0486a2a85a0338e"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    rows = np.genfromtxt(io.StringIO(content.decode()), delimiter=",", skip_header=1)
    run = {"time": np.arange(60) / 150, "angle": rows[:60, 1]}
    return [{c: v[:42] for c, v in run.items()}], [{c: v[42:] for c, v in run.items()}]
