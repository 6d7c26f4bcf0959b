"""A drone with four rotors, held so that it can only pitch: commands of its rotors and pitch, mean of each 40 ms.

For 10 s each rotor has a command of its own, then all are off for 3 s. The commands are given as the drive: rotors two
and four less rotors one and three, over 1000. Four tests are learned, three others are unseen.
"""

import io

import numpy as np

REPOSITORY = "prakharsethi17/Attitude-Control-of-Quadcopter"
COMMIT = "9cb7ac3c1646f81385dd4b9cd0f85157960d4ea9"
FOLDER = "Decoupled 3-DoF/Pitch/Exp 2/random_"
FILES = {
    FOLDER + "0.csv": "8b4d63e7f6d25ec07cab6e03e9bb2b654a3130de54b8f99604ccd0e48748854d",
    FOLDER + "1.csv": "cc25a938b5a208fa7e555f286e159b0bc58e48f6d16b9c88c99aca3e36a2b7db",
    FOLDER + "12.csv": "2fbea5bbdbf65a3920c8ffc36f568a5da7a5774a7c5d33b0193b158fbcf1528a",
    FOLDER + "15.csv": "0eadfe3221f11bcc6f2f39ca005b392ebdd716b9bd4ada83ee17ca009a4825fb",
    FOLDER + "10.csv": "d6b27de802d8f3ab727a26c01dc3240093a1569c748acf3c2fcd62bbc93f2415",
    FOLDER + "17.csv": "8a93477814ba7baf56905a6184e5b2e6b1401949fbe37c4146bcdd6b46a2543d",
    FOLDER + "18.csv": "4a4e7d05f62f2e20503b2f12d76b5ed2d50617885a6fc7039998936ea3d548cc",
}
MEASURED = "bd53844db0ca4d8d1bbf4d7cc8b805d40217877e24df57ea2ca4f8b2171d0447"


def read_trials(files):
    """Learned and unseen trials."""
    tests = []
    for content in files.values():
        lines = [line for line in content.decode("latin1").splitlines() if line[:1] in set("-0123456789")]
        rows = np.genfromtxt(io.StringIO("\n".join(lines)), delimiter=",")[2:1298].reshape(324, 4, 6).mean(1)
        drive = (-rows[:, 2] + rows[:, 3] - rows[:, 4] + rows[:, 5]) / 1000
        tests.append({"time": np.arange(324) * 0.04, "drive": drive, "pitch": rows[:, 0]})
    return tests[:4], tests[4:]
