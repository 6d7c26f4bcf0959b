"""A bicycle wheel runs down on a drum: speed of the wheel, medians over 2 s.

Three pressures of the tyre are learned; a fourth one, and the drum turning the other way, are unseen.
"""

import numpy as np

REPOSITORY = "hpvdt/rolling_resistance_rig"
COMMIT = "8beeba987ab34bc85bd8fc0f9a1efa95fbf6459d"
RUN = "analysis/data/aero/Grandprix - Contact - "
FILES = {
    RUN + "Left - 100 psi.csv": "a12e6dd1a240434a06f7eb58980c7a22b1736b43bfb42777252f13f4f4ab578e",
    RUN + "Left - 120 psi.csv": "d6d3c44948a94ef878de39b9f0ee41968182508ce08944173c8b26a45e83c5aa",
    RUN + "Left - 140 psi.csv": "7b203bbc2e70ae6ccac35928ed67f1bd7d1c0c7effc9fedb3647fff3d44e19b3",
    RUN + "Left - 110 psi.csv": "f9a66c87b1067f3a2695197aea9d43c5459ae7570d04be3807812f71cc8c640d",
    RUN + "Right - 100 psi.csv": "3108338fdc2dd355328cce48fed6b1af0b7ddf72fc43242fef33ddd3b8e5456c",
}


def read_trials(files):
    """Learned and unseen trials."""
    trials = []
    for content in files.values():
        rows = [line.split(",") for line in content.decode("utf-8-sig").splitlines()]
        rows = np.array([row[:5] for row in rows if len(row) > 4 and all(row[:5])], float)
        clock, rate = rows[:, 0] / 1e6, rows[:, 3]
        time = np.arange(clock[5] + 2, clock[-1] - 2, 2.0)
        wheel = np.array([np.median(rate[(clock >= t - 1) & (clock < t + 1)]) for t in time])
        full = np.percentile(rate, 97)
        begin = np.flatnonzero(wheel > 0.97 * full)[-1] + 1
        end = begin + np.flatnonzero(np.append(wheel[begin:], 0) < 0.1 * full)[0]
        trials.append({"time": time[begin:end], "wheel": wheel[begin:end]})
    return trials[:3], trials[3:]
