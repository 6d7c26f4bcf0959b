from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording, Source
from gaitdisc.signals.butterworth import effective_cutoff_hz, highpassed, lowpassed, needed_samples, short_run_findings
from gaitdisc.signals.gaps import filled

KNEE = Channel("knee_angle_r", "angle", "deg", "r")


def recording(x, rate=100.0):
    return Recording(np.arange(len(x)) / rate, np.asarray(x, float)[:, None], (KNEE,), source=Source("walk.mot"))


def gain(filter_, frequency, rate=100.0, **settings):
    """Amplitude of a filtered sine over the sine's, least squares in the middle."""
    t = np.arange(round(60 * rate)) / rate
    wave = np.column_stack([np.sin(2 * np.pi * frequency * t), np.cos(2 * np.pi * frequency * t)])
    out = filter_(recording(wave[:, 0], rate), **settings).values[:, 0]
    middle = slice(len(t) // 4, 3 * len(t) // 4)
    a, b = np.linalg.lstsq(wave[middle], out[middle], rcond=None)[0]
    return a, b


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize(("filter_", "kind", "cutoff"), [(lowpassed, "lowpass", 6.0), (highpassed, "highpass", 20.0)])
def test_a_sine_at_the_effective_cutoff_is_3_db_down_without_lag(filter_, kind, cutoff, order):
    frequency = effective_cutoff_hz(cutoff, 100.0, order, kind)
    along, across = gain(filter_, frequency, cutoff_hz=cutoff, order=order)
    assert along == pytest.approx(np.sqrt(0.5), abs=2e-3)
    assert across == pytest.approx(0.0, abs=2e-3)


def test_at_the_design_cutoff_two_passes_are_6_db_down():
    assert gain(lowpassed, 6.0, cutoff_hz=6.0)[0] == pytest.approx(0.5, abs=2e-3)


def test_the_roll_off_is_that_of_eighth_order():
    rate = 1000.0  # far from half the rate, where the bilinear transform bends nothing
    one, two = gain(lowpassed, 12.0, rate, cutoff_hz=6.0)[0], gain(lowpassed, 24.0, rate, cutoff_hz=6.0)[0]
    assert 20 * np.log10(one / two) == pytest.approx(48.2, abs=0.5)


def test_a_constant_stays_and_a_highpass_takes_it_away():
    x = recording(np.full(300, 12.3))
    assert np.allclose(lowpassed(x).values, 12.3, atol=1e-12)
    assert np.allclose(highpassed(x, 5.0).values, 0.0, atol=1e-12)


def test_edges_are_marked_for_1_8_periods():
    marks = lowpassed(recording(np.sin(np.arange(500) / 20))).suspect[:, 0]
    assert np.flatnonzero(~marks)[[0, -1]].tolist() == [30, 469]


def test_a_short_gap_is_bridged_and_marked_a_long_one_stays():
    x = np.sin(2 * np.pi * np.arange(1000) / 100)
    x[200:208] = np.nan
    x[500:530] = np.nan
    done = lowpassed(recording(x), 6.0)
    assert np.isfinite(done.values[200:208, 0]).all()
    assert done.suspect[200:208, 0].all()
    assert np.isnan(done.values[500:530, 0]).all()
    assert np.isfinite(done.values[[499, 530], 0]).all()
    assert done.suspect[470:500, 0].all()
    assert done.suspect[530:560, 0].all()
    assert not done.suspect[300:460, 0].any()


def test_a_run_too_short_is_left_out_and_said():
    x = np.sin(np.arange(400) / 20)
    x[100:120] = np.nan
    x[130:150] = np.nan
    assert np.isnan(lowpassed(recording(x)).values[120:130, 0]).all()
    (finding,) = short_run_findings(recording(x))
    assert says(finding.what, "1 stretch(es)", "shorter", "18 samples (0.180 s)")
    assert "needs 18 samples" in finding.spoils
    assert finding.spans == ((1.2, 1.3),)


def test_a_recording_too_short_is_refused():
    assert needed_samples(6.0, 100.0) == 18
    with pytest.raises(SamplingError, match=r"6 Hz.*18 samples.*walk\.mot.*17.*longer"):
        lowpassed(recording(np.zeros(17)))


@pytest.mark.parametrize("cutoff", [50.0, 80.0, 0.0, -1.0])
def test_a_cutoff_outside_of_the_band_is_refused(cutoff):
    with pytest.raises(SamplingError, match=r"0 Hz.*50 Hz.*walk\.mot.*100 samples"):
        lowpassed(recording(np.zeros(500)), cutoff)


def test_a_heading_that_passes_180_deg_is_filtered_as_it_goes_on():
    """Filtered as numbers, the leap of 360 deg rings: samples of 201 and 36 deg that nobody measured."""
    t = np.arange(600) / 100
    true = 170 + 8 * t + 4 * np.sin(2 * np.pi * t)
    raw = np.stack([(true + 180) % 360 - 180, (true + 180) % 360 - 180], axis=1)
    raw[260:265] = np.nan
    channels = (Channel("pelvis_rotation", "angle", "deg"), Channel("RFootProgressAngles.z", "angle", "deg", "r"))
    smooth = lowpassed(Recording(t, raw, channels))
    plain = lowpassed(Recording(t, np.stack([true, true], axis=1), channels))
    apart = (smooth.values - plain.values + 180) % 360 - 180
    assert np.abs(apart[40:-40]).max() < 0.2
    assert np.abs(smooth.values).max() <= 180
    assert (
        np.abs((filled(Recording(t, raw, channels)).values[260:265, 0] - true[260:265] + 180) % 360 - 180).max() < 0.1
    )


def test_a_real_turn_in_a_laboratory_turned_by_120_deg(gait_data):
    """The pelvis turns from 0 to 94 deg; turned by 120 deg the same walk passes 180 deg."""
    file = gait_data / "young_straight_and_turn" / "HC030A" / "turn" / "HC030A22.c3d"
    pelvis = read_trial(file).stream("kinematics").selected(["LPelvisAngles.z"])
    turned = pelvis.with_values((pelvis.values + 120 + 180) % 360 - 180)
    there = (lowpassed(turned).values - 120 - lowpassed(pelvis).values + 180) % 360 - 180
    assert np.nanmax(np.abs(there)) < 1e-6
