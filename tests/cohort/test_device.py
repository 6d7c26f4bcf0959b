from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.device import Spring


def test_the_spring_acts_on_one_side_only():
    moment = Spring(5.0).moment(np.array([-10.0, -1.0, 0.0, 9.0]), engaged_deg=-1.0)
    assert moment == pytest.approx([0.0, 0.0, -5.0, -50.0])


def test_slack_moves_the_engagement():
    assert Spring(5.0, slack_deg=3.0).moment(np.array([1.0, 3.0]), engaged_deg=-1.0) == pytest.approx([0.0, -5.0])
