from __future__ import annotations

import numpy as np
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.ingest.study import Filters
from gaitdisc.processing.trial_cycles import cycle_channels
from gaitdisc.recording import Recording, Trial


def _emg(seconds=4.0, rate_hz=1000.0):
    """One dead muscle beside a live one that bursts once a second."""
    time = np.arange(int(seconds * rate_hz)) / rate_hz
    burst = 0.02 + np.exp(-(((time % 1.0 - 0.4) / 0.08) ** 2))
    live = 0.3 * burst * np.random.default_rng(3).standard_normal(len(time))
    channels = tuple(Channel(f"emg_{muscle}_r", "emg", "V", "r") for muscle in ("sol", "ta"))
    return Recording(time, np.column_stack([0 * time, live]), channels)


def test_channels_of_the_vocabulary_are_filtered_and_a_dead_muscle_is_left_out(trial):
    short = {key: trial.stream(key).between(2.0, 6.0) for key in ("kinematics", "forces")} | {"emg": _emg()}
    legs, states, findings = cycle_channels(Trial("w", short), Filters())
    names = [name for state in states for name in state.names]
    assert legs is not None and set(legs.names) == set(trial.stream("kinematics").names)
    assert "emg_sol_r" not in names and "emg_ta_r" in names
    assert "ground_force_r_vy" in names
    (said,) = findings
    assert (said.kind, said.severity) == ("filter", "note")
    assert says(said.what, "forces", "20 Hz; EMG", "40 Hz", "10 Hz")


def test_what_a_file_computed_is_as_in_the_file_and_angles_from_markers_are_filtered():
    """A push-off of 0.1 s: 6 Hz would leave less than 0.9 of it."""
    time = np.arange(200) / 100
    peak = np.exp(-(((time - 1.0) / 0.03) ** 2))
    named = (("kinematics", "ankle_angle_r", "angle", "deg"), ("moments", "ankle_power_r", "power", "W/kg"))
    streams = {key: Recording(time, peak[:, None], (Channel(*rest, "r"),)) for key, *rest in named}
    _, states, findings = cycle_channels(Trial("w", streams), Filters())
    assert all(np.array_equal(state.values[:, 0], peak) for state in states)
    assert says(findings[-1].what, "angles as in", "moments")
    _, (angles, powers), findings = cycle_channels(Trial("w", streams), Filters(), ("kinematics", "moments"))
    assert angles.values.max() < 0.9 and np.array_equal(powers.values[:, 0], peak)
    assert says(findings[-1].what, "6 Hz; moments", "6 Hz", "(20 Hz)")


def test_an_angle_that_no_vocabulary_has_and_one_without_a_value_are_not_there():
    time = np.arange(200) / 100
    wave = np.sin(6 * time)
    channels = tuple(Channel(n, "angle", "deg", "r") for n in ("knee_angle_r", "RHFTFL.x", "ankle_angle_r"))
    values = np.column_stack([wave, wave, np.full(200, np.nan)])
    _, states, _ = cycle_channels(Trial("w", {"kinematics": Recording(time, values, channels)}), Filters())
    assert [state.names for state in states] == [("knee_angle_r",)]


def test_a_stream_too_short_for_its_filter_is_said_and_costs_no_other(trial):
    streams = {"kinematics": trial.stream("kinematics").between(2.0, 4.0), "emg": _emg(8.0, 50.0)}
    _, states, findings = cycle_channels(Trial("w", streams), Filters())
    assert [state.names for state in states] == [trial.stream("kinematics").names]
    assert findings[0].kind == "left out" and findings[0].what.startswith("emg: ")
