"""The belt of a treadmill that measures force is sped up and slowed at random, nobody on it.

Acceleration of the belt and pitch moment on the frame, both low-passed at 3 Hz without lag, every 30 ms, for 12 s.
Four of one recording are learned, three of another one are unseen.
"""

import io

import numpy as np
from scipy.signal import butter, sosfiltfilt

REPOSITORY = "csu-hmc/pitch-moment-compensation"
COMMIT = "b00571b2207fdf68adbd190f0cca5d629f8a7021"
FILES = {
    "Data/RandomFastSpeed1.txt": "166d8f2be5778ca2e0dc5b3c39bb5afb521505a01d01386699c9775f833f8d59",
    "Data/RandomFastSpeed2.txt": "755b6823a94230f21ba091228db3bdf9e4cd92e47bc7485129ab8463c01b9d0c",
}


def read_trials(files):
    """Learned and unseen trials."""
    pieces = []
    for content in files.values():
        clock, moment, speed = np.genfromtxt(io.BytesIO(content), skip_header=1).T
        time = np.arange(0, 349.9, 0.01)
        smooth = [
            sosfiltfilt(butter(2, 3 / 50, output="sos"), np.interp(time, clock, signal)) for signal in (moment, speed)
        ]
        faster = np.append(np.diff(smooth[1]), 0) / 0.01
        for begin in (2000, 8000, 14000, 20000):
            cut = slice(begin, begin + 1200, 3)
            pieces.append({"time": time[cut], "acceleration": faster[cut], "moment": smooth[0][cut]})
    return pieces[:4], pieces[4:7]
