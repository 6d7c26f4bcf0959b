from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ChannelError
from gaitdisc.response.samples import gait_samples

ANKLE = "ankle_angle_r"


def test_eq_4_2_state_rate_and_percent_stride_in_acceleration_out(nominal):
    samples, dropped = gait_samples(nominal, (ANKLE,))
    assert samples.inputs == (
        "knee_angle_r", "ankle_angle_r", "d(knee_angle_r)/dt", "d(ankle_angle_r)/dt", "phi",
    )  # fmt: skip
    assert samples.outputs == ("d2(ankle_angle_r)/dt2",)
    np.testing.assert_array_equal(samples.x[:, 1], nominal.x[:, 1])
    np.testing.assert_array_equal(samples.x[:, 2], nominal.xdot[:, 0])
    np.testing.assert_array_equal(samples.x[:, 4], nominal.phi)
    np.testing.assert_array_equal(samples.y[:, 0], nominal.xddot[:, 1])
    assert (dropped.total, dropped.kept, dict(dropped.unusable)) == (6000, 6000, {})
    assert dropped.finding().severity == "note"


def test_the_dissertations_49_inputs(nominal):
    wide = replace(
        nominal,
        channels=tuple(nominal.channels[0].renamed(f"c{k}") for k in range(24)),
        **{part: np.tile(getattr(nominal, part), (1, 12)) for part in ("x", "xdot", "xddot", "usable")},
    )
    samples, _ = gait_samples(wide, ("c0", "c3"))
    assert samples.x.shape == (6000, 49)


def test_what_is_left_away_is_counted_with_its_reason(nominal):
    usable, phi = nominal.usable.copy(), nominal.phi.copy()
    usable[100:200, 0] = False
    phi[150:350] = np.nan
    samples, dropped = gait_samples(replace(nominal, usable=usable, phi=phi), (ANKLE,))
    assert len(samples) == dropped.kept == 5750
    assert np.isfinite(samples.phi).all()
    assert says(
        dropped.finding().line(), "P01", "left", "250 of 6000 samples left", "200 outside", "50", "knee_angle_r not"
    )
    usable[:3000] = False
    assert gait_samples(replace(nominal, usable=usable), (ANKLE,))[1].finding().severity == "warning"


def test_an_output_that_is_not_there(nominal):
    with pytest.raises(ChannelError, match=r"'ankle_angl_r'.*P01.*2 channels"):
        gait_samples(nominal, ("ankle_angl_r",))
    with pytest.raises(ChannelError, match=r"least.*channel to predict"):
        gait_samples(nominal, ())
