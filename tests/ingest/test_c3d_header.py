from __future__ import annotations

import zipfile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_parameters import decoded, read_c3d_header


def test_header_of_a_written_file(tmp_path, write_c3d, some_points, some_analog):
    header = read_c3d_header(write_c3d(tmp_path / "a.c3d", some_points, some_analog))
    assert (header.processor, header.frames, header.points, header.analog_values) == ("Intel", 50, 3, 40)
    assert (header.samples_per_frame, header.rate_hz, header.scale) == (10, 100.0, -1.0)


@pytest.mark.parametrize(("name", "processor"), [("pi", "Intel"), ("vr", "DEC"), ("si", "MIPS")])
def test_byte_orders_tell_the_same(gait_data, name, processor):
    header = read_c3d_header(gait_data / f"c3d_reader_samples/c3d_org_sample01/Eb015{name}.c3d")
    assert (header.processor, header.frames, header.points, header.analog_values) == (processor, 450, 26, 64)
    assert (header.rate_hz, abs(header.scale)) == (50.0, pytest.approx(1 / 12))


def test_what_is_no_c3d_file_is_named(tmp_path):
    with zipfile.ZipFile(tmp_path / "zip.c3d", "w") as archive:
        archive.writestr("a.txt", "x" * 2000)
    (tmp_path / "empty.c3d").touch()
    (tmp_path / "text.c3d").write_text("time\tknee\n" * 200)
    (tmp_path / "short.c3d").write_bytes(b"\x02\x50" + bytes(50))
    (tmp_path / "picture.c3d").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(2000))
    (tmp_path / "folder.c3d").mkdir()
    (tmp_path / "zeros.c3d").write_bytes(bytes(2048))
    (tmp_path / "processor.c3d").write_bytes(bytes([2, 80]) + bytes(2046))
    said = {
        "zip": "is a ZIP archive",
        "empty": "is empty (0 bytes)",
        "text": "it looks like text",
        "short": "has 52 bytes",
        "picture": "is a PNG picture",
        "folder": "is a folder",
        "zeros": "bytes 0 and 0",
        "processor": "has 0",
        "missing": "is not there",
    }
    for name, words in said.items():
        with pytest.raises(ReadError) as refusal:
            read_c3d_header(tmp_path / f"{name}.c3d")
        assert f"{name}.c3d {words}" in str(refusal.value) or words in refusal.value.found
        assert refusal.value.remedy.endswith(".")
        assert str(tmp_path) not in str(refusal.value)


@given(st.floats(min_value=-(2.0**100), max_value=2.0**100, width=32, allow_subnormal=False))
def test_vax_floats_are_ieee_floats_times_four_with_halves_exchanged(value):
    bits = np.array([value * 4], np.float32).view(np.uint32)
    raw = np.concatenate([bits >> 16, bits & 0xFFFF]).astype("<u2").tobytes()
    assert decoded(raw, 4, "DEC")[0] == np.float32(value)


@given(st.integers(-(2**15), 2**15 - 1))
def test_integers_in_both_orders(value):
    assert decoded(value.to_bytes(2, "little", signed=True), 2, "DEC")[0] == value
    assert decoded(value.to_bytes(2, "big", signed=True), 2, "MIPS")[0] == value
