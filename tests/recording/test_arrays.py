"""Rows that stand together, spans of time, angles that wrap around."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Strides, Trial
from gaitdisc.recording.arrays import Span, mean_where_known, read_only, runs
from gaitdisc.recording.wrapping import find_turn, in_one_turn, unwrap, wrap_recording


def test_the_view_cannot_be_written_and_shares_memory():
    values = np.zeros(3)
    view = read_only(values)
    with pytest.raises(ValueError, match="read-only"):
        view[0] = 1.0
    assert np.shares_memory(view, values)
    values[0] = 2.0  # the caller's own array stays writable


def test_a_mean_is_of_the_values_that_are_there():
    values = np.array([[1.0, np.nan, np.nan, np.inf], [3.0, 5.0, np.nan, 2.0]])
    assert mean_where_known(values) == pytest.approx([2.0, 5.0, np.nan, 2.0], nan_ok=True)
    whole = np.random.default_rng(0).normal(size=(7, 3, 2))
    assert mean_where_known(whole) == pytest.approx(whole.mean(axis=0))


@given(st.lists(st.booleans(), max_size=40))
def test_runs_give_the_mask_back(mask):
    mask = np.array(mask, bool)
    back = np.zeros(len(mask), bool)
    for start, end in runs(mask):
        assert end > start
        back[start:end] = True
    assert np.array_equal(back, mask)


def test_a_span_holds_its_ends_and_shares_what_lies_in_both():
    assert Span(0.5, 1.0).holds(np.array([0.4, 0.5, 1.0, 1.1])).tolist() == [False, True, True, False]
    assert Span(0.5, 1.0).shared(Span(0.75, 2.0)).seconds == 0.25


HEADING = Channel("pelvis_rotation", "angle", "deg")
T = np.arange(400) / 100
TRUE = 150 + 30 * T + 5 * np.sin(2 * np.pi * T)  # passes 180 deg at about 1 s


def wrap(x, low=-180.0):
    return (x - low) % 360 + low


def heading(x=TRUE, channel=HEADING, time=T):
    return Recording(time, np.asarray(x, float)[:, None], (channel,))


@pytest.mark.parametrize("low", [-180.0, 0.0])
def test_a_heading_goes_on_and_comes_round_again(low):
    true = TRUE if low else TRUE + 180
    raw = heading(wrap(true, low))
    plain = unwrap(raw)
    np.testing.assert_allclose(plain.values[:, 0], true, atol=1e-9)
    np.testing.assert_allclose(wrap_recording(plain, raw).values, raw.values, atol=1e-9)


def test_a_gap_in_which_it_comes_round():
    raw = wrap(TRUE)
    raw[80:120] = np.nan
    plain = unwrap(heading(raw)).values[:, 0]
    known = np.isfinite(plain)
    assert known.sum() == 360
    np.testing.assert_allclose(plain[known], TRUE[known], atol=1e-9)


def test_a_joint_that_leaps_is_bad_data_and_stays():
    knee = heading(wrap(TRUE), Channel("knee_angle_r", "angle", "deg", "r"))
    assert unwrap(knee) is knee
    spiked = TRUE - 150
    spiked[200] += 200
    once = heading(spiked)
    assert unwrap(once) is once  # a leap of 200 deg is no turn
    assert unwrap(heading(TRUE - 150)).values[0, 0] == TRUE[0] - 150


def test_names_of_headings():
    yes = ("pelvis_rotation", "LPelvisAngles.z", "RFootProgressAngles.z", "trunk_heading", "pelvis_yaw")
    no = ("knee_angle_r", "LPelvisAnglesV.z", "RHipAngles.z", "arm_rot_r", "lumbar_rotation")
    assert all(find_turn(Channel(name, "angle", "deg")) == 360 for name in yes)
    assert not any(find_turn(Channel(name, "angle", "deg")) for name in no)
    assert find_turn(Channel("pelvis_rotation", "angle", "rad")) == pytest.approx(2 * np.pi)
    assert find_turn(Channel("pelvis_rotation", "signal", "1")) is None


def test_curves_of_strides_and_their_mean():
    """Four strides to and fro across 180 deg: the mean of the headings, not of their numbers."""
    x = 178 + 6 * np.sin(2 * np.pi * T)
    strides = Strides(np.arange(3.0), np.arange(1.0, 4.0), "r", "events")
    curves = strides.normalised(heading(wrap(x)))[:, :, 0]
    percent = np.arange(101) / 100
    np.testing.assert_allclose(curves.mean(axis=0), 178 + 6 * np.sin(2 * np.pi * percent), atol=0.02)
    circling = strides.normalised(heading(wrap(10 + 360 * np.floor(T) + 0 * T + 20 * np.sin(2 * np.pi * T))))
    assert np.ptp(circling[:, 0, 0]) < 0.1


def test_on_one_base_reads_the_short_way():
    on = Trial("w", {"kinematics": heading(wrap(TRUE))}).on_one_base(130.0)
    true = np.interp(on.time, T, TRUE)
    assert np.abs(wrap(on.values[:, 0] - true)).max() < 0.01
    assert on.values.max() <= 180


def test_gaps_stay_out_of_the_mean_of_directions():
    curves = np.array([[170.0, np.nan], [np.nan, np.nan], [-190.0, -185.0]])
    assert in_one_turn(curves, 360.0)[[0, 2], 0].tolist() == [170, 170]
