"""Grains of gamboge in water, drawn by Jean Perrin every 30 s: place in micrometres; two are learned, one is unseen."""

import io

import numpy as np

REPOSITORY = "joaopedro-vm/Perrin_Brownian_Motion"
COMMIT = "b8b1b7b89cf9f2baf9debc40015ba63a2945ec4c"
FILES = {
    "traj1.txt": "599293703254b3f352ffbb27457c06dadd9f11b762b33064bf4e735c2d9b899e",
    "traj2.txt": "6db24220b8568a75d66c6e20b86050046db7c0baafa9aa3afe271a9fe16332b1",
    "traj3.txt": "3919fda6a2e2cdbfe58d9b87fdca2f00e3c367d04328ed2fdf705ded5fd32310",
}


def read_trials(files):
    """Learned and unseen trials."""
    rows = [np.genfromtxt(io.BytesIO(content), delimiter=",") for content in files.values()]
    grains = [{"time": r[:, 0], "x": 1e6 * (r[:, 1] - r[0, 1]), "y": 1e6 * (r[:, 2] - r[0, 2])} for r in rows]
    return grains[:2], grains[2:]
