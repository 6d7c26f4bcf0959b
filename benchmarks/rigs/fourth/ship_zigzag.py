"""A model of a tanker of 7 m is steered to and fro in a basin: angle of the rudder, heading, yaw rate, every 0.5 s.

Zigzag tests, recorded every 0.05 s: two (the rudder at 10 and 15 degrees) are learned, two others at 10 degrees are
unseen; 60 s of each, from 8 s on.
"""

import io

import numpy as np

REPOSITORY = "martinlarsalbert/System-identification-of-Vessel-Manoeuvring-Models"
COMMIT = "4b7ce53f0cc8ac159126fdda7d45e30c540be2d8"
FOLDER = "data/01_raw/kvlcc2_hsva/raw_data/HSVA_CPMC_KVLCC2_Z_"
FILES = {
    FOLDER + "10_05.dat": "db2b9921264d4a2b998d259d001adb016c7368dd7ac1772dbeb96037875469b3",
    FOLDER + "15_05.dat": "d9e4c4669fabe7c05c6c701909f904564fd2a5a6454bbec6bf4ae5921000b140",
    FOLDER + "10_10_S.dat": "8b83dc0d1eea93f96a60d1a5d8d60f8b23c2f55b356d8b45d3f9a1cbdf94fb90",
    FOLDER + "10_01.dat": "2b2b11bc5732e45eba96bf61fcf8ef6d97b40c67cb424cf636cd58d8285a0425",
}
MEASURED = "72fab3663ca70da08ae7155d1c7f7ecb33ab6827eacafb50145e8b14256bb173"


def read_trials(files):
    """Learned and unseen trials."""
    tests = []
    for content in files.values():
        lines = content.decode("latin1").splitlines()[4:]
        rows = np.loadtxt(io.StringIO("\n".join(lines)))[160:1360:10]
        columns = {"rudder": rows[:, 8], "heading": rows[:, 3], "turn": rows[:, 6]}
        tests.append({"time": np.arange(len(rows)) * 0.5, **columns})
    return tests[:2], tests[2:]
