"""Bytes, hash and lines of a file."""

from __future__ import annotations

import hashlib

import pytest

from gaitdisc.errors import ReadError
from gaitdisc.ingest.raw_file import RawFile, read_raw


def test_hash_is_that_of_the_bytes(tmp_path):
    path = tmp_path / "walk.mot"
    path.write_bytes(b"abc\r\n")
    source = read_raw(path).source("mot")
    assert (source.file, source.reader) == ("walk.mot", "mot")
    assert source.sha256 == hashlib.sha256(b"abc\r\n").hexdigest()


def test_all_line_ends_and_a_byte_order_mark_are_read():
    assert RawFile("a", b"\xef\xbb\xbfone\r\ntwo\rthree\nfour").lines() == ["one", "two", "three", "four"]


def test_old_windows_text_is_read():
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
    with pytest.raises(ReadError, match="nor its folder"):
        read_raw(tmp_path / "no" / "a.mot")
