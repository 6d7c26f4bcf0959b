"""A sensor is turned to one side, to the other and back: rate from its gyroscope, tilt from its accelerometer.

Recorded every 10 ms, here every 40 ms. Three turns of 4 s about one axis are learned, three about another are unseen.
"""

import io

import numpy as np

REPOSITORY = "xioTechnologies/Fusion"
COMMIT = "d69784c8f7058a6545802b8852d26d6fcfd5e119"
FILES = {
    "Examples/Python/sensor_data.csv": "a2833a207b4c0c51d52ee62e42069d1a11cf94b1aca1cd46a54d5e8fce577dcd",
}
MEASURED = "3a715c5ee8292361d9aaf258527492fa8be7490f1493e48b29826cdfbf8b9075"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    time, *columns = np.genfromtxt(io.StringIO(content.decode()), delimiter=",", skip_header=1).T
    x, y, z = columns[3:6]
    turns = []
    for begins, rate, tilt in (
        ((14.3, 18.7, 23.5), columns[0], np.arctan2(y, z)),
        ((29.0, 33.5, 38.5), columns[1], np.arctan2(-x, z)),
    ):
        for begin in begins:
            seconds = np.arange(100) * 0.04
            near = [np.abs(time - begin - s) <= 0.02 for s in seconds]
            means = {c: np.array([v[n].mean() for n in near]) for c, v in (("rate", rate), ("tilt", np.degrees(tilt)))}
            turns.append({"time": seconds, **means})
    return turns[:3], turns[3:]
