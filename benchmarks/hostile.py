"""Corrupted versions of every real C3D file at hand: none may crash, hang, or pass as whole when it was cut short.

    python benchmarks/hostile.py DATA [--each 95]

Each file is cut short, or has bytes of its header or parameters changed, and is read as `gaitdisc` reads any C3D.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("data", "folder of C3D files", type=Path),
    argument("--each", "corrupted versions of each file", 95),
)  # before the slow imports

import resource
import tempfile
import time
from collections import Counter

import numpy as np
from damaged_c3d import Counts, damaged

from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.recording import Trial

HANGS_S = 60.0


def outcome(reader: C3DReader, path: Path, kind: str, whole: Path) -> str:
    """What reading a damaged file came to, in a few words."""
    began = time.monotonic()
    try:
        read = reader.read(path)
        found = "read as it stands"
        if kind == "truncated":
            found = "cut behind the data" if alike(read, reader.read(whole)) else "cut short and accepted"
    except GaitdiscError as error:
        found = "refused in words" if "Traceback" not in str(error) else "refused with a traceback"
    except Exception as error:  # what the benchmark is for
        return f"crash: {type(error).__name__}"
    return "hang" if time.monotonic() - began > HANGS_S else found


def alike(one: Trial, other: Trial) -> bool:
    """Whether two trials hold the same numbers."""
    return one.streams.keys() == other.streams.keys() and all(
        np.array_equal(one.streams[key].values, other.streams[key].values, equal_nan=True) for key in one.streams
    )


def main() -> None:
    """Print how many came to what."""
    share = GIVEN.each - 8
    counts = Counts(share // 4, share // 4, share - 2 * (share // 4))
    rng, seen, files = np.random.default_rng(0), Counter(), 0
    began = time.process_time()
    with C3DReader() as reader, tempfile.TemporaryDirectory() as folder:
        broken = Path(folder) / "broken.c3d"
        for path in sorted(GIVEN.data.rglob("*.c3d")):
            content = path.read_bytes()
            files += 1
            for kind, bytes_ in damaged(content, rng, counts):
                broken.write_bytes(bytes_)
                seen[outcome(reader, broken, kind, path)] += 1
            print(f"{files} {path.name}: {sum(seen.values())} versions so far", file=sys.stderr, flush=True)
    used = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{sum(seen.values())} versions of {files} files, {used:.0f} s of this process, peak memory {peak:.0f} MB")
    for found, count in seen.most_common():
        print(f"{found}: {count}")


if __name__ == "__main__":
    main()
