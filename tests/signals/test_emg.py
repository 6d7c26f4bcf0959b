from __future__ import annotations

import csv

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Source
from gaitdisc.signals.emg import amplifier_range, burst_ratio, emg_findings, live_channels

RATE = 1000.0
STEP = 2.5 / 2**16


def noise(size_v, seed=0, seconds=6):
    return size_v * np.random.default_rng(seed).normal(size=int(RATE * seconds))


def live(size_v=0.05, seed=0):
    x = noise(size_v, seed)
    return x * np.where(np.arange(len(x)) % 1000 < 300, 1.5, 0.05)


def emg(**columns):
    channels = tuple(Channel(name, "emg", "V") for name in columns)
    return Recording(
        np.arange(6000) / RATE, np.stack(list(columns.values()), axis=1), channels, source=Source("walk.c3d")
    )


def kinds(recording, range_v=None):
    return {finding.channel: finding.kind for finding in emg_findings(recording, range_v)}


def test_each_fault_is_told_and_a_clean_channel_is_not():
    rail = np.clip(noise(20.0, 3), -1.25, 1.25)
    recording = emg(sol=live(), ta=noise(5e-4, 1), rf=rail, gas=np.clip(live(0.6, 4), -1.25, 1.25), weak=live(0.006, 5))
    assert kinds(recording) == {"ta": "dead", "rf": "unplugged", "gas": "clipped"}
    assert live_channels(recording) == ("sol", "gas", "weak")


def test_weak_noise_without_bursts_is_dead():
    assert kinds(emg(sol=live(), ta=noise(3e-3, 1)), 1.25) == {"ta": "dead"}


def test_the_words_say_how_much_of_what_range():
    (finding,) = emg_findings(emg(ta=noise(5e-4, 1)), 2.5)
    assert finding.severity == "refused"
    assert finding.what.startswith("standard deviation 0.5")
    assert says(finding.what, "0.02 %", "2.5 V", "0.1 %")


@pytest.mark.parametrize("gain", [1e-3, 1.0, 5.0])
def test_the_verdict_does_not_depend_on_the_gain(gain):
    recording = emg(sol=gain * live(), ta=gain * noise(5e-4, 1), rf=gain * np.clip(noise(20.0, 3), -1.25, 1.25))
    assert kinds(recording, gain * 1.25) == {"ta": "dead", "rf": "unplugged"}
    assert kinds(recording) == {"ta": "dead", "rf": "unplugged"}


def test_the_range_comes_from_the_quantisation_step_of_quiet_channels():
    quiet = np.round(noise(5e-4, 1) / STEP) * STEP
    found = amplifier_range(emg(sol=np.round(live() / STEP) * STEP, ta=quiet))
    assert found.volts == pytest.approx(1.25, rel=0.01)
    assert found.how.startswith("the quantisation step of 3.8")


def test_without_a_hint_the_usual_range_is_taken():
    assert amplifier_range(emg(sol=live())).volts == 1.25
    assert amplifier_range(emg(sol=live(1.0))).volts == 5.0


def test_bursts_need_a_second_and_80_hz():
    assert burst_ratio(noise(1.0)[:900], RATE) == 0.0
    assert burst_ratio(noise(1.0), 60.0) == float("inf")


def test_an_empty_channel_is_not_live():
    assert live_channels(emg(sol=live(), ta=np.full(6000, np.nan))) == ("sol",)


def test_false_alarms_on_live_channels_are_none():
    for seed in range(20):
        assert kinds(emg(a=live(0.02, seed), b=live(0.1, seed + 100)), 1.25) == {}


def test_real_files_have_exactly_the_live_channels_of_their_manifest(gait_data, real):
    ezc3d = pytest.importorskip("ezc3d")
    folder, seen = gait_data / "young_straight_and_turn", 0
    with (folder / "manifest.csv").open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            path = folder / row["subject"] / row["condition"] / row["file"]
            if not path.exists():
                continue
            wanted = set(filter(None, row["live_emg"].split("|")))
            lost = {"L Hams"} if path.stem == "HC033A22" else set()  # the amplifier's noise but for 1 % at its rails
            assert set(live_channels(real.emg(ezc3d.c3d(str(path))))) == wanted - lost, path.name
            seen += 1
    assert seen >= 14


def test_a_clipped_channel_without_bursts_or_without_a_muscle_between_is_no_muscle():
    rng = np.random.default_rng(5)
    rails = np.clip(rng.normal(0, 0.6, 6000), -1.25, 1.25)  # 3.7 % at the rails, standard deviation below half of them
    loose = rng.normal(0, 3e-4, 6000)
    loose[1000:1060] = 1.25
    found = {finding.channel: finding for finding in emg_findings(emg(a=rails, b=loose, c=live(0.1, 1)), 1.25)}
    assert (found["a"].kind, found["a"].severity) == ("unplugged", "refused")
    assert "no bursts between" in found["a"].what
    assert (found["b"].kind, found["b"].severity) == ("dead", "refused")
    assert says(found["b"].what, "1 %", "1.25 V") and "0.3" in found["b"].what
    assert set(found) == {"a", "b"}


def test_a_channel_that_stops_before_the_others_do_is_clipped_at_its_own_limits():
    clipped = np.clip(30 * live(0.02, 7), -0.16, 0.16)
    found = emg_findings(emg(sol=clipped, ta=live(0.1, 8)), 1.25)
    assert [(one.channel, one.kind) for one in found] in ([("sol", "clipped")], [("sol", "unplugged")])
    assert says(found[0].what, "-0.16", "0.16 V")
