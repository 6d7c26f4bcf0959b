"""An older person stands on two force plates: force and centre of pressure of both feet, forwards, every 40 ms.

The force is turned round: it is the one on the person. Eight pieces of 3 s are learned, four between them are unseen.
"""

import io

import numpy as np

REPOSITORY = "rikasd/zIP_poststroke"
COMMIT = "135486194d300354709ee1cab2d3cd89d11a3063"
FILES = {
    "data_raw/Control 15 trial 1.txt": "a929d031537d9aeb5910ccbd858167fc45b1e0af5b6eaf3a0fc20f6468ef01f3",
}
MEASURED = "b5a4200ca57dad6b2c718f8d031402694aab38c9beeabbbef380eb4621403b94"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    rows = np.loadtxt(io.StringIO(content.decode()), skiprows=1).T
    force, load = -rows[1] - rows[4], rows[2] + rows[5]
    centre = 100 * (rows[2] * rows[3] + rows[5] * rows[6]) / load
    cuts = [slice(begin, begin + 300, 4) for begin in range(50, 5600, 460)][:12]
    pieces = [{"time": np.arange(75) * 0.04, "force": force[cut], "pressure": centre[cut]} for cut in cuts]
    return pieces[0::3] + pieces[1::3], pieces[2::3]
