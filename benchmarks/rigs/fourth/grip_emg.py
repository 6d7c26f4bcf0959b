"""A person squeezes a ball: muscles of the forearm (rectified, mean of eight electrodes) and force, every 0.1 s.

Recorded at 200 Hz; the first 60 s are learned, the 40 s after them are unseen.
"""

import io

import numpy as np
from scipy.io import loadmat

REPOSITORY = "brunoodutra/My_Thesis"
COMMIT = "5c1083b2b0562f8471640ee10c8a207c9bf2803a"
FOLDER = "EMG_Data_and_Force_signals/EMG_force_datalog/"
FILES = {
    FOLDER + "recording_force_v2.mat": "9602edd952f3100d9a55a1efe82def5977c552d129f04a00f1f13e023abdcb33",
}
MEASURED = "34fce125d0e080b49d3315ccb14caa5f7c9d31b8a0ae434db0001d3c0d082db6"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    record = loadmat(io.BytesIO(content), squeeze_me=True)
    blocks = {
        "muscles": np.abs(record["emg"].astype(float)).mean(1)[:20000].reshape(-1, 20).mean(1),
        "grip": record["Force"].astype(float)[:20000].reshape(-1, 20).mean(1),
    }
    columns = {"time": np.arange(1000) * 0.1, **blocks}
    return [{k: v[:600] for k, v in columns.items()}], [{k: v[600:] for k, v in columns.items()}]
