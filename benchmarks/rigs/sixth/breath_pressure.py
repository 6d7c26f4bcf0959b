"""A patient on a ventilator breathes by a set flow: flow at the mouth and pressure there, every 20 ms.

Three breaths of 4 s are learned (the second and third with a pause before the air goes out), three others are unseen.
"""

import numpy as np

REPOSITORY = "hahnicity/ventMAP"
COMMIT = "6f881a95adc78c4a84c4d3f82ca08e773192bfc8"
FILES = {
    "ventmap/tests/samples/jimmy-example-data.csv.test": (
        "299199aa070c714f6f4dd4f2c8589cea975e48ea90d5b516ddbf52fa456fc4ad"
    ),
}
MEASURED = "4938480704f26f020f844bd485ce538e6b8da874f30c6db6d7fbf28aa3cc6689"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    breaths = []
    for piece in content.decode().split("BS, S:")[1:]:
        lines = [line for line in piece.splitlines()[1:201] if line.count(",") == 1]
        breaths.append(np.array([line.split(",") for line in lines], float))
    breaths = [b for b in breaths if len(b) == 200]
    trials = [
        {"time": np.arange(200) * 0.02, "flow": breaths[k][:, 0] / 60, "pressure": breaths[k][:, 1]}
        for k in (1, 4, 7, 2, 12, 13)
    ]
    return trials[:3], trials[3:]
