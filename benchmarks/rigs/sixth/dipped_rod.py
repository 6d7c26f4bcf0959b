"""A thermometer is moved from one water bath to another: temperature of the bath and of the thermometer.

Recorded every 10 ms as a voltage, here the mean of each 0.1 s in degC (a straight line through the twelve baths). Each
trial begins when the thermometer is in the new bath. Two into warm and two into cold water are learned, one of each is
unseen.
"""

import numpy as np

REPOSITORY = "linnil1/2017_BIME_sensor"
COMMIT = "2f0e4c19e16b77036b390c7e3db6e897e5d1442b"
FILES = {
    "lab05/lab05log7.txt": "8d973cb375dfca9b239d1d7bbaab808e9cf951498a29d3c4a1d29c5a0c253415",
    "lab05/lab05log8.txt": "fccbda38292a9284d5d92cad53a290c68afa1eacf501624f494a5f6f11858db0",
    "lab05/lab05log9.txt": "2ae2db829ca07c4e1cb799455bb24ea030a3d372af601e72c625e4f84d7d332e",
    "lab05/lab05log10.txt": "efdd423227b9ff37f7fc46b7a2e8d5098e61ee5a99c53b386786082ca6a68cf6",
    "lab05/lab05log11.txt": "fc9705bed44651f8cc67959be18a4c1368626fa63e69ec50d13eff56200c11fd",
    "lab05/lab05log12.txt": "c0abdb0cdb93954fe5f781729994e13685bde96daca43c3a5e05c9bd2b03b683",
}
BATHS = ((170, 56.0), (160, 21.0), (280, 76.0), (190, 22.0), (210, 68.0), (190, 22.0))  # first sample, degC
MEASURED = "57d3d3fc0dea9b07fdf4c5348cb899083a7e40a10785e3d7c62517e2414423a7"


def read_trials(files):
    """Learned and unseen trials."""
    trials = []
    for content, (begin, bath) in zip(files.values(), BATHS, strict=True):
        volts = np.array([line.split()[2] for line in content.decode().splitlines() if line.strip()], float)
        thermometer = 114.7775 + 3074.17 * volts[begin : begin + 1160].reshape(116, 10).mean(1)
        trials.append({"time": np.arange(116) * 0.1, "bath": np.full(116, bath), "thermometer": thermometer})
    return trials[:4], trials[4:]
