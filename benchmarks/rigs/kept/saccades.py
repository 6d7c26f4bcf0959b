"""A person looks at a dot that jumps left and right.

Direction of the gaze from eye-tracking glasses, pieces of 10 s at 24 ms.
"""

import io

import numpy as np

REPOSITORY = "mrdving/BioInstrumentation-EOG-2022"
COMMIT = "8742dbcf1e05d11d44c4ab7cb2c95e12bb24b6cb"
FILES = {"DataSet/EOG_S1.txt": "a41b525d9eeac5e03afa2b2ef45ef98b75747c869810b4d7f01007fb295566d9"}


def read_trials(files):
    """Learned and unseen trials."""
    table = np.genfromtxt(io.BytesIO(files["DataSet/EOG_S1.txt"]), delimiter=",", names=True)
    table = table[table["TIME"] > 0]
    clock, target, gaze = table["TIME"], np.rad2deg(table["STIM"]), table["GAZE_INTERPOLATED"]
    seen = ~np.isnan(gaze)

    def cut(begin):
        time = np.arange(begin, begin + 10, 0.024)
        shown = np.clip(np.searchsorted(clock, time, side="right") - 1, 0, None)
        return {"time": time, "target": target[shown], "gaze": np.interp(time, clock[seen], gaze[seen])}

    return [cut(20 + 10 * i) for i in range(4)], [cut(60 + 10 * i) for i in range(2)]
