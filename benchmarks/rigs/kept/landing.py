"""Landing from a squat jump (learned) and from a countermovement jump (unseen).

Mean height of the two hip joints from the apex on, 100 Hz.
"""

import numpy as np
from record import read_sheet

REPOSITORY = "geigermartin/motionCapture_inverseDynamics"
COMMIT = "6d898105be9c42873059e08ba61cc5200bf4ce43"
FILES = {
    "project/Gelenksdaten06.xlsx": "2bb559afbd36f21556ca91c1d606873e43fece1569e75df04bddd3c3679d83aa",
    "project/Gelenksdaten08.xlsx": "979eb2f540d362a6467485223ca43b0a36c2d38417ad62d0978c4045d24c7d56",
}


def read_trials(files):
    """Learned and unseen trials."""
    jumps = []
    for content, samples in zip(files.values(), (70, 58), strict=True):
        rows = [r for r in read_sheet(content)[3:] if "D" in r and "L" in r]
        hip = np.array([float(r["D"]) + float(r["L"]) for r in rows]) / 2000
        hip = hip[np.argmax(hip) :][:samples]
        jumps.append({"time": np.arange(samples) / 100, "hip": hip})
    return jumps[:1], jumps[1:]
