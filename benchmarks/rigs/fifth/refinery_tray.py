"""A distillation column: flow of vapour that is changed once, and level of a tray, every minute.

One trial: 100 min are learned, the 93 min that follow are unseen. Columns stand as vectors of 194 numbers inside a
saved R table.
"""

import gzip
import re

import numpy as np

REPOSITORY = "cran/fda"
COMMIT = "b21dd5c1e007887bfe15b1bc4f21ee8f6b7040a7"
FILES = {
    "data/refinery.rda": "fc7dbbe5dc88b2fe001ca211814197e8c7c22d505463edac812f7592d5c92b74",
}
MEASURED = "ea9c73fa3e9bdc62bf69f468c0717cee4a02086e299319755cfd17eebc0864fc"


def read_trials(files):
    """Learned and unseen trials."""
    (content,) = files.values()
    table = gzip.decompress(content)
    _, flow, level = (
        np.frombuffer(table, ">f8" if match[0][3] == 14 else ">i4", 194, match.end()).astype(float)
        for match in re.finditer(rb"\x00\x00[\x00\x02\x03][\x0d\x0e]\x00\x00\x00\xc2", table)
    )
    run = {"time": np.arange(194) * 1.0, "flow": flow, "level": level}
    return [{c: v[:100] for c, v in run.items()}], [{c: v[100:] for c, v in run.items()}]
