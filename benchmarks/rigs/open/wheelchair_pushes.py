"""A person propels a wheelchair: torque and angle of an instrumented wheel, 8 s pieces at 20 ms."""

import io

import numpy as np

REPOSITORY = "rickdkk/worklab"
COMMIT = "9c154f0d913741297b9faf9a134697ca5c639df6"
PATH = "docs/chapters/examples/example_data/Optipush_example.data"
FILES = {PATH: "ed521722e69a8c57e875300ebcaf285760bc828962021eb52d4304d27fa17919"}


def read_trials(files):
    """Learned and unseen trials."""
    table = np.loadtxt(io.BytesIO(next(iter(files.values()))), comments="%")
    table = np.column_stack([table[:, 0], -table[:, 8], np.unwrap(np.deg2rad(table[:, 9]))])
    time, torque, angle = table[: len(table) // 4 * 4].reshape(-1, 4, 3).mean(axis=1).T

    def cut(begin):
        part = (time >= begin) & (time < begin + 8)
        return {"time": time[part], "torque": torque[part], "turned": angle[part] - angle[part][0]}

    return [cut(2 + 8 * i) for i in range(6)], [cut(50 + 8 * i) for i in range(4)]
