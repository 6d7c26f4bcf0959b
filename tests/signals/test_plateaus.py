from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording, Source
from gaitdisc.signals.channel_quality import plateau_findings, plateau_marked, plateaus


def test_free_joints_have_no_plateau(made):
    for seed in range(20):
        walk, _ = made.walk(20, seed=seed)
        rng = np.random.default_rng(seed)
        sway = 1 + 0.03 * np.interp(walk.time, np.arange(0, 30, 1.1), rng.normal(size=28))
        assert plateaus(walk.with_values(walk.values * sway[:, None])) == []


@pytest.mark.parametrize(("side", "limit"), [("low", -8.0), ("high", 20.0)])
def test_a_planted_limit_is_found_with_its_value(made, side, limit):
    walk, _ = made.walk(20)
    values = walk.values.copy()
    free = values[:, 0]
    values[:, 0] = np.maximum(free, limit) if side == "low" else np.minimum(free, limit)
    rng = np.random.default_rng(1)
    values[:, 0] += 0.02 * rng.normal(size=len(values))
    (found,) = plateaus(walk.with_values(values))
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
    values = walk.values.copy()
    values[:, 0] = np.maximum(values[:, 0], -8.0)
    walk = walk.with_values(values)
    (found,) = plateaus(walk)
    marked = plateau_marked(walk)
    assert marked.suspect[found.marks, 0].all()
    assert marked.suspect[:, 0].sum() > found.marks.sum() + 19 * 2 * 4
    assert not marked.suspect[:, 1:].any()
    assert np.array_equal(marked.values, values)


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
