import math

import pytest

from gaitdisc.recording import Cycle


def test_shares_of_a_cycle_that_is_known():
    one = Cycle("r", 2.0, 3.0, ("events", "events"), foot_off=2.6, opposite_off=2.1, opposite_contact=2.5)
    assert one.duration_s == 1.0
    assert one.stance_percent == pytest.approx(60.0)
    assert one.double_support_percent == pytest.approx(20.0)


def test_what_is_not_known_is_missing():
    assert math.isnan(Cycle("l", 0.0, 1.0, ("force", "force")).stance_percent)
    assert math.isnan(Cycle("l", 0.0, 1.0, ("force", "force"), foot_off=0.6).double_support_percent)
