"""Damaged files: a trial, a study, or a refusal with the file's name in it; never another exception.

Not a twin of a module: it holds the whole room to one promise.
"""

import random

import numpy as np
import pytest

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import load_study, study_text
from gaitdisc.ingest.table import write_table
from gaitdisc.recording import Recording, Trial

TIME = np.arange(40) / 100
CHANNELS = tuple(vocabulary().channels[i] for i in (0, 3, 6, 12, 18))
WALK = Recording(TIME, np.column_stack([20 * np.sin(9 * TIME + i) for i in range(5)]), CHANNELS)
FORCE = Recording(TIME, 700 * np.ones((40, 1)), (Channel("ground_force_r_vy", "vertical_force", "N", "r"),))
TRC = (
    "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t40\t2\tmm\n"
    "Frame#\tTime\tRHEE\t\t\tLHEE\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"
    + "".join(f"{i + 1}\t{i / 100:.3f}\t{i}\t2\t3\t{10 * i + 1}\t\t30\n" for i in range(40))
)
SIMM = "name EMG\ndatacolumns 3\ndatarows 40\nrange 0.0 0.39\nendheader\nTime\tSol_r\tTA_r\n" + "".join(
    f"{i / 100:10.4f}\t{0.1 * i:10.4f}\t0.5\t\n" for i in range(40)
)
WORDS = ["abc", "", "nan", "inf", "1e999", "-", "1,5", "0x1", "9" * 400, "\u221e", "=", "[", '"', "true", "\t", "time"]


def _seeds(folder) -> dict[str, bytes]:
    people = [
        Participant(id=f"P{i}", trials=tuple(PlannedTrial(condition=c, files=(f"{c}{i}.mot",)) for c in ("nat", "exo")))
        for i in range(2)
    ]
    conditions = Conditions(nominal="nat", device="exo")
    study = Study(conditions=conditions, channels={"ch 1": "emg_sol_r [mV]"}, participants=tuple(people))
    return {
        "ik.mot": write_storage(WALK, folder / "ik.mot").read_bytes(),
        "grf.sto": write_storage(FORCE, folder / "grf.sto").read_bytes(),
        "emg.mot": SIMM.encode(),
        "markers.trc": TRC.encode(),
        "walk.csv": write_table(WALK, folder / "walk.csv").read_bytes(),
        "walk.parquet": write_table(WALK, folder / "walk.parquet").read_bytes(),
        "study.toml": study_text(study).encode(),
    }


def _flip(data: bytes, dice: random.Random) -> bytes:
    flipped = bytearray(data)
    for _ in range(dice.randint(1, 12)):
        flipped[dice.randrange(len(flipped))] ^= 1 << dice.randrange(8)
    return bytes(flipped)


def _cut(data: bytes, dice: random.Random) -> bytes:
    return data[: dice.randrange(len(data))]


def _hole(data: bytes, dice: random.Random) -> bytes:
    start = dice.randrange(len(data))
    return data[:start] + data[start + dice.randint(1, 200) :]


def _lines(data: bytes, dice: random.Random) -> bytes:
    lines = data.split(b"\n")
    at = dice.randrange(len(lines))
    change = dice.choice(["drop", "double", "swap", "blank"])
    if change == "drop":
        del lines[at]
    elif change == "double":
        lines.insert(at, lines[at])
    elif change == "swap":
        other = dice.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    else:
        lines[at] = b""
    return b"\n".join(lines)


def _column(data: bytes, dice: random.Random) -> bytes:
    separator = b"\t" if data.count(b"\t") > data.count(b",") else b","
    at = dice.randrange(4)
    rows = [line.split(separator) for line in data.split(b"\n")]
    return b"\n".join(separator.join(row[:at] + row[at + 1 :]) for row in rows)


def _cell(data: bytes, dice: random.Random) -> bytes:
    lines = data.split(b"\n")
    at = dice.randrange(len(lines))
    sign = dice.choice([b"\t", b",", b"=", b" "])
    cells = lines[at].split(sign)
    cells[dice.randrange(len(cells))] = dice.choice(WORDS).encode()
    lines[at] = sign.join(cells)
    return b"\n".join(lines)


def _key(data: bytes, dice: random.Random) -> bytes:
    old = dice.choice(
        [b"inDegrees=yes", b"nRows", b"endheader", b"time", b"mm", b"DataRate", b"40", b"hip_flexion_r", b"condition",
         b"P0", b"[deg]", b"=", b"0.125", b"natural", b"[models]", b'"', b"NumFrames"]
    )  # fmt: skip
    return data.replace(old, dice.choice(WORDS).encode(), dice.choice([1, -1]))


CHANGES = (_flip, _cut, _hole, _lines, _column, _cell, _key)
ROUNDS = 20


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__[1:])
def test_a_damaged_file_is_read_or_refused_by_name(tmp_path, change):
    refused = read = 0
    for name, good in _seeds(tmp_path).items():
        dice = random.Random(f"{name} {change.__name__}")
        path = tmp_path / name
        for number in range(ROUNDS):
            path.write_bytes(change(good, dice))
            try:
                result = load_study(path) if name == "study.toml" else read_trial(path)
            except GaitdiscError as refusal:
                assert name in str(refusal), f"{name} {number}: {refusal}"
                assert "\n" not in str(refusal), f"{name} {number}: {refusal}"
                refused += 1
            else:
                assert isinstance(result, Trial | Study)
                read += 1
    assert refused + read == ROUNDS * 7  # 980 files in all
    assert refused > ROUNDS
