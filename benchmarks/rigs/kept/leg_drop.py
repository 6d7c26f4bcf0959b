"""A lower leg is dropped from horizontal and swings (pendulum test of the knee).

One swing, its first 5 s are learned.
"""

import io

from scipy.io import loadmat

REPOSITORY = "VDB-Bram/Tutorial-Direct-Collocation"
COMMIT = "b45b84c8cf2416fee977217568fb061e8c429ed6"
FILES = {"DataPendulum.mat": "cec186308ca597723d978d8f5c61d573ae7fe66adc30b38f5912a98a28b05240"}


def read_trials(files):
    """Learned and unseen trials."""
    table = loadmat(io.BytesIO(files["DataPendulum.mat"]))["data"][25:780]
    swing = {"time": table[:, 0], "angle": table[:, 1]}
    return [{k: v[:500] for k, v in swing.items()}], [{k: v[500:] for k, v in swing.items()}]
