"""C3D files that are broken in a thousand ways: each is read as it stands or refused in words; nothing is harmed."""

import os
import sys

import numpy as np
import pytest
from damaged_c3d import damaged

from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.c3d import C3DReader

SAMPLES = "c3d_reader_samples"


def _memory_bytes() -> int:
    return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGE_SIZE")  # noqa: PTH123


@pytest.mark.parametrize("every", [pytest.param(1, marks=pytest.mark.slow), 4])
def test_corrupted_files_harm_nobody(tmp_path, write_c3d, some_points, some_analog, monkeypatch, every):
    monkeypatch.setattr("gaitdisc.ingest.reader_process.SECONDS_AT_LEAST", 3.0)
    parameters = {
        ("TRIAL", "ACTUAL_START_FIELD"): [1.0, 0.0],
        ("TRIAL", "ACTUAL_END_FIELD"): [50.0, 0.0],
        ("EVENT", "USED"): [1],
        ("EVENT", "LABELS"): ["Foot Strike"],
        ("EVENT", "CONTEXTS"): ["Left"],
        ("EVENT", "TIMES"): np.array([[0.0], [0.1]]),
    }
    plates = {
        ("FORCE_PLATFORM", "USED"): [1],
        ("FORCE_PLATFORM", "TYPE"): [2],
        ("FORCE_PLATFORM", "ZERO"): [1, 10],
        ("FORCE_PLATFORM", "CHANNEL"): np.arange(1.0, 7)[:, None],
        ("FORCE_PLATFORM", "CORNERS"): np.array([[[600, 0, 0], [0, 0, 0], [0, 400, 0], [600, 400, 0.0]]]).T,
        ("FORCE_PLATFORM", "ORIGIN"): np.array([[0, 0, -40.0]]).T,
        ("ANALOG", "UNITS"): ["N", "N", "N", "Nmm", "Nmm", "Nmm", "V", "V"],
    }
    plain = write_c3d(tmp_path / "plain.c3d", some_points, some_analog).read_bytes()
    forces = 300 * np.vstack([some_analog, some_analog])
    rich = write_c3d(tmp_path / "rich.c3d", some_points, forces, parameters | plates).read_bytes()
    rng = np.random.default_rng(20)
    path = tmp_path / "broken.c3d"
    read, refused, before = 0, 0, None
    with C3DReader() as reader:
        for base in (plain, rich):
            for kind, content in list(damaged(base, rng))[::every]:
                path.write_bytes(content)
                try:
                    trial = reader.read(path)
                except GaitdiscError as error:
                    refused += 1
                    assert "Traceback" not in str(error)
                else:
                    read += 1
                    assert kind != "truncated"
                    assert trial.streams
                if before is None and read + refused == 50 and sys.platform == "linux":
                    before = _memory_bytes()
    assert read + refused >= 800 // every
    assert refused > 200 // every
    if before is not None:
        assert _memory_bytes() - before < 50 * 2**20


def test_no_truncated_real_trial_is_accepted(gait_data, tmp_path, reader):
    path = tmp_path / "part.c3d"
    for name in ("c3d_org_sample01/Eb015pi", "c3d_org_sample02/pc_real", "gait/Gait", "gait/1123x01EMG"):
        content = (gait_data / SAMPLES / f"{name}.c3d").read_bytes()
        for share in np.linspace(0.02, 0.98, 25):
            path.write_bytes(content[: int(share * len(content))])
            with pytest.raises(ReadError):
                reader.read(path)
