from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_parameters import C3DParameters, read_c3d_header, read_c3d_parameters


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
