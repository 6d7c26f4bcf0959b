"""What the laboratory sees passes the package's own readers of signals, and tells the truth within its noise."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.measurement import BAND_HZ, CROSS_TALK, DELAY_S, FLOOR_V, RANGE_V, electrode_volts, heard, measure
from gaitdisc.cohort.person import JOINTS, MUSCLES, draw_one
from gaitdisc.cohort.walk import QUICK_HZ
from gaitdisc.signals.channel_quality import channel_findings
from gaitdisc.signals.contacts import force_contacts
from gaitdisc.signals.emg import ENVELOPE_HZ, emg_findings, envelopes


@pytest.fixture(scope="module")
def trials(nominal, exo):
    return {"nominal": measure(nominal, "C_nominal", "nominal"), "exo": measure(exo, "C_exo", "exo")}


def test_a_laboratorys_channels_and_rates(trials):
    streams = trials["nominal"].streams
    assert {key: (s.rate_hz, len(s.names)) for key, s in streams.items()} == {
        "kinematics": (pytest.approx(100.0), 10),
        "emg": (pytest.approx(1000.0), 14),
        "forces": (pytest.approx(1000.0), 4),
    }
    assert set(streams["kinematics"].names) == {f"{joint}_{side}" for joint in JOINTS for side in "rl"}
    assert set(streams["emg"].names) == {f"{muscle}_{side}" for muscle in MUSCLES for side in "rl"}


def test_angles_are_true_but_for_noise_and_where_the_markers_sit(trials, nominal):
    shown = trials["nominal"].stream("kinematics").values.reshape(-1, 2, 5)
    off = shown - nominal.angles
    constant = nominal.person.style.offset_deg.copy()
    constant[:, 0] += habitual("pelvis_tilt", nominal.person.dimensionless_speed).mean
    assert off.mean(axis=0) == pytest.approx(constant, abs=0.02)
    assert np.all((off.std(axis=0) > 0.15) & (off.std(axis=0) < 0.30))


@pytest.mark.parametrize("condition", ["nominal", "exo"])
@pytest.mark.parametrize("side", [0, 1])
def test_detected_strides_are_those_of_the_phase(trials, nominal, exo, condition, side):
    walk = {"nominal": nominal, "exo": exo}[condition]
    found = force_contacts(trials[condition].stream("forces"))["rl"[side]].time
    true = walk.contacts(side)
    durations, true_durations = np.diff(found), np.diff(true)
    cv, true_cv = (100 * d.std() / d.mean() for d in (durations, true_durations))
    assert abs(len(found) - len(true)) <= 1
    assert cv == pytest.approx(true_cv, abs=0.3)
    assert np.abs(found[:, None] - true).min(axis=1).max() < 0.02


def test_raw_emg_lives_and_fits_the_amplifier(trials):
    emg = trials["nominal"].stream("emg")
    assert emg_findings(emg) == []
    assert np.abs(emg.values).max() <= RANGE_V
    assert np.unique(np.round(emg.values / (RANGE_V / 2**15) % 1, 6)).tolist() in ([0.0], [0.0, 1.0])


def test_the_envelope_follows_the_excitation(trials, nominal):
    """Through the envelope's own low-pass, and as much earlier as the electromechanical delay."""
    envelope = envelopes(trials["nominal"].stream("emg"))
    low = butter(4, ENVELOPE_HZ, fs=QUICK_HZ, output="sos")
    driven = np.roll(sosfiltfilt(low, nominal.excitation[:, 0], axis=0), -round(DELAY_S * QUICK_HZ), axis=0)
    for muscle, name in enumerate(MUSCLES):
        seen, true = (
            nominal.strides(envelope[f"{name}_r"]).mean(axis=0),
            nominal.strides(driven[:, muscle]).mean(axis=0),
        )
        assert np.corrcoef(seen, true)[0, 1] > 0.99, name


def test_quality_checks_find_nothing_in_a_clean_walk(trials):
    for key in ("kinematics", "forces"):
        assert [f for f in channel_findings(trials["nominal"].stream(key)) if f.severity != "note"] == []


def test_emg_can_be_late(nominal):
    late = measure(nominal, "C", "exo", emg_late_s=0.05).stream("emg")
    timely = measure(nominal, "C", "exo").stream("emg")
    first = nominal.strides(envelopes(timely)["emg_ta_r"]).mean(axis=0)
    second = nominal.strides(envelopes(late)["emg_ta_r"]).mean(axis=0)
    lags = [np.dot(np.roll(first - first.mean(), k), second - second.mean()) for k in range(12)]
    assert int(np.argmax(lags)) == pytest.approx(0.05 / nominal.person.stride_s * 100, abs=1.5)


def test_the_same_walk_measured_again_is_the_same(trials, nominal):
    again = measure(nominal, "C_nominal", "nominal")
    for key, stream in again.streams.items():
        assert np.array_equal(stream.values, trials["nominal"].stream(key).values)


PERSON = draw_one("A", 5, "f")
TA, SOL, GAS = (MUSCLES.index(name) for name in ("emg_ta", "emg_sol", "emg_gas"))


def volts(excitation, late_s=0.0, seed=1):
    return electrode_volts(np.random.default_rng(seed), excitation, PERSON, 1000.0, late_s)


def alone(muscle, level=0.4, count=20_000):
    excitation = np.zeros((count, len(MUSCLES)))
    excitation[:, muscle] = level
    return excitation


def test_amplitude_follows_excitation():
    low, high = (volts(alone(TA, level))[:, TA].std() for level in (0.1, 0.3))
    assert high == pytest.approx(3 * low, rel=0.03)


def test_neighbours_are_heard_and_nobody_else():
    seen = volts(alone(SOL)).std(axis=0)
    assert seen[GAS] == pytest.approx(CROSS_TALK["emg_gas", "emg_sol"] * seen[SOL], rel=0.8)
    assert seen[TA] < 1.5 * FLOOR_V
    assert heard(2).shape == (14, 14)
    assert not heard(2)[:7, 7:].any()


@pytest.mark.parametrize("late_s", [0.0, 0.05])
def test_the_signal_comes_before_the_excitation_by_the_electromechanical_delay(late_s):
    excitation = alone(TA)
    excitation[:10_000] = 0.0
    power = volts(excitation, late_s)[:, TA] ** 2
    begins = np.flatnonzero(np.convolve(power, np.ones(10) / 10, "same") > 0.2 * power[12_000:].mean())[0]
    assert begins == pytest.approx(10_000 + 1000 * (late_s - DELAY_S), abs=12)


def test_power_lies_in_the_band():
    signal = volts(alone(TA))[:, TA]
    power, hz = np.abs(np.fft.rfft(signal)) ** 2, np.fft.rfftfreq(len(signal), 0.001)
    inside = (hz > BAND_HZ[0]) & (hz < BAND_HZ[1])
    assert power[inside].sum() > 0.9 * power.sum()
    assert 80.0 < hz[np.searchsorted(np.cumsum(power), power.sum() / 2)] < 200.0


def test_a_converter_has_a_range():
    assert np.abs(volts(alone(TA, 50.0))).max() <= RANGE_V
