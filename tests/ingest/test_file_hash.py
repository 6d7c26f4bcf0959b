import hashlib
import os
from pathlib import Path

import pytest

from gaitdisc.ingest.raw_file import file_sha256, known_sha256, read_raw

YESTERDAY = 1_700_000_000


@pytest.fixture
def settled(tmp_path):
    path = tmp_path / "walk.mot"
    path.write_bytes(b"abc")
    os.utime(path, (YESTERDAY, YESTERDAY))
    return path


def counted(monkeypatch):
    """Files that are hashed from now on, in order."""
    hashed, plain = [], hashlib.file_digest
    monkeypatch.setattr(hashlib, "file_digest", lambda f, name: hashed.append(f.name) or plain(f, name))
    return hashed


def test_a_file_is_hashed_once(settled, monkeypatch):
    hashed = counted(monkeypatch)
    assert {file_sha256(settled) for _ in range(3)} == {hashlib.sha256(b"abc").hexdigest()}
    assert [Path(name).name for name in hashed] == ["walk.mot"]
    assert read_raw(settled).sha256 == known_sha256(settled) == file_sha256(settled)


def test_a_file_that_changed_is_hashed_again_whatever_its_time_says(settled):
    first = file_sha256(settled)
    settled.write_bytes(b"abd")
    os.utime(settled, (YESTERDAY, YESTERDAY))
    assert known_sha256(settled) == ""
    assert file_sha256(settled) != first
    assert read_raw(settled).source("mot").sha256 == hashlib.sha256(b"abd").hexdigest()


def test_a_file_that_was_just_written_is_not_trusted(tmp_path):
    path = tmp_path / "new.mot"
    path.write_bytes(b"abc")
    file_sha256(path)
    assert known_sha256(path) == ""


def test_a_missing_file_has_no_hash(tmp_path):
    assert known_sha256(tmp_path / "nowhere") == ""
    with pytest.raises(FileNotFoundError):
        file_sha256(tmp_path / "nowhere")
