from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.strides import cut_strides


@pytest.mark.parametrize("stride_s", [0.66, 1.1, 1.6])
def test_one_contact_a_stride_at_the_same_percent(made, stride_s):
    walk, contacts = made.walk(20, stride_s)
    found = angle_contacts(walk)
    percent = [100 * np.abs(contacts - t).min() / stride_s for t in found["r"].time]
    assert 19 <= len(found["r"]) <= 21
    assert 19 <= len(found["l"]) <= 21
    assert max(percent) < 7  # the made knee is straightest at 97 %
    assert np.std(percent) < 1.5
    assert found["r"].note.startswith("end of the knee's extension")


def test_without_a_knee_the_hip_stands_in(made):
    walk, contacts = made.walk(20)
    found = angle_contacts(walk.selected(["hip_flexion_r"]), ("r",))["r"]
    percent = np.array([(np.interp(t, contacts, np.arange(21)) * 100) % 100 for t in found.time[1:-1]])
    assert says(found.note, "hip flexion peak", "86 %")
    assert np.all((percent > 80) & (percent < 95))


def test_no_hip_is_refused(made):
    walk, _ = made.walk(5)
    with pytest.raises(ChannelError, match=r"walk\.mot.*1 channels.*'hip_flexion_r'"):
        angle_contacts(walk.selected(["knee_angle_r"]))


def test_a_hip_that_does_not_swing_is_refused(made):
    walk, _ = made.walk(5)
    with pytest.raises(StrideError, match=r"5 deg.*walk\.mot, hip_flexion_r: 0\.\d deg"):
        angle_contacts(walk.with_values(walk.values / 100))


@pytest.mark.parametrize(
    ("file", "strides"),
    [
        ("c3d_Trimmed_running_natural2_manual_scaling_ik.mot", 83),
        ("c3d_Trimmed_running_exotendon3_manual_scaling_ik.mot", 88),
        ("welk002/manual_ik.mot", 90),
    ],
)
def test_real_running_has_its_strides(gait_data, real, file, strides):
    run = real.mot(gait_data / "exotendon_run" / file)
    found = cut_strides(angle_contacts(run)["r"], run)
    assert abs(len(found) - strides) <= 1
    assert found.dropped == ()


def test_real_treadmill_walks_have_221_strides_and_a_stumble(gait_data, real):
    walks = real.treadmill_walks(gait_data)
    walks.pop("S01DE503")
    found = [cut_strides(angle_contacts(walk)["r"], walk) for walk in walks.values()]
    assert len(found) == 12
    assert sum(len(strides) + len(strides.dropped) for strides in found) == pytest.approx(221, rel=0.01)
    assert all(9 < stride.start < 12 for strides in found for stride in strides.dropped)
