from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Strides
from gaitdisc.signals.sides import knee_peak_percent, verify_sides


def right_strides(contacts, side="r"):
    return Strides(contacts[:-1], contacts[1:], side, "force")


def test_the_knee_of_the_side_peaks_in_swing(made):
    walk, contacts = made.walk(12)
    assert verify_sides(walk, right_strides(contacts)) == pytest.approx(70, abs=2)
    assert knee_peak_percent(walk, right_strides(contacts), "knee_angle_l") == pytest.approx(20, abs=2)


def test_swapped_sides_are_refused_with_what_was_seen(made):
    walk, contacts = made.walk(12)
    with pytest.raises(StrideError, match=r"knee_angle_l.*(19|20|21) %, knee_angle_r.*(69|70|71) %: left.*right"):
        verify_sides(walk, right_strides(contacts, "l"))


def test_a_knee_of_the_other_sign_is_refused(made):
    walk, contacts = made.walk(12)
    with pytest.raises(StrideError, match="flexion is positive"):
        verify_sides(walk.with_values(-walk.values), right_strides(contacts))


def test_a_stiff_or_missing_knee_tells_nothing(made):
    walk, contacts = made.walk(12)
    assert np.isnan(verify_sides(walk.with_values(walk.values / 100), right_strides(contacts)))
    with pytest.raises(ChannelError, match="knee_angle_r"):
        verify_sides(walk.selected(["hip_flexion_r"]), right_strides(contacts))
