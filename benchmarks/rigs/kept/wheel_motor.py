"""Geared motors of a soccer robot follow a slow ramp of the duty cycle up, down and reverse.

Speed every 25 ms; motors 1 and 2 are learned, 3 and 4 are unseen.
"""

import numpy as np

REPOSITORY = "vhsabino/MATLAB"
COMMIT = "bc6d16ac215616f7cfc256c862144165f9b11d2b"
FILES = {
    "INPUT_27_07_19.csv": "445c524e51534cdd72656160034b3fef45a95afef825e055d68b62027fe4444a",
    "M1_27_07_19.csv": "4589f2a2fc04d437e77747fee8f55c5a3ab956ed9660a4a4c61daa9ccaa18fba",
    "M2_27_07_19.csv": "e127aa8503dd4393c6ad6454b6439fcc0738cd61691049c77ba86a21b7b0e40f",
    "M3_27_07_19.csv": "0f8f1eb10c2d5fe46b5c85aa2b0cf379e25084651f49749fd3c83ad9e3d60046",
    "M4_27_07_19.csv": "cc05007556a3e52ad598265277b60724165569139c24b05dc646f8cf6088945d",
}


def read_trials(files):
    """Learned and unseen trials."""
    duty, *speeds = [
        np.array(content.decode("utf-8-sig").replace(",", "\n").split(), float)[::5] for content in files.values()
    ]
    trials = [{"time": 0.025 * np.arange(len(duty)), "duty": duty, "speed": speed} for speed in speeds]
    return trials[:2], trials[2:]
