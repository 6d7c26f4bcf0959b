"""The eye of a monkey jumps between places of a dot: scleral search coil, 500 Hz (of 1000), 0.2 s around each jump.

The dot's place was not recorded: it is taken as where the eye rests afterwards, from the moment when the eye starts.
Eight jumps are learned, six later ones are unseen.
"""

import io

import numpy as np
from scipy.io import loadmat

REPOSITORY = "lit24/primateEyeTracker_Data"
COMMIT = "3d1b63ad15969619c3170d54443e4bb8f6c57d97"
FILE = "data/DataProcessing/Testdata_Coil_Horizontal.mat"
FILES = {FILE: "6ec206506f46dd647574eb176599a637d908ca44402edc3fb1d9b313a07ad9ca"}


def read_trials(files):
    """Learned and unseen trials."""
    eye = loadmat(io.BytesIO(files[FILE]), squeeze_me=True)["saccadeTracking"]
    far = np.flatnonzero(np.abs(eye[40:] - eye[:-40]) > 3)
    jumps = []
    for begin in far[np.r_[True, np.diff(far) > 300]]:
        piece = eye[begin - 50 : begin + 150]
        moved = np.flatnonzero(np.abs(piece[5:] - piece[:-5]) > 0.3)[0]
        rest = np.median(piece[-60:])
        dot = np.where(np.arange(200) < moved, np.median(piece[:50]), rest)
        if np.abs(piece[-60:] - rest).max() < 0.15 and moved < 100:
            jumps.append({"time": np.arange(100) * 0.002, "dot": dot[::2], "eye": piece[::2]})
    return jumps[:8], jumps[8:14]
