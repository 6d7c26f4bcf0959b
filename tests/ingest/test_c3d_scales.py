"""Scales of a C3D file that are 0, infinite or no number: refused or named, never other numbers without a word."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d import unscaled_channels
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.ingest.reading import read_trial

UNUSABLE = (float("nan"), float("inf"), float("-inf"), 0.0)


def _with_float(path, group, name, number, place=0):
    """Write a number over one of a parameter of floats, found by the number of its group."""
    content = bytearray(path.read_bytes())
    of_group = 256 - content[content.index(group.encode(), 512) - 1]
    after = content.index(bytes([len(name), of_group]) + name.encode(), 512) + 2 + len(name) + 2
    assert content[after] == 4, "a float has four bytes"
    at = after + 2 + content[after + 1] + 4 * place
    content[at : at + 4] = struct.pack("<f", number)
    path.write_bytes(content)


@pytest.fixture
def real(gait_data, tmp_path):
    """A real trial with two plates, EMG, and points as floats, to be spoiled."""
    (found,) = (gait_data / "young_straight_and_turn" / "HC030A" / "straight").glob("*.c3d")
    path = tmp_path / "walk.c3d"
    path.write_bytes(found.read_bytes())
    return path


@pytest.mark.parametrize("number", UNUSABLE)
@pytest.mark.parametrize(("group", "name"), [("ANALOG", "GEN_SCALE"), ("POINT", "SCALE")])
def test_a_scale_of_everything_that_cannot_be_used_is_refused(real, reader, group, name, number):
    _with_float(real, group, name, number)
    said = rf"finite scales other than 0; {group}:{name} of walk\.c3d is {number:g}\. Export the trial again"
    with pytest.raises(ReadError, match=said):
        read_trial(real, reader=reader)


@pytest.mark.parametrize("number", UNUSABLE)
def test_a_scale_of_points_in_the_header_that_cannot_be_used_is_refused(real, reader, number):
    content = bytearray(real.read_bytes())
    content[12:16] = struct.pack("<f", number)
    real.write_bytes(content)
    with pytest.raises(ReadError, match=rf"walk\.c3d.*{number:g}"):
        read_trial(real, reader=reader)


@pytest.mark.parametrize("number", UNUSABLE)
def test_a_channel_without_a_scale_is_missing_and_named(real, reader, number):
    sound = read_trial(real, reader=reader)
    place = 12  # the first after the channels of two plates
    _with_float(real, "ANALOG", "SCALE", number, place)
    trial = read_trial(real, reader=reader)
    (said,) = [f for f in trial.findings if f.kind == "scale"]
    assert said.severity == "warning" and said.file == "walk.c3d"
    assert said.what.startswith(f"ANALOG:SCALE of channel #{place + 1} ") and f"is {number:g}; taken" in said.what
    emg, before = trial.stream("emg").values, sound.stream("emg").values
    gone = np.isnan(emg).all(axis=0)
    assert gone.sum() == 1
    np.testing.assert_array_equal(emg[:, ~gone], before[:, ~gone])
    np.testing.assert_array_equal(trial.stream("forces").values, sound.stream("forces").values)


def test_a_plate_with_such_a_channel_is_not_used(real, reader):
    _with_float(real, "ANALOG", "SCALE", float("nan"), 2)
    trial = read_trial(real, reader=reader)
    assert {name[:7] for name in trial.stream("forces").names} == {"plate_2"}
    assert any(says(f.what, "force plate 1", "scale") for f in trial.findings)


def test_offsets_are_held_to_the_same_and_zero_is_one():
    parameters = C3DParameters(
        {
            ("ANALOG", "LABELS"): ("L Rect", "R Rect", "L Hams"),
            ("ANALOG", "SCALE"): np.array([1.0, 0.0, 1.0]),
            ("ANALOG", "OFFSET"): np.array([0.0, 0.0, np.nan]),
        }
    )
    columns, (finding,) = unscaled_channels(parameters, 3, "a.c3d")
    assert columns == {1, 2}
    assert says(finding.what, "ANALOG:SCALE", "#2", "0; ANALOG:OFFSET", "#3")
