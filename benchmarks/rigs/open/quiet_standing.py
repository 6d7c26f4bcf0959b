"""A person stands still for 60 s: centre of gravity before the ankles, 20 Hz; the first 40 s are learned."""

import io

import numpy as np

REPOSITORY = "BMClab/BMC"
COMMIT = "fa66686132feea98ada3048cc83287d1cf60ba9d"
FILES = {"data/postureData.txt": "592b7945ce8fd87713ce5df3d2c3cee19f063f4bc707a35360e6c6b34391d370"}


def read_trials(files):
    """Learned and unseen trials."""
    table = np.genfromtxt(io.BytesIO(files["data/postureData.txt"]), delimiter=",", names=True)[::5]
    ahead = 1000 * (table["COG_X"] - (table["RAnkle_X"] + table["LAnkle_X"]) / 2)
    stance = {"time": table["Time"], "ahead": ahead}
    return [{k: v[:800] for k, v in stance.items()}], [{k: v[800:] for k, v in stance.items()}]
