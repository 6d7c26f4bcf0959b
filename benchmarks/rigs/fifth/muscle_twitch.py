"""A muscle twitches, held at one length: pulse to its nerve and force, every 1 ms.

Recorded every 0.1 ms. Each twitch is stronger than the one before; the pulse is scaled by the height of the twitch, and
the force at rest is taken from the time before it. Two twitches are learned, one is unseen.
"""

import io

import numpy as np

REPOSITORY = "ropensci/workloopR"
COMMIT = "2ed0f7f1081e4decdd108218a2f9c5f566965353"
FOLDER = "inst/extdata/twitch_csv/"
FILES = {
    FOLDER + "twitch002.ddf.csv": "a3a5e68205b6c5e780becc0384cbaa0a716a0b8b68842180a7fa88928c462081",
    FOLDER + "twitch004.ddf.csv": "623ceaa61bb9a2108fe8fbc9b4725d3c82b8188b722c44f62093bb8364226d79",
    FOLDER + "twitch003.ddf.csv": "c5fd8d401d960c766f6781d9e218a1c43ba2ef4454dfae63906a61ed5d0fb5b7",
}
MEASURED = "a2449f69087bee9619e6d1cdfbc01ca5cfdfdd9d3d9a9f0f5c965edf44a38183"


def read_trials(files):
    """Learned and unseen trials."""
    twitches = []
    for content in files.values():
        rows = np.genfromtxt(io.StringIO(content.decode()), delimiter=",", skip_header=1)[900:2500]
        force = rows[:, 2].reshape(160, 10).mean(1)
        rest = force[:9].mean()
        pulse = (rows[:, 3].reshape(160, 10).max(1) > 0) * (force.max() - rest)
        twitches.append({"time": np.arange(160) * 0.001, "pulse": pulse, "force": force - rest})
    return twitches[:2], twitches[2:]
