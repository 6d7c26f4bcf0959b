from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import StrideError
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.strides import cut_strides


def contacts(durations, start=1.0):
    return Contacts(start + np.concatenate([[0.0], np.cumsum(durations)]), "r", "force")


def test_every_contact_begins_a_stride():
    strides = cut_strides(contacts([1.0, 1.1, 0.95, 1.05]))
    assert strides.duration_s == pytest.approx([1.0, 1.1, 0.95, 1.05])
    assert (strides.side, strides.detector, strides.dropped) == ("r", "force", ())


@pytest.mark.parametrize(
    ("odd", "words"),
    [
        (0.3, "0.30 s is shorter than 0.4 s: a contact too many"),
        (3.0, "3.00 s is longer than 2.5 s: a pause, or a contact was missed"),
        (
            2.1,
            "2.10 s differs from the median stride of 1.00 s by more than 15 % and 6 robust sd: a contact was missed",
        ),
        (0.8, "0.80 s differs from the median stride of 1.00 s by more than 15 % and 6 robust sd: a stumble, or"),
    ],
)
def test_an_odd_stride_is_dropped_with_its_reason(odd, words):
    durations = [1.0] * 5 + [odd] + [1.0] * 5
    strides = cut_strides(contacts(durations))
    assert len(strides) == 10
    assert len(strides.dropped) == 1
    assert strides.dropped[0].start == pytest.approx(6.0)
    assert strides.dropped[0].reason.startswith(words)


def test_natural_variability_drops_nothing():
    rng = np.random.default_rng(0)
    for _ in range(50):
        assert cut_strides(contacts(1.1 * (1 + 0.03 * rng.normal(size=200)))).dropped == ()


def test_a_gap_in_the_data_drops_its_stride(made):
    walk, at = made.walk(12)
    values = walk.values.copy()
    first = int(np.searchsorted(walk.time, at[4] + 0.3))
    values[first : first + 25, 1] = np.nan
    strides = cut_strides(Contacts(at, "r", "force"), walk.with_values(values))
    assert len(strides) == 11
    assert strides.dropped[0].reason == "knee_angle_r missing for 0.25 s"
    values[first : first + 25, 1] = walk.values[first : first + 25, 1]
    values[first : first + 8, 1] = np.nan  # short enough to be filled
    assert cut_strides(Contacts(at, "r", "force"), walk.with_values(values)).dropped == ()


def test_a_channel_without_any_value_drops_nothing(made):
    walk, at = made.walk(12)
    values = walk.values.copy()
    values[:, 3] = np.nan
    assert len(cut_strides(Contacts(at, "r", "force"), walk.with_values(values))) == 12


def test_strides_beyond_the_recording_are_dropped(made):
    walk, at = made.walk(12)
    strides = cut_strides(Contacts(at, "r", "force"), walk.between(0.0, 6.0))
    assert len(strides) + len(strides.dropped) == 12
    assert says(strides.dropped[0].reason, "0.00", "5.99 s")


def test_one_contact_is_no_stride():
    with pytest.raises(StrideError, match=r"two initial contacts.*1.*'r'"):
        cut_strides(contacts([]))


def test_no_stride_left_is_refused_with_the_first_reason():
    with pytest.raises(StrideError, match=r"2.*left.*1\.00 s: 5\.00 s.*longer.*2\.5 s"):
        cut_strides(contacts([5.0, 6.0]))
