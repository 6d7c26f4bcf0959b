"""The left foot of a person who walks: rates of turn by gyroscopes on the shoe, pitch by cameras, every 20 ms.

The gyroscopes are recorded at 204.8 Hz, the cameras at 100 Hz. Six pieces of 3 s are learned, three others are unseen.
"""

import io

import numpy as np

REPOSITORY = "mad-lab-fau/gaitmap"
COMMIT = "05ad9716161cdfeb4ba9fcb28eb796df0420e48d"
FILES = {
    "example_data/imu_sample.csv": "fdb91f0a1e58b1ac518a324d38c9177de6c4388137c1b1683e4a72460873bfd7",
    "example_data/mocap_sample.csv": "e27e89a75b38cb53520385eb252786c951a74a8f4a3d252322330ab672f6c00e",
}
MEASURED = "2b3f22b70621b79e61e8ca502f47ca267fefd1591f7317dffaeeabacf9e5fff1"


def read_trials(files):
    """Learned and unseen trials."""
    sensor, cameras = (np.genfromtxt(io.StringIO(c.decode()), delimiter=",", skip_header=2) for c in files.values())
    along = cameras[:, 1:4] - cameras[:, 7:10]
    pitch = np.degrees(np.arctan2(along[:, 2], np.hypot(along[:, 0], along[:, 1])))
    turns = [np.interp(np.arange(len(pitch)) / 100, np.arange(len(sensor)) / 204.8, sensor[:, c]) for c in (7, 9, 11)]
    pieces = []
    for begin in (300, 600, 900, 1200, 1950, 2250, 2550, 2850, 3100):
        cut = slice(begin, begin + 300, 2)
        columns = dict(zip(("gx", "gy", "gz"), (turn[cut] for turn in turns), strict=True))
        pieces.append({"time": np.arange(150) * 0.02, **columns, "pitch": pitch[cut]})
    return pieces[0::3] + pieces[1::3], pieces[2::3]
