"""Motors at shoulder and elbow swing a hanging arm of two links: torques and angles, averaged over 20 ms.

Five pieces of 4.8 s of three movements are learned, three pieces of two movements are unseen.
"""

import io

import numpy as np

REPOSITORY = "dfki-ric-underactuated-lab/double_pendulum"
COMMIT = "1e8544e67f3da72a51ee52fbbb278e131ce2a43f"
RUN = "data/experiment_records/design_C.1/sys_id/20230629/20230629-"
FILES = {
    RUN + "143339/trajectory.csv": "94f17287b53187dfe8f4ce131f4e7c49918309fcc915cbae2f64ed3101e7c23b",
    RUN + "143524/trajectory.csv": "03fc5e18915e80afabb3e2674b627f9d849d43675aeacbf586ccd24b3ebd7ca5",
    RUN + "143601/trajectory.csv": "e028c1d7a6a45cfe1b96b7cb33aae412b8888f022677d392f6f9cd4d4f63886d",
    RUN + "143704/trajectory.csv": "e19682394cb7dc8847db9010e568b139a85a447bfbc4547b8828ad58da64a2a9",
}


def read_trials(files):
    """Learned and unseen trials."""
    pieces = []
    for content in files.values():
        table = np.genfromtxt(io.BytesIO(content), delimiter=",", names=True)
        clock, time = table["time"], np.arange(0, 9.9, 0.02)
        near = [(clock >= t - 0.01) & (clock < t + 0.01) for t in time]
        movement = {f"torque{k}": np.array([table[f"tau_meas{k}"][n].mean() for n in near]) for k in (1, 2)}
        movement |= {f"angle{k}": np.interp(time, clock, table[f"pos_meas{k}"]) for k in (1, 2)}
        pieces += [{"time": time[b : b + 240], **{k: v[b : b + 240] for k, v in movement.items()}} for b in (0, 250)]
    return pieces[:5], pieces[5:]
