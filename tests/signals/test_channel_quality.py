"""Signals that cannot be right: plateaus, spikes, drifting forces, flat channels."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording, Source, Strides
from gaitdisc.recording.strides import interpolate
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.channel_quality import (
    channel_findings,
    drift_findings,
    plateau_findings,
    plateau_marked,
    plateaus,
    swing_baseline,
)
from gaitdisc.signals.derivatives import derivative
from gaitdisc.signals.gaps import spike_findings, spikes, without_spikes

FORCE = Channel("ground_force_r_vy", "vertical_force", "N", "r")


def one(x, channel, rate=100.0):
    return Recording(np.arange(len(x)) / rate, np.asarray(x, float)[:, None], (channel,), source=Source("walk.mot"))


def test_a_clean_walk_has_no_findings(made):
    for seed in range(10):
        assert channel_findings(made.walk(20, seed=seed)[0]) == []


def planted(made, fault):
    walk, _ = made.walk(20)
    x = walk.values[:, 1].copy()
    if fault == "gap":
        x[400:440] = np.nan
    elif fault == "flat":
        x[:] = 3.0
    elif fault == "clipped":
        x = np.minimum(x, 50.0)
    elif fault == "jump":
        x[400] += 15.0
    return one(x, walk.channels[1])


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("gap", "1 gap, 0.400 s"),
        ("flat", "3 deg throughout"),
        ("clipped", "stops at 50 deg, in 2"),
        ("jump", "jumps from one sample to the next, in 1 place, 0.05 s in all"),
    ],
)
def test_each_planted_fault_is_found_and_no_other(made, fault, words):
    findings = channel_findings(planted(made, fault))
    assert words in next(finding.what for finding in findings if finding.kind == fault)
    assert {finding.kind for finding in findings} == {fault}


def test_spans_say_where(made):
    assert channel_findings(planted(made, "gap"))[0].spans == ((4.0, 4.4),)


@pytest.mark.parametrize(("size_n", "rest_n", "kinds"), [(700, 0, []), (700, -9.7, []), (900, -9.7, ["clipped"])])
def test_a_force_that_rests_near_zero_is_well_and_one_that_is_cut_off_is_clipped(size_n, rest_n, kinds):
    force = np.clip(size_n * np.sin(2 * np.pi * np.arange(2000) / 1000), rest_n, 700.0)
    assert [finding.kind for finding in channel_findings(one(force, FORCE, 1000.0))] == kinds


def test_a_real_ankle_that_jumps(gait_data, real):
    walk = real.treadmill_walks(gait_data)["S01DE507"].selected(["ankle_angle_r", "hip_flexion_r", "knee_angle_r"])
    jumps = [finding for finding in channel_findings(walk) if finding.kind == "jump"]
    assert [finding.channel for finding in jumps] == ["ankle_angle_r"]
    assert jumps[0].spans[0][0] == pytest.approx(13.98, abs=0.03)


def test_a_heading_that_passes_180_deg_does_not_leap():
    t = np.arange(1000) / 100
    true = 170 + 3 * t + np.sin(2 * np.pi * t)
    walk = Recording(t, ((true + 180) % 360 - 180)[:, None], (Channel("pelvis_rotation", "angle", "deg"),))
    assert channel_findings(walk) == []


RATE = 1000.0


def belt(steps=30, offset_n=0.0, drift_n=0.0, sign=1.0, seed=0):
    t = np.arange(round(steps * 1.1 * RATE)) / RATE
    phase = t / 1.1 % 1.0
    load = np.where(phase < 0.6, 700 * np.sqrt(np.abs(np.sin(np.pi * phase / 0.6))), 0.0)
    noise = 2 * np.random.default_rng(seed).normal(size=len(t))
    force = sign * (load + noise) + offset_n + drift_n * t / t[-1]
    channel = Channel("ground_force_r_vy", "vertical_force", "N", "r")
    return Recording(t, force[:, None], (channel,), source=Source("walk.c3d"))


def test_the_baseline_is_that_of_swing():
    found = swing_baseline(belt(offset_n=7.0)["ground_force_r_vy"], RATE)
    assert len(found) == 29
    assert found[:, 1] == pytest.approx(7.0, abs=0.5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_planted_drift_is_found(sign):
    (finding,) = drift_findings(belt(drift_n=12.0, sign=sign))
    assert "and drifts by +11." in finding.what
    assert "subtract the baseline" in finding.spoils


def test_an_offset_is_found():
    forces = belt(offset_n=-15.0)
    (finding,) = drift_findings(Recording(forces.time + 10.0, forces.values, forces.channels))
    assert says(finding.what, "-15.0 N", "29 swings")
    assert np.ravel(finding.spans) == pytest.approx([10.0 + 0.8 * 1.1, 10.0 + 28.8 * 1.1], abs=0.05)


def test_a_good_plate_is_not_accused():
    assert all(drift_findings(belt(drift_n=2.0, offset_n=3.0, seed=seed)) == [] for seed in range(10))


def test_few_swings_are_said():
    (finding,) = drift_findings(belt(steps=4))
    assert finding.severity == "note" and says(finding.what, "3 unloaded phases", "5")


def test_real_belts_rest_at_zero(gait_data, real):
    ezc3d = pytest.importorskip("ezc3d")
    plates = real.plates(ezc3d.c3d(str(gait_data / "treadmill_c3d_emg" / "walking_1.c3d")))
    assert drift_findings(plates) == []


def test_free_joints_have_no_plateau(made):
    for seed in range(20):
        walk, _ = made.walk(20, seed=seed)
        rng = np.random.default_rng(seed)
        sway = 1 + 0.03 * np.interp(walk.time, np.arange(0, 30, 1.1), rng.normal(size=28))
        assert plateaus(walk.with_values(walk.values * sway[:, None])) == []


@pytest.mark.parametrize(("side", "limit"), [("low", -8.0), ("high", 20.0)])
def test_a_planted_limit_is_found_with_its_value(made, side, limit):
    walk, _ = made.walk(20)
    free = walk["hip_flexion_r"]
    held = np.maximum(free, limit) if side == "low" else np.minimum(free, limit)
    noise = 0.02 * np.random.default_rng(1).normal(size=len(free))
    (found,) = plateaus(with_column(walk, "hip_flexion_r", held + noise))
    on = free < limit if side == "low" else free > limit
    assert found.channel == "hip_flexion_r"
    assert found.limit == pytest.approx(limit, abs=0.05)
    assert found.marks[on].mean() > 0.9
    assert found.marks[~on].mean() < 0.2


def test_broad_peaks_that_turn_at_one_angle_are_no_plateau(made):
    """Rests between strides of one height, as an elbow or a foot in stance has: flat, but without a corner."""
    t = np.arange(2000) / 100
    rng = np.random.default_rng(0)
    rest = np.abs(((t + 0.5) % 1.0) - 0.5)  # s from the middle of the stride
    x = 30.0 * np.exp(-0.5 * (rest / 0.16) ** 2) + 0.02 * rng.normal(size=len(t))
    slow = 1.5 * np.sin(2 * np.pi * t) ** 2  # a shoulder: near the extreme, not at it
    walk = Recording(t, -(x - slow)[:, None], (made.channel("hip_flexion_r"),))
    assert plateaus(walk) == []


def test_real_c3d_have_none(gait_data):
    files = sorted((gait_data / "young_straight_and_turn").glob("*/turn/*.c3d"))
    assert files
    for file in files:
        kinematics = read_trial(file).stream("kinematics")
        assert plateaus(kinematics) == [], file.name
        unknown = replace(kinematics, source=Source(file.name))
        assert plateaus(unknown) == [], file.name  # by their shape alone, too


def test_marks_reach_50_ms_beyond(made):
    walk, _ = made.walk(20)
    walk = with_column(walk, "hip_flexion_r", np.maximum(walk["hip_flexion_r"], -8.0))
    (found,) = plateaus(walk)
    marked = plateau_marked(walk)
    assert marked.suspect[found.marks, 0].all()
    assert marked.suspect[:, 0].sum() > found.marks.sum() + 19 * 2 * 4
    assert not marked.suspect[:, 1:].any()
    assert np.array_equal(marked.values, walk.values)


def test_real_hips_stand_at_minus_30(gait_data, real):
    for name, walk in real.treadmill_walks(gait_data).items():
        if name == "S01DE503":
            continue
        found = {plateau.channel: plateau.limit for plateau in plateaus(walk.selected(real.legs))}
        assert {"hip_flexion_r", "hip_flexion_l"} <= set(found) <= {"hip_flexion_r", "hip_flexion_l", "knee_angle_l"}
        assert found["hip_flexion_r"] == pytest.approx(-29.8, abs=0.1)
        assert found["hip_flexion_l"] == pytest.approx(-29.8, abs=0.1)
    finding = plateau_findings(walk.selected(["hip_flexion_r"]))[0]
    assert finding.what.startswith("stops at -29.8 deg in ")
    assert len(finding.spans) >= 17


def test_real_running_has_none(gait_data, real):
    run = real.mot(gait_data / "exotendon_run" / "c3d_Trimmed_running_natural2_manual_scaling_ik.mot")
    assert plateaus(run.selected(real.legs)) == []


def test_walks_without_spikes_have_none(made):
    for seed in range(5):
        walk, _ = made.walk(20, seed=seed)
        assert not spikes(walk).any()
        assert without_spikes(walk) is walk


@pytest.mark.parametrize("height", [35.0, -35.0, 1e6])
@pytest.mark.parametrize("samples", [1, 3])
def test_a_spike_is_found_within_the_range_of_a_joint_and_does_not_spread(made, height, samples):
    walk, _ = made.walk(20)
    rows = slice(700, 700 + samples)
    spiked = with_column(walk, "knee_angle_r", walk["knee_angle_r"][rows] + height, rows)
    assert np.flatnonzero(spikes(spiked).any(axis=1)).tolist() == list(range(700, 700 + samples))
    smooth = low_pass(without_spikes(spiked))
    assert np.abs(smooth.values - low_pass(walk).values).max() < 1.0
    assert np.asarray(smooth.suspect)[700 : 700 + samples, 1].all()
    [finding] = spike_findings(spiked)
    assert finding.channel == "knee_angle_r"
    assert "(frame 70" in finding.what
    assert finding.spans[0][0] == pytest.approx(7.0)


def test_a_step_and_a_force_are_no_spikes():
    t = np.arange(600) / 100
    step = np.where(t > 3, 40.0, 0.0) + 20 * np.sin(6 * t)
    blow = np.where((t > 3) & (t < 3.02), 900.0, 0.0) + np.sin(t)
    channels = (Channel("knee_angle_r", "angle", "deg", "r"), Channel("plate1", "vertical_force", "N"))
    assert not spikes(Recording(t, np.stack([step, blow], axis=1), channels)).any()


def test_what_is_not_finite_spreads_nowhere():
    """An infinite sample is a gap for filters, derivatives, resampling and stride curves alike."""
    t = np.arange(400) / 100
    x = 30 * np.sin(2 * np.pi * t)
    knee = Channel("knee_angle_r", "angle", "deg", "r")
    broken = x.copy()
    broken[200] = np.inf
    walk = Recording(t, broken[:, None], (knee,))
    assert np.abs(low_pass(walk).values - low_pass(walk.with_values(x[:, None])).values).max() < 0.05
    assert not np.isinf(derivative(broken[:, None], 100.0)).any()
    assert np.isnan(derivative(broken[:, None], 100.0)[198:203]).all()
    read = interpolate(t, broken[:, None], np.array([1.995, 2.0, 2.005]))
    assert np.isnan(read).all()
    curves = Strides(np.array([1.0, 2.5]), np.array([2.4, 3.5]), "r", "events").normalised(walk)
    assert not np.isinf(curves).any()
    assert np.isfinite(curves[1]).all()


def test_real_gait_angles_and_their_stumbles_have_hardly_any(gait_data, real):
    """Each treadmill walk holds a stumble, in which inverse kinematics loses an ankle for a frame at the most."""
    for file in sorted((gait_data / "exotendon_run").rglob("*.mot")):
        assert not spikes(real.mot(file).selected(real.legs)).any(), file.name
    marked = {
        name: int(spikes(walk.selected(real.legs)).sum())
        for name, walk in real.treadmill_walks(gait_data).items()
        if name != "S01DE503"
    }
    assert len(marked) == 12
    assert sum(marked.values()) <= 3, marked


def test_real_one_frame_flips_are_found(gait_data):
    """The tibia of HC030A22: 2, -48 and 179 deg in three frames of a turn."""
    file = gait_data / "young_straight_and_turn" / "HC030A" / "turn" / "HC030A22.c3d"
    kinematics = read_trial(file).stream("kinematics")
    found = {name for name, here in zip(kinematics.names, spikes(kinematics).any(axis=0), strict=True) if here}
    assert {"LTIBA.x", "LTIBA.y", "LTIBA.z", "LHFTFL.x"} <= found
    assert not [name for name in found if name.startswith(("hip_", "knee_", "ankle_"))]
