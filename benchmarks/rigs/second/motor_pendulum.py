"""A motor swings a pendulum up to the top: angle and torque of the motor, averaged over 20 ms.

Two ways up are learned, a third one is unseen.
"""

import io

import numpy as np

REPOSITORY = "dfki-ric-underactuated-lab/torque_limited_simple_pendulum"
COMMIT = "ed17ea2d32a35ad944944ca03ef57693e2986732"
RUN = "results/control_method_"
FILES = {
    RUN + "ddp/data_measured.csv": "14748fd189abae7b6392a016f2f0494b54bb2a8c014bc435a84b58dbecb2da35",
    RUN
    + "pd/system_identification/data_measured.csv": "3a5728e9c5530dd9066c0d7fda4c6a9bf50d86f94538629ace6d2508a7053469",
    RUN + "direct_collocation/data_measured.csv": "c3f990980169815b93ab37078780e13803327dcb6fc9e019f2d261b988cdaf8f",
}


def read_trials(files):
    """Learned and unseen trials."""
    trials = []
    for content in files.values():
        table = np.genfromtxt(io.BytesIO(content), delimiter=",", skip_header=1)
        clock = table[:, 0] - table[0, 0]
        time = np.arange(0, clock[-1] - 0.01, 0.02)
        torque = [table[(clock >= t - 0.01) & (clock < t + 0.01), 3].mean() for t in time]
        trials.append({"time": time, "torque": np.array(torque), "angle": np.interp(time, clock, table[:, 1])})
    return trials[:2], trials[2:]
