from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfreqz

from gaitdisc.channel import Channel
from gaitdisc.ingest.study import Filters
from gaitdisc.processing.filter_null import filter_null, filter_null_of
from gaitdisc.processing.process import processed
from gaitdisc.statistics.band_limit_null import analytic_null

KNEE = Channel("knee_angle_r", "angle", "deg", "r")
SOL = Channel("emg_sol_r", "emg", "V", "r")


def test_angles_agree_with_the_gain_of_the_filter():
    frequency, response = sosfreqz(butter(4, 6.0, fs=100.0, output="sos"), worN=4096, fs=100.0)
    expected = analytic_null(np.asarray(frequency), np.abs(response) ** 2)
    assert filter_null([KNEE], Filters(), 100.0)["knee_angle_r"] == pytest.approx(expected, abs=0.02)


def test_raw_emg_reaches_about_half_as_well():
    null = filter_null([KNEE, SOL], Filters(), 100.0, emg_hz=1000.0)
    assert null["emg_sol_r"] == pytest.approx(0.51, abs=0.03)
    assert filter_null([SOL], Filters(), 100.0)["emg_sol_r"] == pytest.approx(0.51, abs=0.03)


def test_the_rate_of_raw_emg_is_taken_from_the_walk(trial, study):
    study = study.model_copy(update={"models": study.models.model_copy(update={"emg": ("emg_sol_r",)})})
    emg = trial.stream("emg")
    envelopes = replace(trial, streams={**trial.streams, "emg": replace(emg, values=np.abs(emg.values))})
    for given, emg_hz in ((trial, emg.rate_hz), (envelopes, None)):
        walk = replace(processed(trial, study), trial=given)
        expected = filter_null(walk.state.channels, Filters(), walk.state.rate_hz, emg_hz)
        assert filter_null_of(walk, Filters()) == expected
        assert {"ankle_angle_r", "emg_sol_r"} <= set(expected)
