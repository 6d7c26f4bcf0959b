"""A fidget spinner runs down in front of a camera.

Blade frequency of the brightness in windows of 1 s, every 0.5 s; its later part is unseen.
"""

import io

import numpy as np
from scipy.io import loadmat

REPOSITORY = "xavieryn/P1"
COMMIT = "326637d947a342333bda49b98b521b54f23b9b7f"
FILES = {"IMG_9567.MOV.mat": "e0b6a5126a360dfea8dfa1e5c9e62b887a0978fe69d75bd61b491ccd9489e5c0"}


def read_trials(files):
    """Learned and unseen trials."""
    film = loadmat(io.BytesIO(files["IMG_9567.MOV.mat"]), squeeze_me=True)
    light, rate = film["y"].astype(float), float(film["Fs"])
    window, step = int(rate), 30
    grid, blades = np.fft.rfftfreq(16 * window, 1 / rate), []
    for begin in range(int(13 * rate), int(70 * rate), step):
        part = light[begin : begin + window]
        power = abs(np.fft.rfft((part - part.mean()) * np.hanning(window), 16 * window))
        top = np.argmax(power * (grid > 0.7))
        bend = np.polyfit(grid[top - 1 : top + 2], power[top - 1 : top + 2], 2)
        blades.append(-bend[1] / bend[0] / 2)
    run = {"time": np.arange(len(blades)) * step / rate, "blades": np.array(blades)}
    return [{k: v[:70] for k, v in run.items()}], [{k: v[70:106] for k, v in run.items()}]
