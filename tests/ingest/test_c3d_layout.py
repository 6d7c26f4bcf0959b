from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d import expected_layout
from gaitdisc.ingest.c3d_parameters import C3DParameters, read_c3d_header, read_c3d_parameters


@pytest.fixture
def file(tmp_path, write_c3d, some_points, some_analog):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    header = read_c3d_header(path)
    return header, read_c3d_parameters(path, header)


def _with(parameters: C3DParameters, **values) -> C3DParameters:
    named = {tuple(key.split("__")): np.array([value]) for key, value in values.items()}
    return C3DParameters({**parameters.values, **named})


def test_an_ordinary_file(file):
    layout, findings = expected_layout(*file)
    assert (layout.frames, layout.points, layout.channels, layout.samples_per_frame) == (50, 3, 4, 10)
    assert layout.end == 3 * 512 + 50 * (4 * 3 + 4 * 10) * 4 <= file[0].size
    assert not findings


@pytest.mark.parametrize("lost", [400, 5000, 9000])
def test_a_truncated_file_is_refused_with_its_numbers(file, lost):
    header = replace(file[0], size=file[0].size - lost)
    with pytest.raises(ReadError, match=r"11936 bytes; a.c3d.*frame"):
        expected_layout(header, file[1])


def test_contradicting_counts_are_settled_by_the_length_of_the_file(file):
    layout, findings = expected_layout(replace(file[0], last_frame=20), file[1])
    assert layout.frames == 50
    assert "frames as 50 and" in findings[0].what
    layout, findings = expected_layout(file[0], _with(file[1], POINT__USED=900))
    assert layout.points == 3
    assert says(findings[0].what, "points as 900", "3", "3")


def test_more_frames_than_16_bits_hold(file):
    parameters = _with(file[1], POINT__FRAMES=-1, TRIAL__ACTUAL_START_FIELD=1)
    parameters = C3DParameters(
        {**parameters.values, ("TRIAL", "ACTUAL_END_FIELD"): np.array([100_000 - 2**17, 1], np.int32)}
    )
    header = replace(file[0], last_frame=65535, size=3 * 512 + 100_000 * 208)
    assert expected_layout(header, parameters)[0].frames == 100_000
    with pytest.raises(ReadError, match=r"100000 frames.*truncated"):
        expected_layout(replace(header, size=3 * 512 + 70_000 * 208), parameters)


def test_a_header_that_misses_the_data_is_refused(file):
    with pytest.raises(ReadError, match=r"block 3, POINT:DATA_START.*4"):
        expected_layout(replace(file[0], data_block=3), file[1])


@pytest.mark.parametrize(("header", "parameter"), [(-0.1, 0.1), (0.1, -0.1), (0.1, 0.2)])
def test_contradicting_scales_are_refused(file, header, parameter):
    with pytest.raises(ReadError, match=rf"a\.c3d.*{header}.*{parameter}"):
        expected_layout(replace(file[0], scale=header), _with(file[1], POINT__SCALE=parameter))


def test_frames_that_no_count_covers_are_reported(file):
    _, findings = expected_layout(replace(file[0], size=file[0].size + 3000), file[1])
    assert says(findings[0].what, "50 frames", "1")


def test_a_file_without_anything_is_refused(file):
    header = replace(file[0], points=0, analog_values=0)
    with pytest.raises(ReadError, match="points or analog"):
        expected_layout(header, _with(file[1], POINT__USED=0, ANALOG__USED=0))
