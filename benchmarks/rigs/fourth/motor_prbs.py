"""A small motor, its voltage switched between two levels at random: speed from an encoder, every 40 ms (of 20).

Pieces of 10 s: four are learned, three others are unseen.
"""

import io

import numpy as np

REPOSITORY = "nebisman/UNDCMotor"
COMMIT = "0983b07c9ccd6993d6ea83b64e7a53828953090c"
FOLDER = "code/python_code/unmotor/datafiles/"
FILES = {
    FOLDER + "DCmotor_prbs_open_exp.csv": "3b476188fae482a5740058b2db8483775bb7432fc4cf3cddd05aa0ed0f0afd9f",
}
MEASURED = "e199614bca8c8f26b2268691368e8d02cf39ecd77f09260cf0494d9e9df9755e"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    _, voltage, speed = np.loadtxt(io.StringIO(content.decode()), delimiter=",", skiprows=1, unpack=True)
    cuts = [slice(begin, begin + 500, 2) for begin in range(200, 3700, 500)]
    pieces = [{"time": np.arange(250) * 0.04, "voltage": voltage[cut], "speed": speed[cut]} for cut in cuts]
    return pieces[0::2], pieces[1::2]
