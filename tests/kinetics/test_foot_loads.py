import numpy as np
import pytest

from gaitdisc.kinetics.foot_loads import foot_loads, swings
from gaitdisc.kinetics.plate_steps import FootPath, PlateStep
from gaitdisc.kinetics.platform import Platform
from gaitdisc.kinetics.wrench import Wrench
from gaitdisc.recording import Surface, Trial
from gaitdisc.recording.trial import Event

FRAMES, SAMPLES = np.arange(300) / 100, np.arange(3000) / 1000
CORNERS = np.array([[0.0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]])
UP = np.array([0.0, 0.0, 1.0])


def plate(name, *spans):
    load = 500.0 * np.any([(a <= SAMPLES) & (b >= SAMPLES) for a, b in spans], axis=0)
    wrench = Wrench.at(np.array([0.2, 0.3, 0.0]), load[:, None] * UP)
    return Platform(name, SAMPLES, wrench, UP, CORNERS.mean(0), Surface(name, CORNERS))


def at(known, time):
    return bool(known[round(100 * time)])


def test_each_foot_has_the_force_of_its_own_steps_only():
    found = [plate("plate_1", (0.5, 1.0)), plate("plate_2", (0.9, 1.5))]
    steps = [PlateStep("plate_1", "r", 0.5, 1.0), PlateStep("plate_2", "l", 0.9, 1.5)]
    loads = foot_loads(found, steps, FRAMES, np.inf)
    assert loads["r"].wrench.force[95] == pytest.approx(500 * UP)
    assert loads["r"].wrench.force[120] == pytest.approx(0 * UP)
    assert loads["l"].wrench.force[[95, 120], 2] == pytest.approx([500, 500])
    assert [at(loads["r"].known, t) for t in (0.4, 0.7, 1.2)] == [False, True, False]


def test_the_swing_between_two_steps_is_known_and_a_missed_stance_is_not():
    found = [plate("belt", (0.2, 0.8), (1.2, 1.8))]
    near = [PlateStep("belt", "r", 0.2, 0.8), PlateStep("belt", "r", 1.2, 1.8)]
    assert at(foot_loads(found, near, FRAMES, np.inf)["r"].known, 1.0)
    far = [PlateStep("belt", "r", 0.2, 0.8), PlateStep("belt", "r", 2.0, 2.5)]
    assert not at(foot_loads(found, far, FRAMES, np.inf)["r"].known, 1.4)


def test_a_step_left_out_is_unknown_though_events_call_it_swing():
    found = [plate("plate_1", (0.5, 1.0))]
    two = [PlateStep("plate_1", "", 0.5, 1.0, "both feet stand on it")]
    loads = foot_loads(found, two, FRAMES, np.inf, {"r": [(0.3, 0.7)]})
    assert [at(loads["r"].known, t) for t in (0.4, 0.6)] == [True, False]
    assert not loads["r"].wrench.force.any()


def test_frames_between_foot_off_and_the_end_of_the_force_are_bridged():
    found, steps = [plate("plate_1", (0.5, 1.0))], [PlateStep("plate_1", "r", 0.5, 1.0)]
    known = foot_loads(found, steps, FRAMES, np.inf, {"r": [(1.04, 1.4)]})["r"].known
    assert known[50:141].all() and not known[45]


def test_a_force_that_names_its_foot_is_known_throughout():
    force = plate("ground_force_l", (0.5, 1.0))
    named = Platform("ground_force_l", force.time, force.wrench, UP, force.point, None, "l")
    loads = foot_loads([named], [PlateStep("ground_force_l", "l", 0.5, 1.0)], FRAMES, 20.0)
    assert loads["l"].known.all() and not loads["r"].known.any()


def test_a_step_that_names_the_wrong_foot_is_unknown():
    force = plate("ground_force_l", (0.5, 1.0))
    named = Platform("ground_force_l", force.time, force.wrench, UP, force.point, None, "l")
    steps = [PlateStep("ground_force_l", "l", 0.5, 1.0, "follows the other foot")]
    known = foot_loads([named], steps, FRAMES, 20.0)["l"].known
    assert [at(known, t) for t in (0.4, 0.7, 1.2)] == [True, False, True]


def test_swings_are_from_foot_off_to_the_next_contact():
    events = [
        ("initial contact", "r", 0.1),
        ("foot off", "l", 0.2),
        ("initial contact", "l", 0.6),
        ("foot off", "r", 0.7),
    ]
    trial = Trial("walk", {}, tuple(Event(*event) for event in events))
    assert swings(trial, {}) == {"r": [], "l": [(0.2, 0.6)]}


def test_a_foot_that_flies_off_its_plate_is_known_until_it_comes_down():
    found, steps = [plate("plate_1", (0.5, 1.2))], [PlateStep("plate_1", "r", 0.5, 1.2)]
    y = 3.0 * (np.clip(FRAMES, 0.1, 0.5) + np.clip(FRAMES, 1.2, 1.6))
    heel = np.stack([0 * y, y, 0 * y], axis=1)
    path = FootPath("r", FRAMES, heel, np.add(heel, [0.0, 0.18, 0.0]))
    known = foot_loads(found, steps, FRAMES, np.inf, swings(Trial("walk", {}), {"r": path}))["r"].known
    assert [at(known, t) for t in (0.05, 0.3, 0.8, 1.4, 1.7)] == [False, True, True, True, False]
