"""Wrenches on plates and feet: where a force acts, whose it is, what a plate that stands askew says."""

from dataclasses import replace

import ezc3d
import numpy as np
import pytest
from changed_trials import with_column, with_stream

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, ReadError, ShapeError, UnitError
from gaitdisc.ingest.c3d import read_c3d
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinetics.joint_moments import foot_loads, swings
from gaitdisc.kinetics.plate_steps import FootPath, PlateStep
from gaitdisc.kinetics.platform import Platform, Wrench, platforms
from gaitdisc.recording import Recording, Surface, Trial
from gaitdisc.recording.arrays import Span
from gaitdisc.recording.trial import Event
from gaitdisc.signals.contacts import CONTACT, OFF

TIME = np.arange(2000) / 1000
CORNERS = np.array([[0.0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]])
FREE = 3.0


def stance(peak=700.0):
    """Force of one stance from 0.5 to 1.2 s."""
    return peak * np.clip(np.sin(np.pi * (TIME - 0.5) / 0.7), 0, None) * (TIME > 0.5) * (TIME < 1.2)


def plate_trial(load, point=(0.25, 0.4, 0.0), name="plate_1", surfaces=None):
    force = np.stack([0.1 * load, -0.05 * load, load], 1)
    moment = np.cross(np.array(point) - CORNERS.mean(0), force) + np.outer(load > 0, [0, 0, FREE])
    channels = [Channel(f"{name}_f{a}", "vertical_force" if a == "z" else "force", "N") for a in "xyz"]
    channels += [Channel(f"{name}_m{a}", "moment", "N m") for a in "xyz"]
    forces = Recording(TIME, np.hstack([force, moment]), tuple(channels))
    return Trial("walk", {"forces": forces}, surfaces=(Surface(name, CORNERS),) if surfaces is None else surfaces)


def test_a_plate_gives_force_point_and_free_moment_in_the_laboratory():
    (plate,) = platforms(plate_trial(stance()))
    assert plate.up.tolist() == [0, 0, 1]
    pressed = plate.load_n > 20
    assert plate.pressure_centre()[pressed] == pytest.approx(np.tile([0.25, 0.4, 0.0], (pressed.sum(), 1)))
    assert np.isnan(plate.pressure_centre()[~pressed]).all()
    free = plate.wrench.about(plate.pressure_centre()) @ plate.up
    assert free[pressed] == pytest.approx(FREE)
    ((start, end),) = plate.loadings()
    assert TIME[[start, end]] == pytest.approx([0.5 + 0.7 * np.arcsin(50 / 700) / np.pi, 1.2 - 0.7 * np.arcsin(20 / 700) / np.pi], abs=2e-3)  # fmt: skip  # noqa: E501


def test_what_an_empty_plate_shows_is_no_force_on_a_foot():
    load = stance() + 8.0  # an offset below the limit
    (plate,) = platforms(plate_trial(load))
    spans = [Span(TIME[a], TIME[b - 1]) for a, b in plate.loadings()]
    raw, smooth = plate.smoothed(np.inf, spans), plate.smoothed(20.0, spans)
    assert raw.force[TIME < 0.4] == pytest.approx(0)
    assert raw.force[800] == pytest.approx(plate.wrench.force[800])
    assert smooth.force[800] == pytest.approx(plate.wrench.force[800], rel=0.01)


def test_samples_a_second_and_the_last_of_a_span_are_counted():
    (plate,) = platforms(plate_trial(stance()))
    assert plate.rate_hz == pytest.approx(1000.0, rel=1e-9)
    cut = plate.smoothed(np.inf, [Span(TIME[600], TIME[800])])
    assert np.flatnonzero(cut.force[:, 2])[[0, -1]].tolist() == [600, 800]


def test_a_plate_upside_down_in_the_file_is_the_same_plate():
    trial = plate_trial(stance())
    flipped = replace(trial, surfaces=(Surface("plate_1", CORNERS[::-1]),))
    assert platforms(flipped)[0].up.tolist() == [0, 0, 1]


def test_turned_sign_is_refused():
    with pytest.raises(UnitError, match=r"plate_1; walk.*-700 N.*0\.850 s"):
        platforms(plate_trial(-stance()))


def test_forces_without_a_place_are_refused():
    with pytest.raises(ChannelError, match=r"plate_1.*no"):
        platforms(plate_trial(stance(), surfaces=()))
    vertical = Recording(TIME, stance()[:, None], (Channel("ground_force_r_vy", "vertical_force", "N", "r"),))
    with pytest.raises(ChannelError, match=r"lacks ground_force_r_vx, ground_force_r_vz"):
        platforms(Trial("walk", {"forces": vertical}))
    other = Recording(TIME, stance()[:, None], (Channel("load", "force", "N"),))
    with pytest.raises(ChannelError, match=r"force.*walk.*load"):
        platforms(Trial("walk", {"forces": other}))


def test_a_force_without_its_point_is_refused(gait_data):
    trial = read_trial(gait_data.parent / "opensim_gait10dof" / "ExperimentalData" / "subject01_walk_grf.mot")
    broken = with_column(trial.stream("forces"), "ground_force_l_px", np.nan, slice(120, 130))
    with pytest.raises(ReadError, match=r"ground_force_l.*_grf.mot.*10 .*\d+ N.*0\.200 s"):
        platforms(with_stream(trial, "forces", broken))


# Each weighs its person: mass from PROCESSING of the file; young_straight_and_turn and young_static, all of them
def test_the_ground_bears_the_weight_of_those_who_stand(gait_data):
    masses = {"HC030A": 45.8, "HC031A": 27.7, "HC033A": 51.5, "HC036A": 33.0}
    for person, mass in masses.items():
        found = platforms(read_c3d(gait_data / "young_static" / person / f"{person}01.c3d"))
        weight = sum(float(np.median(platform.load_n)) for platform in found)
        assert weight == pytest.approx(mass * 9.81, rel=0.06), person


def test_centres_of_pressure_lie_under_the_foot_as_the_file_has_them(gait_data):
    trial = read_c3d(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d")
    forces = trial.stream("forces")
    for platform in platforms(trial):
        written = np.stack([forces[f"{platform.name}_p{axis}"] for axis in "xyz"], 1)
        pressed = platform.load_n > 20
        assert platform.pressure_centre()[pressed] == pytest.approx(written[pressed], abs=1e-6)
        assert platform.surface is not None
        assert np.mean(platform.surface.outside(platform.pressure_centre()[pressed]) < 0) > 0.99


@pytest.mark.parametrize("kind", ["type-2a", "type-4a"])
def test_a_plate_with_a_matrix_weighs_as_one_without(gait_data, kind):
    trial = read_c3d(gait_data / "c3d_reader_samples" / "c3d_org_other" / f"{kind}.c3d")
    reference = platforms(read_c3d(gait_data / "c3d_reader_samples" / "c3d_org_other" / "type-2a.c3d"))
    for platform, other in zip(platforms(trial), reference, strict=True):
        assert platform.load_n == pytest.approx(other.load_n, abs=2.0)
        both = (platform.load_n > 150) & (other.load_n > 150)
        assert platform.pressure_centre()[both] == pytest.approx(other.pressure_centre()[both], abs=2e-3)


def test_forces_of_an_opensim_file_name_their_foot(gait_data):
    walk = gait_data.parent / "opensim_gait10dof" / "ExperimentalData" / "subject01_walk_grf.mot"
    trial = read_trial(walk)
    forces = trial.stream("forces")
    for platform in platforms(trial):
        assert (platform.side, platform.up.tolist()) == (platform.name[-1], [0, 1, 0])
        written = np.stack([forces[f"{platform.name}_p{axis}"] for axis in "xyz"], 1)
        pressed = platform.load_n > 50
        # the file's moment has parts along the floor: they move the point to where only the free moment is left
        assert np.median(np.abs(platform.pressure_centre()[pressed] - written[pressed])) < 0.02


# ezc3d has a force platform filter of its own; it leaves FORCE_PLATFORM:ZERO alone, so files without a zero range
@pytest.mark.parametrize(
    "file",
    [
        "young_straight_and_turn/HC030A/straight/HC030A05.c3d",
        "opensim_walks/c3d_walk_noemg/walking2.c3d",
        "c3d_reader_samples/gait/PiG_Motion3_FF.c3d",
    ],
)
def test_wrenches_are_those_of_another_program(gait_data, file):
    theirs = ezc3d.c3d(str(gait_data / file), extract_forceplat_data=True)["data"]["platform"]
    found = platforms(read_c3d(gait_data / file))
    assert len(found) == len(theirs)
    for plate, other in zip(found, theirs, strict=True):
        loaded = plate.load_n > 100
        assert plate.wrench.force == pytest.approx(np.asarray(other["force"]).T, abs=1e-3)
        pressure = np.asarray(other["center_of_pressure"]).T / 1000
        assert plate.pressure_centre()[loaded] == pytest.approx(pressure[loaded], abs=1e-5)
        free = np.asarray(other["Tz"]).T[:, 2] / 1000
        assert (plate.wrench.about(plate.pressure_centre()) @ plate.up)[loaded] == pytest.approx(free[loaded], abs=1e-3)


POINT = np.array([0.31, 0.2, 0.012])
UP = np.array([0.0, 0.0, 1.0])


def test_force_point_and_free_moment_come_back():
    force = np.array([[40.0, -25.0, 640.0], [-10.0, 3.0, 300.0]])
    free = np.array([[0, 0, 4.0], [0, 0, -2.5]])
    place = np.array([[0.4, 0.1, 0.012], [0.2, 0.33, 0.012]])
    wrench = Wrench.at(place, force, free)
    assert wrench.pressure_centre(POINT, UP) == pytest.approx(place)
    assert wrench.about(wrench.pressure_centre(POINT, UP)) @ UP == pytest.approx(free[:, 2])
    assert wrench.about(place) == pytest.approx(free)


def test_no_centre_of_pressure_below_the_limit():
    wrench = Wrench.at(POINT, np.array([[0, 0, 19.9], [0, 0, 20.1], [0, 0, -700.0]]))
    assert np.isfinite(wrench.pressure_centre(POINT, UP)).all(axis=1).tolist() == [False, True, False]


def test_two_plates_under_one_foot_are_one_force_between_them():
    left, right = (
        Wrench.at(np.array([x, 0.0, 0.0]), np.array([[0.0, 0.0, n]])) for x, n in ((0.0, 100.0), (0.4, 300.0))
    )
    assert (left + right).pressure_centre(np.zeros(3), UP) == pytest.approx(np.array([[0.3, 0.0, 0.0]]))
    assert ((left + right) - right).force == pytest.approx(left.force)


def test_a_wrench_of_unlike_shapes_is_refused():
    with pytest.raises(ShapeError, match=r"shape \(sample, 3\).*\(4, 3\).*\(3, 3\)"):
        Wrench(np.zeros((4, 3)), np.zeros((3, 3)))


FRAMES, SAMPLES = np.arange(300) / 100, np.arange(3000) / 1000


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
    two = [PlateStep("plate_1", "", 0.5, 1.0, "both feet are on it")]
    loads = foot_loads(found, two, FRAMES, np.inf, {"r": [Span(0.3, 0.7)]})
    assert [at(loads["r"].known, t) for t in (0.4, 0.6)] == [True, False]
    assert not loads["r"].wrench.force.any()


def test_frames_between_foot_off_and_the_end_of_the_force_are_bridged():
    found, steps = [plate("plate_1", (0.5, 1.0))], [PlateStep("plate_1", "r", 0.5, 1.0)]
    known = foot_loads(found, steps, FRAMES, np.inf, {"r": [Span(1.04, 1.4)]})["r"].known
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
    events = [(CONTACT, "r", 0.1), (OFF, "l", 0.2), (CONTACT, "l", 0.6), (OFF, "r", 0.7)]
    trial = Trial("walk", {}, tuple(Event(*event) for event in events))
    assert swings(trial, {}) == {"r": [], "l": [(0.2, 0.6)]}


def test_a_foot_that_flies_off_its_plate_is_known_until_it_comes_down():
    found, steps = [plate("plate_1", (0.5, 1.2))], [PlateStep("plate_1", "r", 0.5, 1.2)]
    y = 3.0 * (np.clip(FRAMES, 0.1, 0.5) + np.clip(FRAMES, 1.2, 1.6))
    heel = np.stack([0 * y, y, 0 * y], axis=1)
    path = FootPath("r", FRAMES, heel, np.add(heel, [0.0, 0.18, 0.0]))
    known = foot_loads(found, steps, FRAMES, np.inf, swings(Trial("walk", {}), {"r": path}))["r"].known
    assert [at(known, t) for t in (0.05, 0.3, 0.8, 1.4, 1.7)] == [False, True, True, True, False]
