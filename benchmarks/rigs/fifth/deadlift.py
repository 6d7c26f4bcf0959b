"""A person lifts a light bar from the floor on two force plates: force of both feet, height of the shoulders.

Recorded every 10 ms, here every 40 ms. Two lifts of 3.4 s are learned, one is unseen.
"""

import io

import numpy as np

REPOSITORY = "LeafarCoder/Biomechanics-of-Motion-Project-2019"
COMMIT = "224bb797cdac665431602154bc724144f976e3fd"
FOLDER = "Dynamics code/LabData/deadlift"
FILES = {
    FOLDER + ".tsv": "3d95dbc7ce722bca20ae52d8678fcbcc751748ab23d10b4e6210a146823c2fd6",
    FOLDER + "_f1.tsv": "006a4536020a212bb2a58e0acd531d85a6a0f326aa045aab352137ac8ec7687e",
    FOLDER + "_f2.tsv": "b82848351ad2f60dbeecd550d0ba4229bf527b4f8ff68c65a702361fe94c470b",
}
MEASURED = "f2af47a290aeb9a4426538e56500c9c31785d7b7d30780a5782cd3182670ff6f"


def read_trials(files):
    """Learned and unseen trials."""
    tables = []
    for content in files.values():
        lines = content.decode("latin1").splitlines()
        head = next(i for i, line in enumerate(lines) if line.startswith(("Frame\t", "Sample\t")))
        tables.append(np.genfromtxt(io.StringIO("\n".join(lines[head + 1 :])), delimiter="\t"))
    markers, *plates = tables
    shoulders = markers[:, [2 + 3 * 1 + 2, 2 + 3 * 4 + 2]].mean(1) / 1000
    force = np.sum([plate[: len(shoulders), 4] for plate in plates], axis=0)
    lifts = []
    for begin in BEGINS:
        cut = slice(begin, begin + 340, 4)
        lifts.append({"time": np.arange(85) * 0.04, "force": force[cut], "shoulders": shoulders[cut]})
    return lifts[:2], lifts[2:]


BEGINS = (200, 560, 940)
