"""Bytes, hash and lines of a file; files written as they are read."""

import hashlib
import os
from pathlib import Path

import numpy as np
import pytest

import gaitdisc as gd
from gaitdisc.errors import ReadError, WriteError
from gaitdisc.ingest.raw_file import RawFile, read_raw
from gaitdisc.regular_file import file_sha256, recall_sha256


def test_hash_is_that_of_the_bytes(tmp_path):
    path = tmp_path / "walk.mot"
    path.write_bytes(b"abc\r\n")
    source = read_raw(path).source("mot")
    assert (source.file, source.reader) == ("walk.mot", "mot")
    assert source.sha256 == hashlib.sha256(b"abc\r\n").hexdigest()


def test_all_line_ends_a_byte_order_mark_and_old_windows_text_are_read():
    assert RawFile("a", b"\xef\xbb\xbfone\r\ntwo\rthree\nfour").lines() == ["one", "two", "three", "four"]
    assert RawFile("a", b"Fu\xdf").lines() == ["Fuß"]


def test_binary_data_is_refused_with_its_place():
    with pytest.raises(ReadError, match=r"a\.mot.*3\)"):
        RawFile("a.mot", b"abc\0d").lines()


def test_an_absent_file_is_refused_with_the_nearest(tmp_path):
    (tmp_path / "natural.mot").write_text("x")
    with pytest.raises(ReadError, match=r"'natural\.mot'"):
        read_raw(tmp_path / "naturl.mot")


def test_a_folder_and_an_empty_file_are_refused(tmp_path):
    (tmp_path / "empty.mot").write_text(" \n")
    with pytest.raises(ReadError, match="it is a folder"):
        read_raw(tmp_path)
    with pytest.raises(ReadError, match=r"empty\.mot.*\(2 bytes\)"):
        read_raw(tmp_path / "empty.mot")
    with pytest.raises(ReadError, match="folder does not exist"):
        read_raw(tmp_path / "no" / "a.mot")


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
    assert read_raw(settled).sha256 == recall_sha256(settled) == file_sha256(settled)


def test_a_file_that_changed_is_hashed_again_whatever_its_time_says(settled):
    first = file_sha256(settled)
    settled.write_bytes(b"abd")
    os.utime(settled, (YESTERDAY, YESTERDAY))
    assert recall_sha256(settled) == ""
    assert file_sha256(settled) != first
    assert read_raw(settled).source("mot").sha256 == hashlib.sha256(b"abd").hexdigest()


def test_a_file_that_was_just_written_is_not_trusted(tmp_path):
    path = tmp_path / "new.mot"
    path.write_bytes(b"abc")
    file_sha256(path)
    assert recall_sha256(path) == ""


def test_a_missing_file_has_no_hash(tmp_path):
    assert recall_sha256(tmp_path / "nowhere") == ""
    with pytest.raises(FileNotFoundError):
        file_sha256(tmp_path / "nowhere")


@pytest.fixture
def angles():
    time = np.arange(50) / 100
    return gd.Recording(time, np.column_stack([30 * np.sin(time), time]), tuple(map(angle, ("knee_angle_r", "tilt"))))


def angle(name):
    return gd.Channel(name, "angle", "deg", "r" if name.endswith("_r") else "")


@pytest.mark.parametrize("ending", ["mot", "sto", "csv", "parquet", "MOT"])
def test_what_is_written_is_read_again(angles, tmp_path, ending):
    file = gd.write(angles, tmp_path / f"walk.{ending}")
    again = gd.read(file).stream("kinematics")
    np.testing.assert_allclose(again["knee_angle_r"], angles["knee_angle_r"], rtol=1e-12)
    np.testing.assert_allclose(again.time, angles.time, atol=1e-12)


@pytest.mark.parametrize(("name", "said"), [("walk.txt", "ends with '.txt'"), ("walk.parqet", "nearest is '.parquet'")])
def test_another_ending_is_refused_before_anything_is_written(angles, tmp_path, name, said):
    with pytest.raises(WriteError, match=said):
        gd.write(angles, tmp_path / name)
    assert list(tmp_path.iterdir()) == []
