"""A person sprints and brakes in a wheelchair, wheel that measures: moment on the rim, angle and speed of the wheel.

Recorded every 1/240 s, here the mean of each tenth of a second. Three sprints of 7 to 10 s are learned, one is unseen.
"""

import io

import numpy as np

REPOSITORY = "felixchenier/kineticstoolkit"
COMMIT = "6aa3a6e0c0982586002e6e4071d827425b9e853d"
FILES = {
    "data/timeseries/smartwheel.csv": "9d3b9ab32e7d522a7fc2117b6ec3ac1db00f40601db539668a6c6a0c2893cd16",
}
MEASURED = "d57ac5122b16b0d03245bed57c0c22cc0b78680dccd179fe6bb0881291e059b2"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    rows = np.genfromtxt(io.StringIO(content.decode()), delimiter=",")
    angle = np.unwrap(np.radians(rows[:, 3]))
    sprints = []
    for begin, end in SPRINTS:
        first, count = int(begin * 240), int((end - begin) * 10)
        cut = slice(first, first + count * 24)
        moment = rows[cut, 23].reshape(count, 24).mean(1)
        turned = angle[cut].reshape(count, 24).mean(1)
        speed = np.array([np.polyfit(np.arange(24) / 240, part, 1)[0] for part in angle[cut].reshape(count, 24)])
        time = np.arange(count) * 0.1
        sprints.append({"time": time, "moment": moment, "angle": turned - turned[0], "speed": speed})
    return sprints[:3], sprints[3:]


SPRINTS = ((9.6, 18.0), (25.0, 33.0), (38.6, 46.0), (53.6, 61.0))
