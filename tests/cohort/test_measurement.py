"""What the laboratory sees passes the package's own readers of signals, and tells the truth within its noise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from gaitdisc.cohort.emg import DELAY_S, RANGE_V
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.measurement import measured
from gaitdisc.cohort.person import JOINTS, MUSCLES
from gaitdisc.cohort.walk import QUICK_HZ
from gaitdisc.signals.channel_quality import channel_findings
from gaitdisc.signals.contacts import force_contacts
from gaitdisc.signals.emg import ENVELOPE_HZ, emg_findings, enveloped


@pytest.fixture(scope="module")
def trials(nominal, exo):
    return {"nominal": measured(nominal, "C_nominal", "nominal"), "exo": measured(exo, "C_exo", "exo")}


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
    assert emg_findings(emg, RANGE_V) == []
    assert np.abs(emg.values).max() <= RANGE_V
    assert np.unique(np.round(emg.values / (RANGE_V / 2**15) % 1, 6)).tolist() in ([0.0], [0.0, 1.0])


def test_the_envelope_follows_the_excitation(trials, nominal):
    """Through the envelope's own low-pass, and as much earlier as the electromechanical delay."""
    envelope = enveloped(trials["nominal"].stream("emg"))
    low = butter(4, ENVELOPE_HZ, fs=QUICK_HZ, output="sos")
    driven = np.roll(sosfiltfilt(low, nominal.excitation[:, 0], axis=0), -round(DELAY_S * QUICK_HZ), axis=0)
    for muscle, name in enumerate(MUSCLES):
        seen, true = nominal.mean_stride(envelope[f"{name}_r"]), nominal.mean_stride(driven[:, muscle])
        assert np.corrcoef(seen, true)[0, 1] > 0.99, name


def test_quality_checks_find_nothing_in_a_clean_walk(trials):
    for key in ("kinematics", "forces"):
        assert [f for f in channel_findings(trials["nominal"].stream(key)) if f.severity != "note"] == []


def test_emg_can_be_late(nominal):
    late = measured(nominal, "C", "exo", emg_late_s=0.05).stream("emg")
    timely = measured(nominal, "C", "exo").stream("emg")
    first = nominal.mean_stride(enveloped(timely)["emg_ta_r"])
    second = nominal.mean_stride(enveloped(late)["emg_ta_r"])
    lags = [np.dot(np.roll(first - first.mean(), k), second - second.mean()) for k in range(12)]
    assert int(np.argmax(lags)) == pytest.approx(0.05 / nominal.person.stride_s * 100, abs=1.5)


def test_the_same_walk_measured_again_is_the_same(trials, nominal):
    again = measured(nominal, "C_nominal", "nominal")
    for key, stream in again.streams.items():
        assert np.array_equal(stream.values, trials["nominal"].stream(key).values)
