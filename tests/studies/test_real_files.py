import re

import pytest
import real_files
from texts import says

# By default the rooms read these files: tests/ingest/test_c3d.py and test_reading.py, tests/signals/test_emg.py and
# test_contact_movement.py, tests/processing/test_side_checks.py.
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def rows(gait_data):
    return {promise: (recordings, words) for recordings, promise, words in real_files.run(gait_data)}


def test_plates_and_events_agree_within_two_frames(rows):
    recordings, words = rows["events and plates compared"]
    assert recordings.endswith("12 walks")
    middle, low, high, count = (float(n) for n in re.findall(r"[-+]?\d+", words))
    assert abs(middle) <= 20 and high - low <= 20 and count >= 15


def test_dead_emg_is_named_exactly_as_the_manifest_has_it(rows):
    assert rows["dead EMG as in manifest.csv"] == (
        "young_straight_and_turn, 14 files",
        "13 files agree exactly",
    )  # HC033A22


def test_every_dialect_is_read_encodings_are_one_trial_and_what_cannot_be_read_is_refused(rows):
    assert rows["every dialect read"] == ("opensim_walks, 12 files", "12 read")
    assert says(rows["one time base"][1], "100 Hz", "0.01 to 4.61 s")
    assert says(rows["encodings equal"][1], "6 encodings", "0.00 mm")
    assert says(rows["read, or refused in words"][1], "25 read", "sgi_int.c3d, sgi_real.c3d")
