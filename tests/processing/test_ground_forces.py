from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.processing.trial_cycles import weighed_forces
from gaitdisc.recording import Recording, Trial

STEP = np.sin(np.linspace(0, np.pi, 60))
FORE_AFT = 20 * np.sin(np.linspace(0, 2 * np.pi, 60))  # positive first: brakes


def _trial(sign=1.0, unit="%"):
    values = np.full((200, 4), np.nan)
    values[50:110, 0], values[50:110, 1] = sign * FORE_AFT, 110 * STEP
    labels = ("LNormalisedGRF.x", "LNormalisedGRF.z", "RNormalisedGRF.x", "RNormalisedGRF.z")
    channels = tuple(Channel(label, "force", unit) for label in labels)
    return Trial("a", {"moments": Recording(np.arange(200) / 100, values, channels)})


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_step_brakes_first_whichever_way_the_file_counts_and_is_zero_off_the_plate(sign):
    found = weighed_forces(_trial(sign))
    assert found.names == ("ground_force_l_vx", "ground_force_l_vy")  # the right foot met no plate
    assert found["ground_force_l_vx"][65] == pytest.approx(-20.0, abs=0.1)
    assert found["ground_force_l_vx"][95] == pytest.approx(20.0, abs=0.2)
    assert found["ground_force_l_vy"].max() == pytest.approx(110.0, abs=0.1)
    assert not found["ground_force_l_vy"][[0, 49, 110, 199]].any()


def test_another_unit_or_no_moments_give_none():
    assert weighed_forces(_trial(unit="N")) is None
    knee = Recording(np.arange(3) / 100, np.zeros((3, 1)), (Channel("knee_angle_r", "angle", "deg", "r"),))
    assert weighed_forces(Trial("a", {"kinematics": knee})) is None
