"""A person rides up and down in a lift with a phone: vertical acceleration and pressure of the air, every second.

The acceleration (recorded 26 times a second) is the mean of each second. A ride up and one down are learned, a ride up
and one down on another day are unseen.
"""

import io

import numpy as np

REPOSITORY = "Sascha-no-idea/elevator-movement-evaluation"
COMMIT = "a15ecb594f27dde6a5ab7d3480f6febf7fbcf6d0"
FOLDER = "measurements/series_"
FILES = {
    FOLDER + "2/Acceleration.csv": "2a723cde139d31ddb15c89726d9f84f9cba43fcec46e4a46a0f0cfad2b65bdb9",
    FOLDER + "2/Pressure and velocity.csv": "2c2d135ffca92f1934ba4a00e849cc1e8266fe1bf810d0879c658558b8ef951e",
    FOLDER + "1/Acceleration.csv": "ca0956ada0ee66bf76f698feae96230ee9ee0ad42d81b4b180d617909e334283",
    FOLDER + "1/Pressure and velocity.csv": "d2536b54520e4743360378a36beedeb70009bb9bbab616a50964deb4e3d049ae",
}
RIDES = ((19, 58), (60, 100)), ((20, 62), (62, 104))
MEASURED = "685c16e2df94509af17c979ce2a9efb4762bedec3b9216ffab271e8f963c80e6"


def read_trials(files):
    """Learned and unseen trials."""
    tables = [np.genfromtxt(io.StringIO(c.decode()), delimiter=",", skip_header=1) for c in files.values()]
    series = []
    for acceleration, air, rides in zip(tables[::2], tables[1::2], RIDES, strict=True):
        cuts = []
        for begin, end in rides:
            seconds = np.arange(begin, end)
            near = [np.abs(acceleration[:, 0] - s) <= 0.5 for s in seconds]
            mean = np.array([acceleration[n, 1].mean() for n in near])
            pressure = 100 * np.interp(seconds, air[:, 0], air[:, 1])
            cuts.append({"time": seconds - seconds[0] + 0.0, "acceleration": mean, "pressure": pressure})
        series.append(cuts)
    return series
