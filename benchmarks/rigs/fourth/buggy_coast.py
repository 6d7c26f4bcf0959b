"""A small off-road car (250 kg) coasts down: speed of a rear wheel, every 0.1 s (of 2 ms).

Two runs are learned, a third one is unseen; each from 1 s after its top speed for 11 s (the unseen one for 7 s: then
it is braked).
"""

import io

import numpy as np

REPOSITORY = "shotgoose/coastdown-testing"
COMMIT = "9aa6ca8671e015e57583dc0c817c4d7a9047f69f"
FOLDER = "csv-data/"
FILES = {
    FOLDER + "RR-Coastdown-1.csv": "cd53b312531c6180d58be394471cbc6af44ef6a90f7f29b4390e83e1ce8a70e6",
    FOLDER + "RR-Coastdown-2.csv": "d331590d1d42fe8848a17be96bf0f7e0f1a1f7ca82bfe70e0d778c5a263b6de5",
    FOLDER + "RR-Coastdown-3.csv": "dbb39d8dfba8da6a72c90d46ebc32a9b04a64712d0f80568c401d0fc367cd173",
}
MEASURED = "6efbf7d8e2446e5a049f1151431a2b9f2634d2693a6e280a7911a8f52a715072"


def read_trials(files):
    """Learned and unseen trials."""
    runs = []
    for name, content in files.items():
        text = content.decode().split("\n", 1)[1]
        rows = np.genfromtxt(io.StringIO(text), delimiter=",", usecols=(0, 7))[: len(text) // 50 * 50]
        wheel = rows[: len(rows) // 50 * 50, 1].reshape(-1, 50).mean(1)
        begin = np.argmax(wheel) + 10
        speed = wheel[begin : begin + (70 if name.endswith("1.csv") else 110)] * np.pi * 0.5842 / 60
        runs.append({"time": np.arange(len(speed)) * 0.1, "speed": speed})
    return runs[1:], runs[:1]
