"""Two resistors and two capacitors in a row are driven by a square wave: pieces of 0.3 s at 1 kHz.

Three are learned, two later ones are unseen.
"""

import numpy as np

REPOSITORY = "lorsi96/System-Identification-Control-for-RCRC-Circuit"
COMMIT = "0a55e5847fa424f600139117fa3f2f830c3b0ff0"
FILES = {"csvs/step_resp.csv": "7bad2b5dc2894a02c1eb0d86d98d0969dd43c7df820667236cc3c76ce0c70365"}


def read_trials(files):
    """Learned and unseen trials."""
    rows = np.array([line.split(b",") for line in files["csvs/step_resp.csv"].splitlines()[1:]], float)
    pieces = [
        {"time": np.arange(300) / 1000, "dac": rows[i : i + 300, 2], "adc": rows[i : i + 300, 1]}
        for i in (510, 1330, 2170, 3050, 4020)
    ]
    return pieces[:3], pieces[3:]
