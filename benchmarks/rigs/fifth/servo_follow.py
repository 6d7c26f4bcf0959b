"""A joint with a servo follows commands that jump and run up and down by 0.1: command and angle, every 20 ms.

Three tests of 2 s are learned (pseudo-random of 3 s, triangle, square), two others are unseen.
"""

import json

import numpy as np

REPOSITORY = "mauicv/servo-sysid"
COMMIT = "e4a48407899108cae084ff25e8b5d12e3da070cc"
FILES = {
    "src/sysid/dataset/real-action-state-dataset.json": (
        "f676b2acc8672603161031aeca2bc16e847970cd59ac19c20bf7f558191a9d8d"
    ),
}
MEASURED = "156c0b8f7fd8664589e74497712e5855ff3f9dc3cb13e22873931a8e58a6a460"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    tests = []
    for number in (11, 20, 26, 21, 27):
        test = json.loads(content)["data"][number]
        command, angle = (np.array(test[c], float) for c in ("actions", "sensor_data"))
        tests.append({"time": np.arange(len(angle)) * 0.02, "command": command, "angle": angle})
    return tests[:3], tests[3:]
