"""Header, parameters and layout of a C3D file: what each field means, and which of them contradict each other."""

import zipfile
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_layout import find_layout
from gaitdisc.ingest.c3d_parameters import C3DParameters, decoded, read_c3d_header, read_c3d_parameters


def _parameters(path):
    return read_c3d_parameters(path, read_c3d_header(path))


def test_texts_numbers_and_dimensions(tmp_path, write_c3d, some_points):
    corners = np.arange(24.0).reshape(3, 4, 2)
    own = {("FORCE_PLATFORM", "CORNERS"): corners, ("POINT", "ANGLES"): ["RKneeAngles", "L"]}
    found = _parameters(write_c3d(tmp_path / "a.c3d", some_points, parameters=own))
    np.testing.assert_array_equal(found.numbers("FORCE_PLATFORM", "CORNERS"), corners)
    assert found.texts("POINT", "ANGLES") == ("RKneeAngles", "L")
    assert found.text("POINT", "UNITS") == "mm"
    assert found.count("POINT", "FRAMES") == 50
    assert found.number("POINT", "NOTHING") is None
    assert found.numbers("POINT", "LABELS").size == 0


def test_ezc3d_reads_the_same_parameters(gait_data):
    import ezc3d

    for path in sorted(gait_data.glob("young_straight_and_turn/*/straight/*.c3d"))[:2]:
        ours, theirs = _parameters(path), ezc3d.c3d(str(path))["parameters"]
        for (group, name), value in ours.values.items():
            if group not in ("POINT", "ANALOG", "FORCE_PLATFORM", "EVENT", "TRIAL"):
                continue
            other = theirs[group][name]["value"]
            if isinstance(value, tuple):
                assert [text.strip() for text in value] == [text.strip() for text in other], (group, name)
            else:
                np.testing.assert_allclose(np.ravel(value), np.ravel(other), rtol=1e-6, err_msg=f"{group}:{name}")


def test_more_than_255_labels_go_on_in_labels2(gait_data):
    path = gait_data / "young_straight_and_turn/HC030A/straight/HC030A05.c3d"
    assert len(_parameters(path).texts("POINT", "LABELS")) == 291


def test_frame_numbers_of_two_words():
    found = C3DParameters({("TRIAL", "ACTUAL_END_FIELD"): np.array([-31072, 1], np.int16)})
    assert found.field("ACTUAL_END_FIELD") == 100_000
    assert found.field("ACTUAL_START_FIELD") is None


def test_a_broken_section_is_refused_in_words(gait_data):
    with pytest.raises(ReadError, match=r"'LABELS'.*byte 5052.*199 bytes"):
        _parameters(gait_data / "c3d_reader_samples/c3d_org_other/bad_parameter_section.c3d")


def test_a_parameter_longer_than_its_entry_is_refused(tmp_path, write_c3d, some_points):
    path = write_c3d(tmp_path / "a.c3d", some_points)
    content = bytearray(path.read_bytes())
    at = content.index(b"LABELS") + len("LABELS") + 2  # type, number of dimensions, dimensions
    assert content[at + 1] == 2
    content[at + 3] = 255
    path.write_bytes(content)
    with pytest.raises(ReadError, match=r"'LABELS'.*255\)"):
        _parameters(path)


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
        "empty": "has 0 bytes",
        "text": "looks like text",
        "short": "has 52 bytes",
        "picture": "is a PNG picture",
        "folder": "is a folder",
        "zeros": "bytes 0 and 0",
        "processor": "has type 0",
        "missing": "does not exist",
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


@pytest.fixture
def file(tmp_path, write_c3d, some_points, some_analog):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    header = read_c3d_header(path)
    return header, read_c3d_parameters(path, header)


def _with(parameters: C3DParameters, **values) -> C3DParameters:
    named = {tuple(key.split("__")): np.array([value]) for key, value in values.items()}
    return C3DParameters({**parameters.values, **named})


def test_an_ordinary_file(file):
    layout, findings = find_layout(*file)
    assert (layout.frames, layout.points, layout.channels, layout.samples_per_frame) == (50, 3, 4, 10)
    assert layout.end == 3 * 512 + 50 * (4 * 3 + 4 * 10) * 4 <= file[0].size
    assert not findings


@pytest.mark.parametrize("lost", [400, 5000, 9000])
def test_a_truncated_file_is_refused_with_its_numbers(file, lost):
    header = replace(file[0], size=file[0].size - lost)
    with pytest.raises(ReadError, match=r"11936 bytes; a.c3d.*frame"):
        find_layout(header, file[1])


def test_contradicting_counts_are_settled_by_the_length_of_the_file(file):
    layout, findings = find_layout(replace(file[0], last_frame=20), file[1])
    assert layout.frames == 50
    assert "(frames: 50 and" in findings[0].what
    layout, findings = find_layout(file[0], _with(file[1], POINT__USED=900))
    assert layout.points == 3
    assert says(findings[0].what, "points: 900", "3", "3")


def test_more_frames_than_16_bits_hold(file):
    parameters = _with(file[1], POINT__FRAMES=-1, TRIAL__ACTUAL_START_FIELD=1)
    parameters = C3DParameters(
        {**parameters.values, ("TRIAL", "ACTUAL_END_FIELD"): np.array([100_000 - 2**17, 1], np.int32)}
    )
    header = replace(file[0], last_frame=65535, size=3 * 512 + 100_000 * 208)
    assert find_layout(header, parameters)[0].frames == 100_000
    with pytest.raises(ReadError, match=r"100000 frames.*truncated"):
        find_layout(replace(header, size=3 * 512 + 70_000 * 208), parameters)


def test_a_header_that_misses_the_data_and_a_file_without_anything_are_refused(file):
    with pytest.raises(ReadError, match=r"POINT:DATA_START.*4"):
        find_layout(replace(file[0], data_block=3), file[1])
    header = replace(file[0], points=0, analog_values=0)
    with pytest.raises(ReadError, match="points or analog"):
        find_layout(header, _with(file[1], POINT__USED=0, ANALOG__USED=0))


@pytest.mark.parametrize(("header", "parameter"), [(-0.1, 0.1), (0.1, -0.1), (0.1, 0.2)])
def test_contradicting_scales_are_refused(file, header, parameter):
    with pytest.raises(ReadError, match=rf"a\.c3d.*{header}.*{parameter}"):
        find_layout(replace(file[0], scale=header), _with(file[1], POINT__SCALE=parameter))


def test_frames_that_no_count_covers_are_reported(file):
    _, findings = find_layout(replace(file[0], size=file[0].size + 3000), file[1])
    assert says(findings[0].what, "50 frames", "1")
