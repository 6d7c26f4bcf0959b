"""A cyclist on an ergometer, power raised steadily to exhaustion: power and heart rate, mean of each 10 s.

One trial; the first 20 min are learned, the last 9 are unseen.
"""

import io
import re
import zipfile

import numpy as np
from record import read_sheet

REPOSITORY = "fmmattioni/whippr"
COMMIT = "64c98b3d7bfaab3be6af4f35506f96478c8ca915"
FILES = {
    "inst/step_cortex.xlsx": "e566733062d466413c67f1e57d12affdd799b318bd24acbc2d84928055c38f36",
}
MEASURED = "71f8015f2d36955c3c46f8dd358f34cee54e79569573d340faf811bac79aef9f"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    words = zipfile.ZipFile(io.BytesIO(content)).read("xl/sharedStrings.xml").decode()
    words = re.findall(r"<si>.*?<t[^>]*>([^<]*)</t>.*?</si>", words, re.S)
    breaths = []
    for row in read_sheet(content)[40:]:
        clock = re.match(r"(\d+):(\d+):(\d+),(\d)", words[int(row["A"])]) if row.get("A", "").isdigit() else None
        if clock and "T" in row and "R" in row:
            hours, minutes, seconds, tenths = map(int, clock.groups())
            breaths.append((3600 * hours + 60 * minutes + seconds + tenths / 10, float(row["T"]), float(row["R"])))
    time, power, rate = np.array(breaths).T
    seconds = np.arange(20, 1750)
    run = {"power": np.interp(seconds, time, power), "rate": np.interp(seconds, time, rate)}
    run = {"time": np.arange(173) * 10.0, **{c: v.reshape(-1, 10).mean(1) for c, v in run.items()}}
    return [{c: v[:120] for c, v in run.items()}], [{c: v[120:] for c, v in run.items()}]
