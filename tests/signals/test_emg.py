"""EMG: envelopes, the order of steps, units, and a trial whose size is another than it states."""

import csv

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.recording import Recording, Source, Strides
from gaitdisc.recording.trial import Limits
from gaitdisc.signals.emg import (
    OVER_STANDING,
    OVER_WALKING,
    amplifier_range,
    burst_ratio,
    emg_findings,
    emg_sizes,
    envelopes,
    live_channels,
    order_of_muscles,
    other_unit_findings,
    stance_over_swing,
)

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


def kinds(recording):
    return {finding.channel: finding.kind for finding in emg_findings(recording)}


def test_each_fault_is_told_and_a_clean_channel_is_not():
    rail = np.clip(noise(20.0, 3), -1.25, 1.25)
    recording = emg(sol=live(), ta=noise(5e-4, 1), rf=rail, gas=np.clip(live(0.6, 4), -1.25, 1.25), weak=live(0.006, 5))
    assert kinds(recording) == {"ta": "dead", "rf": "unplugged", "gas": "clipped"}
    assert live_channels(recording) == ("sol", "gas", "weak")
    assert live_channels(emg(sol=live(), ta=np.full(6000, np.nan))) == ("sol",)
    assert kinds(emg(sol=live(), ta=noise(3e-3, 1))) == {"ta": "dead"}


def test_bursts_of_a_converter_of_12_bits_are_a_muscle():
    step = 0.01 / 2**11  # 5 uV: 16 bits would reach 0.16 V
    muscle, amplifier = (np.round(x / step) * step for x in (live(1.2e-4), noise(2e-5, 1)))
    recording = emg(ta=muscle, rf=amplifier)
    assert amplifier_range(recording).volts == pytest.approx(0.16, rel=0.01)
    (finding,) = emg_findings(recording)
    assert finding.channel == "rf" and says(finding.what, "0.1 % or bursts")


def test_the_words_say_how_much_of_what_range():
    (finding,) = emg_findings(emg(ta=noise(5e-4, 1), sol=live(0.4)))
    assert finding.severity == "refused"
    assert finding.what.startswith("the standard deviation is 0.5")
    assert says(finding.what, "0.02 %", "2.5 V", "0.1 %")


@pytest.mark.parametrize("gain", [1e-3, 1.0, 5.0])
def test_the_verdict_does_not_depend_on_the_gain(gain):
    recording = emg(sol=gain * live(), ta=gain * noise(5e-4, 1), rf=gain * np.clip(noise(20.0, 3), -1.25, 1.25))
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


def test_false_alarms_on_live_channels_are_none():
    for seed in range(20):
        assert kinds(emg(a=live(0.02, seed), b=live(0.1, seed + 100))) == {}


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
    found = {finding.channel: finding for finding in emg_findings(emg(a=rails, b=loose, c=live(0.1, 1)))}
    assert (found["a"].kind, found["a"].severity) == ("unplugged", "refused")
    assert "without bursts between" in found["a"].what
    assert (found["b"].kind, found["b"].severity) == ("dead", "refused")
    assert says(found["b"].what, "1 %", "1.25 V") and "0.3" in found["b"].what
    assert set(found) == {"a", "b"}


def test_a_channel_that_stops_before_the_others_do_is_clipped_at_its_own_limits():
    clipped = np.clip(30 * live(0.02, 7), -0.16, 0.16)
    found = emg_findings(emg(sol=clipped, ta=live(0.1, 8)))
    assert [(one.channel, one.kind) for one in found] in ([("sol", "clipped")], [("sol", "unplugged")])
    assert says(found[0].what, "-0.16", "0.16 V")


SOLEUS = Channel("emg_sol_r", "emg", "V", "r")


def single(x, rate=1000.0, channel=SOLEUS):
    return Recording(np.arange(len(x)) / rate, np.asarray(x, float)[:, None], (channel,), source=Source("walk.c3d"))


def test_a_sine_gives_its_mean_rectified_value():
    t = np.arange(5000) / 1000
    out = envelopes(single(0.003 * np.sin(2 * np.pi * 110 * t)))["emg_sol_r"]
    assert out[1000:4000] == pytest.approx(0.003 * 2 / np.pi, rel=0.01)


def test_a_modulated_carrier_gives_its_modulation():
    t = np.arange(10000) / 1000
    loud = 1 + 0.5 * np.sin(2 * np.pi * 1.0 * t)
    out = envelopes(single(loud * np.sin(2 * np.pi * 150 * t)))["emg_sol_r"]
    assert np.abs(out - 2 / np.pi * loud)[1000:-1000].max() < 0.01


def test_movement_artefact_below_40_hz_is_gone():
    t = np.arange(5000) / 1000
    out = envelopes(single(np.sin(2 * np.pi * 5 * t)))["emg_sol_r"]
    assert np.abs(out[1000:4000]).max() < 1e-4


def test_a_slow_rate_an_envelope_and_an_angle_are_refused():
    with pytest.raises(SamplingError, match=r"40 Hz.*exceed 80.*walk\.c3d.*80.*EMG"):
        envelopes(single(np.random.default_rng(0).normal(size=500), 80.0))
    with pytest.raises(SamplingError, match=r"walk\.c3d, emg_sol_r.*500 samples.*below"):
        envelopes(single(0.1 + np.abs(np.random.default_rng(0).normal(size=500))))
    with pytest.raises(ChannelError, match=r"walk\.c3d.*'knee_angle_r'.*angle"):
        envelopes(single(np.zeros(500), channel=Channel("knee_angle_r", "angle", "deg", "r")))


def walk(*names, swing=()):
    """Envelopes of 1 in stance and 0.2 in swing of the named leg; the other way round for `swing`."""
    time = np.arange(1001) / 100
    columns = []
    for name in names:
        at = (time - (0.5 if name.endswith("l") else 0.0)) % 1.0
        columns.append(np.where((at < 0.6) != (name in swing), 1.0, 0.2))
    strides = {"r": Strides(np.arange(9.0), 1 + np.arange(9.0), "r", "force")}
    strides["l"] = Strides(0.5 + np.arange(9.0), 1.5 + np.arange(9.0), "l", "force")
    return Recording(time, np.stack(columns, axis=1), tuple(vocabulary().named(name) for name in names)), strides


def test_each_muscle_at_its_own_time_says_nothing():
    envelope, strides = walk("emg_gas_r", "emg_ta_r", swing=("emg_ta_r",))
    assert abs(stance_over_swing(envelope, strides["r"], "emg_gas_r") - np.log(5)) < 0.05
    assert order_of_muscles(envelope, strides) == []


def test_calf_and_shin_exchanged_are_named_with_how_much_stronger():
    (finding,) = order_of_muscles(*walk("emg_gas_r", "emg_ta_r", swing=("emg_gas_r",)))
    assert says(finding.what, "emg_gas_r", "emg_ta_r", "emg_gas_r", "5.0 times")
    assert finding.channel == "emg_gas_r, emg_ta_r"


def test_calves_of_both_legs_exchanged_are_named():
    (finding,) = order_of_muscles(*walk("emg_sol_r", "emg_sol_l", swing=("emg_sol_r", "emg_sol_l")))
    assert "emg_sol_l and emg_sol_r seem to be exchanged" in finding.what


def test_one_muscle_out_of_time_is_a_patients_own():
    assert order_of_muscles(*walk("emg_gas_r", "emg_ta_r", swing=("emg_gas_r", "emg_ta_r"))) == []
    assert order_of_muscles(*walk("emg_ta_r")) == []


def test_exchanged_calves_that_begin_before_contact_are_named_by_the_steps_of_both_feet():
    """One foot's steps alone say little of them."""
    envelope, strides = walk("emg_sol_r", "emg_sol_l")
    values = np.array(envelope.values)
    for column, begins in enumerate((0.5, 0.0)):  # each is the other leg's
        at = (envelope.time - begins) % 1.0
        values[:, column] = np.select([(at > 0.9) | (at < 0.06), at < 0.6], [1.8, 1.0], 0.1)
    late = envelope.with_values(values)
    assert -0.5 < stance_over_swing(late, strides["r"], "emg_sol_r") < 0
    (finding,) = order_of_muscles(late, strides)
    assert "emg_sol_l and emg_sol_r seem to be exchanged" in finding.what


MUSCLES = ("emg_sol_r", "emg_ta_r", "emg_gas_r", "emg_rf_r")
SIZES = np.array([3e-4, 5e-5, 1e-4, 2e-5])


def quartet(factor: float, seed: int = 0) -> Recording:
    values = factor * SIZES * np.random.default_rng(seed).normal(size=(2000, 4))
    return Recording(np.arange(2000) / 1000, values, tuple(Channel(name, "emg", "V", "r") for name in MUSCLES))


def said(walk: float, other: float, usual: Limits) -> list[str]:
    found = other_unit_findings(emg_sizes(quartet(walk)), emg_sizes(quartet(other, 1)), usual, "walk", "other")
    return [finding.what for finding in found]


@pytest.mark.parametrize("stronger", [0.5, 1.0, 5.0, 30.0])
def test_walking_beside_standing_is_judged_by_a_thousand(stronger):
    assert not said(stronger, 1.0, OVER_STANDING)
    (weak,) = said(1e-3 * stronger, 1.0, OVER_STANDING)
    assert says(weak, "weaker", "4 channels", "mV")
    (strong,) = said(1e3 * stronger, 1.0, OVER_STANDING)
    assert "times stronger than in other" in strong and says(strong, "mV instead of V")


def test_one_walk_beside_another():
    assert not said(4.0, 1.0, OVER_WALKING) and not said(0.25, 1.0, OVER_WALKING)
    assert said(4e-3, 1.0, OVER_WALKING) and said(250.0, 1.0, OVER_WALKING)


def test_loose_electrodes_resting_muscles_and_two_channels_decide_nothing():
    sizes = emg_sizes(quartet(1.0))
    assert not other_unit_findings({**sizes, "emg_ta_r": 1.0}, sizes, OVER_WALKING, "walk", "other")
    rested = {name: size / 5000 if name != "emg_gas_r" else size / 3 for name, size in sizes.items()}
    assert not other_unit_findings(sizes, rested, OVER_STANDING, "walk", "other")
    two = {name: 1e-3 * sizes[name] for name in MUSCLES[:2]}
    assert not other_unit_findings(two, sizes, OVER_WALKING, "walk", "other")


def test_dead_and_empty_channels_have_no_size():
    bare = np.column_stack([np.zeros(50), np.full(50, np.nan), np.arange(50.0)])
    channels = tuple(Channel(name, "emg", "V", "r") for name in MUSCLES[:3])
    assert list(emg_sizes(Recording(np.arange(50) / 1000, bare, channels))) == ["emg_gas_r"]


def test_electrodes_that_were_not_yet_on_in_the_static_trial_are_no_unit():
    """Converter of 16 bits and 1.25 V: noise of 0.3 mV standing, bursts of 250 mV walking: 893 times, and no unit."""
    step, rng = 1.25 / 2**15, np.random.default_rng(3)
    channels = tuple(Channel(name, "emg", "V", "r") for name in MUSCLES)
    noise, bursts = ((np.round(rng.normal(0, size, (3000, 4)) / step) * step) for size in (2.8e-4, 0.25))
    static, walk = (Recording(np.arange(3000) / 1000, x, channels) for x in (noise, np.clip(bursts, -1.25, 1.25)))
    assert not other_unit_findings(emg_sizes(walk), emg_sizes(static), OVER_STANDING, "walk", "the static trial")
