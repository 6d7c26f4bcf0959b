"""A person runs over three force plates: upward force of the ground and height of the body's centre, every 5 ms.

The force is that of all plates. The centre is the mean of the segments' centres between the markers, by their share of
the mass (tables of Winter), less its height in standing. One trial: the first two steps are learned (0.8 s), the third
is unseen (0.4 s).
"""

import io

import numpy as np

REPOSITORY = "murillo-teixeira/biomechanics-assignments"
COMMIT = "05afa2f1b084cb1a03fe6a8f82a3982027045007"
FOLDER = "Material/Kinematics & Dynamics/trial_00"
FILES = {
    FOLDER + "01_static.tsv": "6e31ef14234d75f49061ada7cf4e37bba5434b70106593534055e99d72123026",
    FOLDER + "10_Run.tsv": "584fef234045cad058019dd7e341b89961e031bcfeb4440aa3da1eccc60d3226",
    FOLDER + "10_Run_f_1.tsv": "f235036c994450875d69e37e72b6d02c5a9aba71c1f9726064e3aedc4747f021",
    FOLDER + "10_Run_f_2.tsv": "bae947cde18e2a902b91accb7efb2b9f9914de87b02f59b392ca3cd0ad5cb047",
    FOLDER + "10_Run_f_3.tsv": "801ba255263c8a45841d5de3568e3e51000a66d2d5c93508c7e704b7e2021484",
}
SHARES = {  # of the body's mass, for both sides together
    "Head": 0.081,
    "Shoulder": 0.2485 + 0.056 * 0.564,
    "Elbow": 0.056 * 0.436 + 0.044 * 0.57,
    "Wrist": 0.044 * 0.43,
    "Hip": 0.2485 + 0.2 * 0.567,
    "Knee": 0.2 * 0.433 + 0.093 * 0.567,
    "Ankle": 0.093 * 0.433 + 0.029 * 0.5,
    "Toe_II": 0.029 * 0.5,
}
MEASURED = "05f290f64a0deeb9a6b4a465d912b57112a3925bc053ae2ce1f2357551ea3cc4"


def read_trials(files):
    """Learned and unseen trials."""
    tables = []
    for content in files.values():
        lines = content.decode("latin1").splitlines()
        head = next(i for i, line in enumerate(lines) if line.startswith(("Frame\t", "Sample\t")))
        names = lines[head].split("\t")
        rows = np.genfromtxt(io.StringIO("\n".join(lines[head + 1 :])), delimiter="\t")
        tables.append((names, rows))
    heights = []
    for names, rows in tables[:2]:
        columns = {m: [i for i, n in enumerate(names) if n.endswith(m + " Z")] for m in SHARES}
        heights.append(sum(share * rows[:, columns[m]].mean(1) for m, share in SHARES.items()) / 1000)
    standing, height = heights
    force = sum((rows[:, 4] for _, rows in tables[2:]), np.zeros(len(tables[2][1])))
    run = {"time": np.arange(len(force)) * 0.005, "force": force, "height": height - standing.mean()}
    return [{c: v[:165] for c, v in run.items()}], [{c: v[165:] for c, v in run.items()}]
