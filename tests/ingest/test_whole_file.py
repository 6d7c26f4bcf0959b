"""A failed write leaves what stood there, and no piece of what did not."""

from __future__ import annotations

import os

import pytest

from gaitdisc.errors import WriteError
from gaitdisc.ingest.whole_file import write_whole


def test_the_new_content_replaces_the_old(tmp_path):
    path = tmp_path / "a.txt"
    write_whole(path, "old")
    assert write_whole(path, b"new") == path
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("fails", ["fsync", "replace"])
def test_a_full_disk_leaves_the_old_file_and_no_other(tmp_path, monkeypatch, fails):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("gaitdisc.ingest.whole_file." + ("os.fsync" if fails == "fsync" else "Path.replace"), full)
    with pytest.raises(WriteError, match=r"a\.txt is to be written \(3 bytes\); the system says: No space left"):
        write_whole(path, "new")
    monkeypatch.undo()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_an_absent_folder_is_refused_in_words(tmp_path):
    with pytest.raises(WriteError, match="Choose a folder that exists"):
        write_whole(tmp_path / "no" / "a.txt", "x")


def test_others_may_read_the_file_as_any_other(tmp_path):
    mask = os.umask(0o022)
    try:
        assert write_whole(tmp_path / "a.txt", "x").stat().st_mode & 0o777 == 0o644
    finally:
        os.umask(mask)
