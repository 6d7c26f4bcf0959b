"""The filter, gaps that it must not cross, and a low-pass that a record has been through."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import butter, lfilter, sosfiltfilt
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording, Source, Strides
from gaitdisc.signals.butterworth import count_needed, effective_cutoff_hz, high_pass, low_pass, short_run_findings
from gaitdisc.signals.gaps import fill_gaps, gap_findings
from gaitdisc.signals.recorded_filter import find_filter, mean_spectrum

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
@pytest.mark.parametrize(("filter_", "cutoff"), [(low_pass, 6.0), (high_pass, 20.0)])
def test_a_sine_at_the_effective_cutoff_is_3_db_down_without_lag(filter_, cutoff, order):
    frequency = effective_cutoff_hz(cutoff, 100.0, order)
    if filter_ is high_pass:  # the mirror image of a low-pass, about a quarter of the rate
        frequency = 50.0 - effective_cutoff_hz(50.0 - cutoff, 100.0, order)
    along, across = gain(filter_, frequency, cutoff_hz=cutoff, order=order)
    assert along == pytest.approx(np.sqrt(0.5), abs=2e-3)
    assert across == pytest.approx(0.0, abs=2e-3)


def test_at_the_design_cutoff_two_passes_are_6_db_down():
    assert gain(low_pass, 6.0, cutoff_hz=6.0)[0] == pytest.approx(0.5, abs=2e-3)


def test_the_roll_off_is_that_of_eighth_order():
    rate = 1000.0  # far from half the rate, where the bilinear transform bends nothing
    one, two = gain(low_pass, 12.0, rate, cutoff_hz=6.0)[0], gain(low_pass, 24.0, rate, cutoff_hz=6.0)[0]
    assert 20 * np.log10(one / two) == pytest.approx(48.2, abs=0.5)


def test_a_constant_stays_and_a_highpass_takes_it_away():
    x = recording(np.full(300, 12.3))
    assert np.allclose(low_pass(x).values, 12.3, atol=1e-12)
    assert np.allclose(high_pass(x, 5.0).values, 0.0, atol=1e-12)


def test_edges_are_marked_for_1_8_periods():
    marks = low_pass(recording(np.sin(np.arange(500) / 20))).suspect[:, 0]
    assert np.flatnonzero(~marks)[[0, -1]].tolist() == [30, 469]


def test_a_short_gap_is_bridged_and_marked_a_long_one_stays():
    x = np.sin(2 * np.pi * np.arange(1000) / 100)
    x[200:208] = np.nan
    x[500:530] = np.nan
    done = low_pass(recording(x), 6.0)
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
    assert np.isnan(low_pass(recording(x)).values[120:130, 0]).all()
    (finding,) = short_run_findings(recording(x))
    assert says(finding.what, "1 segment", "18 samples (0.180 s)")
    assert "requires 18 samples" in finding.spoils
    assert finding.spans == ((1.2, 1.3),)


def test_a_recording_too_short_is_refused():
    assert count_needed(6.0, 100.0) == 18
    with pytest.raises(SamplingError, match=r"6 Hz.*18 samples.*walk\.mot.*17.*longer"):
        low_pass(recording(np.zeros(17)))


@pytest.mark.parametrize("cutoff", [50.0, 80.0, 0.0, -1.0])
def test_a_cutoff_outside_of_the_band_is_refused(cutoff):
    with pytest.raises(SamplingError, match=r"0 Hz.*50 Hz.*walk\.mot.*100 samples"):
        low_pass(recording(np.zeros(500)), cutoff)


def test_a_heading_that_passes_180_deg_is_filtered_as_it_goes_on():
    """Filtered as numbers, the leap of 360 deg rings: samples of 201 and 36 deg that nobody measured."""
    t = np.arange(600) / 100
    true = 170 + 8 * t + 4 * np.sin(2 * np.pi * t)
    raw = np.stack([(true + 180) % 360 - 180, (true + 180) % 360 - 180], axis=1)
    raw[260:265] = np.nan
    channels = (Channel("pelvis_rotation", "angle", "deg"), Channel("RFootProgressAngles.z", "angle", "deg", "r"))
    smooth = low_pass(Recording(t, raw, channels))
    plain = low_pass(Recording(t, np.stack([true, true], axis=1), channels))
    apart = (smooth.values - plain.values + 180) % 360 - 180
    assert np.abs(apart[40:-40]).max() < 0.2
    assert np.abs(smooth.values).max() <= 180
    assert (
        np.abs((fill_gaps(Recording(t, raw, channels)).values[260:265, 0] - true[260:265] + 180) % 360 - 180).max()
        < 0.1
    )


def test_a_real_turn_in_a_laboratory_turned_by_120_deg(gait_data):
    """The pelvis turns from 0 to 94 deg; turned by 120 deg the same walk passes 180 deg."""
    file = gait_data / "young_straight_and_turn" / "HC030A" / "turn" / "HC030A22.c3d"
    pelvis = read_trial(file).stream("kinematics").selected(["LPelvisAngles.z"])
    turned = pelvis.with_values((pelvis.values + 120 + 180) % 360 - 180)
    there = (low_pass(turned).values - 120 - low_pass(pelvis).values + 180) % 360 - 180
    assert np.nanmax(np.abs(there)) < 1e-6


TIME = np.arange(1000) / 100


def knee(x):
    return Recording(TIME, np.asarray(x, float)[:, None], (KNEE,))


def broken(x, start, length):
    x = x.copy()
    x[start : start + length] = np.nan
    return knee(x)


@settings(deadline=None, max_examples=30)
@given(st.integers(25, 900), st.integers(1, 10))
def test_a_cubic_is_filled_exactly_and_marked(start, length):
    x = TIME**3 - 4 * TIME**2 + TIME
    done = fill_gaps(broken(x, start, length))
    assert np.allclose(done.values[:, 0], x, atol=1e-8)
    assert np.flatnonzero(done.suspect[:, 0]).tolist() == list(range(start, start + length))


def test_what_is_measured_is_not_touched():
    done = fill_gaps(broken(np.sin(TIME), 300, 8))
    kept = np.r_[0:300, 308:1000]
    assert np.array_equal(done.values[kept, 0], np.sin(TIME)[kept])


def test_a_long_gap_stays_open_and_spoils_150_ms_beside_it():
    done = fill_gaps(broken(np.sin(TIME), 300, 11))
    assert np.isnan(done.values[300:311, 0]).all()
    assert np.flatnonzero(done.suspect[:, 0]).tolist() == list(range(285, 326))


def test_a_gap_at_an_end_stays_open():
    assert np.isnan(fill_gaps(broken(np.sin(TIME), 0, 3)).values[:3, 0]).all()
    assert np.isnan(fill_gaps(broken(np.sin(TIME), 997, 3)).values[997:, 0]).all()


def test_strides_bring_200_ms_back():
    x = 20 * np.sin(2 * np.pi * TIME) + 5 * np.cos(6 * np.pi * TIME) + 0.5 * TIME
    strides = Strides(np.arange(9.0), np.arange(1.0, 10.0), "r", "force")
    done = fill_gaps(broken(x, 430, 20), strides)
    assert np.abs(done.values[:, 0] - x).max() < 0.3
    assert np.isnan(fill_gaps(broken(x, 430, 21), strides).values[430:451, 0]).all()


def test_too_few_whole_strides_make_no_template():
    strides = Strides(np.arange(4.0), np.arange(1.0, 5.0), "r", "force")
    assert np.isnan(fill_gaps(broken(np.sin(TIME), 130, 15), strides).values[130:145, 0]).all()


def test_findings_tell_short_from_long():
    short, long = gap_findings(broken(np.sin(TIME), 300, 8))[0], gap_findings(broken(np.sin(TIME), 300, 30))[0]
    assert (short.severity, long.severity) == ("note", "warning")
    assert says(short.what, "1 gap, 0.080 s", "10.00 s", "0.080 s")
    assert long.spans == ((3.0, 3.3),)
    assert gap_findings(knee(np.sin(TIME))) == []


@pytest.mark.parametrize(("samples", "severity"), [(5, "note"), (30, "warning")])
def test_a_short_gap_at_an_end_is_a_note_and_stays_open(samples, severity):
    """A recording that begins 50 ms later would be said to lack nothing."""
    late = broken(np.sin(TIME), 0, samples)
    assert [one.severity for one in gap_findings(late)] == [severity]
    assert np.isnan(fill_gaps(late).values[:samples]).all()


def test_an_empty_channel_is_one_gap():
    finding = gap_findings(knee(np.full(1000, np.nan)))[0]
    assert finding.severity == "warning"
    assert finding.spans == ((0.0, pytest.approx(10.0)),)


RATE = 100.0
LONG = np.arange(3000) / RATE


def _signal(seed):
    """A mass on a spring that noise pushes: its spectrum falls with the fourth power of frequency."""
    push = np.random.default_rng(seed).normal(size=len(LONG))
    slow = sosfiltfilt(butter(4, 1.0, fs=RATE, output="sos"), lfilter([1.0], [1, -1.98, 0.984], push))
    return slow / slow.std()


def _trials(noise, cutoff=None, order=2, signal=_signal):
    trials = [signal(seed) + noise * np.random.default_rng(99 + seed).normal(size=len(LONG)) for seed in range(4)]
    if cutoff is None:
        return trials
    return [sosfiltfilt(butter(order, cutoff, fs=RATE, output="sos"), one) for one in trials]


@pytest.mark.parametrize(("cutoff", "noise"), [(3.0, 0.1), (6.0, 0.01), (6.0, 0.1), (10.0, 0.01), (10.0, 0.1)])
def test_the_cut_off_is_found(cutoff, noise):
    found = find_filter(_trials(noise, cutoff), RATE)
    assert found.cutoff_hz == pytest.approx(cutoff, rel=0.06)
    assert found.signal < 0.1
    assert found.noise == pytest.approx(noise, rel=0.2)


def test_gaps_and_written_digits_do_not_matter():
    trials = [np.round(one, 4) for one in _trials(0.02, 6.0)]
    for trial in trials:
        trial[700:730] = trial[2100:2110] = np.nan
    assert find_filter(trials, RATE).cutoff_hz == pytest.approx(6.0, rel=0.06)


def test_raw_records_show_none():
    assert find_filter(_trials(0.02), RATE) is None
    assert find_filter([np.round(one, 3) for one in _trials(1e-5)], RATE) is None
    slow = [lfilter([0.05], [1, -0.95], one) for one in _trials(1.0)]
    assert find_filter(slow, RATE) is None


def test_a_smooth_signal_without_noise_is_one_with_a_signal_in_the_way_or_none():
    found = find_filter(_trials(0.0), RATE)
    assert found is None or found.signal > 10


def _broad(seed):
    return lfilter([1.0], [1, -1.8, 0.81], np.random.default_rng(seed).normal(size=len(LONG)))


def test_where_the_signal_is_in_the_way_a_like_one_helps():
    trials, like = _trials(0.02, 6.0, signal=_broad), [1.2 * _broad(seed) for seed in range(4)]
    found = find_filter(trials, RATE, like)
    assert found.cutoff_hz == pytest.approx(6.0, rel=0.1)
    assert find_filter([_broad(seed) for seed in range(4)], RATE, like) is None


def test_a_record_too_short_shows_none():
    assert find_filter([np.zeros(127)], RATE) is None
    assert mean_spectrum([np.full(500, np.nan)]) is None


def test_the_spectrum_is_that_of_whole_stretches():
    trial = np.sin(2 * np.pi * 10 * LONG)
    trial[1000:1005] = np.nan
    spectrum = mean_spectrum([trial])
    assert spectrum.frequency[np.argmax(spectrum.power)] == pytest.approx(0.1, abs=0.003)
    assert spectrum.windows == 2 + 6


@pytest.mark.parametrize("noise", [0.05, 0.1])
def test_a_short_record_shows_at_the_cut_off_of_channels_beside_it_what_it_does_not_show_alone(noise):
    trials = [one[:300] for one in _trials(noise, 6.0)]
    assert find_filter(trials, RATE) is None
    assert find_filter(trials, RATE, at_hz=6.1).cutoff_hz == pytest.approx(6.1)


def test_a_raw_channel_beside_filtered_ones_and_one_of_a_steeper_filter_went_through_none_of_order_2():
    for noise in (0.003, 0.02, 0.1):
        assert find_filter(_trials(noise), RATE, at_hz=6.0) is None
        assert find_filter([one[:400] for one in _trials(noise)], RATE, at_hz=6.0) is None
    steeper = _trials(0.1, 6.0, order=4)
    assert find_filter(steeper, RATE) is None and find_filter(steeper, RATE, at_hz=6.0) is None
    assert find_filter(_trials(0.1, 12.0), RATE, at_hz=6.0).cutoff_hz == pytest.approx(12.0, rel=0.06)
