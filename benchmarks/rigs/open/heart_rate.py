"""Heart rate of a runner from rest through a run at constant speed and back to rest, every 2 s.

13.4 and 14.4 km/h are learned, 15.7 km/h is unseen.
"""

import numpy as np

REPOSITORY = "mjhyman/be606_project"
COMMIT = "be4c89b58bfda973445a8cdd11ced7aacf3ea5a3"
FILES = {
    "S1_Dataset/Exercise A.txt": "1a44416bcc5365b4a9ae3c5a6796240cdfc7f5941db514f1336c12889f679ad3",
    "S1_Dataset/Exercise B.txt": "9ccd7143bf4fbbd73d338b545cc4c2ddf831df88fe8bf7ced692c688633c3ad4",
    "S1_Dataset/Exercise C.txt": "b882d1f133c8d89a4f2fc1c2e03bfd13eae7d62176a683c672fbf4ce39359aae",
    "S1_Dataset/Exercise D.txt": "3600ef838aaeb88dc48f78fcf265da9bdbadc17354b196108c84fe98d7be758c",
    "S1_Dataset/Exercise E.txt": "e7f01e410c04243fde0b8e461fd51006e7d74d79e97e8ecb92809f1a885d4afb",
    "S1_Dataset/Exercise F.txt": "f23015278c0006dd62f6a9c809c3e90f42d2dfddad8d9eb31315e5c9abae9b83",
}


def read_trials(files):
    """Learned and unseen trials."""
    beats = []
    for content in files.values():
        rows = [line.split()[:2] for line in content.decode().splitlines() if len(line.split()) > 1]
        table = np.array(rows, float)
        table = table[table[:, 1] > 30]
        beats.append(table[np.r_[True, np.diff(table[:, 0]) > 0]])
    trials = []
    for run, rest, speed in zip(beats[::2], beats[1::2], (13.4, 14.4, 15.7), strict=True):
        stop = run[-1, 0]
        clock, rate = np.r_[run[:, 0], rest[:, 0] + stop], np.r_[run[:, 1], rest[:, 1]]
        smooth = [np.median(rate[max(i - 2, 0) : i + 3]) for i in range(len(rate))]
        time = np.arange(2.0, clock[-1] - 2, 2.0)
        trials.append({"time": time, "speed": np.where(time < stop, speed, 0.0), "hr": np.interp(time, clock, smooth)})
    return trials[:2], trials[2:]
