"""Cycles whose events are known: their channels, forces of the ground, pelvis and foot."""

import numpy as np
import pytest
from changed_trials import markers_at
from scipy.spatial.transform import Rotation
from texts import says

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.study import Filters
from gaitdisc.kinematics.motion import move_body
from gaitdisc.kinematics.pose import clinical_angles
from gaitdisc.kinetics.plate_steps import PlateStep
from gaitdisc.processing.step_events import StepEvents
from gaitdisc.processing.trial_cycles import (
    PLUG_IN_GAIT,
    cut_cycles,
    cycle_channels,
    find_places,
    heel_paths,
    is_kinetic,
    plate_loadings,
    scale_forces,
    with_gaps,
    with_pelvis_and_foot,
)
from gaitdisc.recording import Recording, Trial

CONTACTS = {"r": ((1.0, "events"), (2.0, "events"), (3.0, "events")), "l": ((1.5, "events"), (2.5, "events"))}
OFFS = {"r": ((1.6, "events"), (2.6, "events")), "l": ((1.1, "events"), (2.1, "events"))}


def test_every_event_of_a_cycle_is_its_own():
    left, first, second = cut_cycles(CONTACTS, OFFS)
    assert (left.side, left.start, left.end) == ("l", 1.5, 2.5)
    assert (left.foot_off, left.opposite_off, left.opposite_contact) == (2.1, 1.6, 2.0)
    assert (first.foot_off, first.opposite_off, first.opposite_contact) == (1.6, 1.1, 1.5)
    assert (second.foot_off, second.opposite_off, second.opposite_contact) == (2.6, 2.1, 2.5)
    assert [one.reason for one in (left, first, second)] == ["", "", ""]


def test_a_missed_or_a_false_contact_leaves_the_cycle_out_with_its_reason():
    missed = {**CONTACTS, "l": ((0.5, "events"), (1.5, "events"), (3.5, "events"))}
    first, second = [one.reason for one in cut_cycles(missed, OFFS) if one.side == "r"]
    assert first == "" and says(second, "no contact", "other foot")
    false = {**CONTACTS, "l": ((1.3, "events"), (1.6, "events"))}
    assert next(one for one in cut_cycles(false, OFFS) if one.side == "r").reason.startswith("2 contacts")


def test_the_first_and_last_cycle_may_lack_the_other_foot():
    alone = cut_cycles({"r": CONTACTS["r"], "l": ()}, {})
    assert [one.reason for one in alone] == ["", ""]
    assert np.isnan(alone[0].opposite_contact) and np.isnan(alone[0].foot_off)


def _plates(*spans):
    time = np.arange(4000) / 1000
    columns = [np.where((time >= a) & (time <= b), -600.0, 0.0) for a, b in spans]
    channels = tuple(Channel(f"plate_{k + 1}_fz", "vertical_force", "N", "") for k in range(len(spans)))
    return Trial("plates", {"forces": Recording(time, np.column_stack(columns), channels)})


@pytest.mark.parametrize(
    ("spans", "kinetic"),
    [
        ([(1.01, 1.61)], [True, False]),
        ([(1.01, 1.61), (2.02, 2.61)], [True, True]),
        ([(1.01, 2.1)], [False, False]),  # two feet on one plate
        ([(1.01, 1.4)], [False, False]),  # the foot stands on beside the plate
        ([(1.01, 1.61), (1.02, 1.5)], [False, False]),  # one foot on two plates
    ],
)
def test_a_kinetic_cycle_has_one_foot_on_one_plate_for_the_whole_stance(spans, kinetic):
    plates = plate_loadings(_plates(*spans))
    assert [is_kinetic(one, plates) for one in cut_cycles(CONTACTS, OFFS) if one.side == "r"] == kinetic


@pytest.mark.parametrize(("standing", "right"), [(1.0, [True, True]), (700.0, [True, True]), (0.0, [True, False])])
def test_a_foot_s_own_force_makes_kinetic_the_cycles_that_it_carries(standing, right):
    """A belt throughout, in newtons or in body weights; over ground nothing is under the second step."""
    time = np.arange(400) / 100
    own = tuple(Channel(f"ground_force_{side}_vy", "vertical_force", "N", side) for side in "rl")
    forces = np.column_stack([np.where(time < 1.8, max(standing, 1.0), standing), np.ones(400)])
    plates, cycles = plate_loadings(Trial("own", {"forces": Recording(time, forces, own)})), cut_cycles(CONTACTS, OFFS)
    assert [is_kinetic(one, plates) for one in cycles if one.side == "r"] == right
    assert all(is_kinetic(one, plates) for one in cycles if one.side == "l")


def _feet(speed, turned=False):
    """Heels that stand still from contact to contact of their foot, 0.1 m beside the middle; the pelvis between."""
    time = np.arange(450) / 100
    places = {}
    for side, phase, across in (("R", 0.0, -0.1), ("L", 0.5, 0.1)):
        stride = time - phase
        swing = np.clip((stride % 1.0 - 0.6) / 0.4, 0, 1)
        places[f"{side}HEE"] = (speed * (np.floor(stride) + phase + swing * swing * (3 - 2 * swing)), across, 0.05)
    places["SACR"] = (speed * time, 0.0, 0.9)
    for name, (along, across, up) in places.items():
        axes = (0 * time + across, -along) if turned else (along, 0 * time + across)
        places[name] = np.column_stack([*axes, 0 * time + up])
    return Trial("feet", {"markers": markers_at(time, places)})


@pytest.mark.parametrize("turned", [False, True])
def test_lengths_are_those_that_the_heels_walked(turned):
    contacts = {"r": ((1.0, "events"), (2.0, "events"), (3.0, "events")), "l": ((1.5, "events"), (2.5, "events"))}
    feet = heel_paths(_feet(1.3, turned))
    for place in (find_places(cycle, feet) for cycle in cut_cycles(contacts, OFFS)):
        assert place.stride_m == pytest.approx(1.3, abs=0.01)
        assert place.step_m == pytest.approx(0.65, abs=0.01)
        assert place.width_m == pytest.approx(0.2, abs=0.01)  # feet do not cross: positive for both
        assert place.step_s == pytest.approx(0.5)


def test_without_markers_only_the_step_s_time_is_known():
    place = find_places(cut_cycles(CONTACTS, OFFS)[0], heel_paths(Trial("none", {})))
    assert place.step_s == 0.5 and np.isnan(place.stride_m)


def test_a_gap_of_the_own_leg_leaves_a_cycle_out_and_one_of_the_other_does_not():
    time = np.arange(400) / 100
    values = np.zeros((400, 2))
    values[130:160, 0] = np.nan
    knees = tuple(Channel(f"knee_angle_{side}", "angle", "deg", side) for side in "rl")
    found = with_gaps(cut_cycles(CONTACTS, OFFS), Recording(time, values, knees))
    assert [one.reason for one in found] == ["", "knee_angle_r missing for 0.30 s", ""]
    assert with_gaps(cut_cycles(CONTACTS, OFFS), None) == cut_cycles(CONTACTS, OFFS)


def test_an_offset_moves_markers_and_not_the_ground():
    steps = StepEvents(
        "markers", "markers", {"r": np.array([1.0, 2.0])}, {"r": np.array([1.6])}, {"r": ((1.04, "force"),)}, {}
    )
    (one,) = cut_cycles(steps.corrected("contacts", 0.04), steps.corrected("foot_offs", -0.01))
    assert (one.start, one.end, one.foot_off) == pytest.approx((1.04, 2.04, 1.59))
    assert one.contacts_by == ("force", "markers") and one.foot_off_by == "markers"


@pytest.mark.parametrize(
    ("step", "kinetic"),
    [
        (PlateStep("plate_1", "r", 1.02, 1.57), True),
        (PlateStep("plate_1", "l", 1.02, 1.57), False),  # the other foot's
        (PlateStep("plate_1", "r", 1.02, 1.57, reason="two feet"), False),
        (PlateStep("plate_1", "r", 1.02, 1.57, whole=False), False),
        (PlateStep("plate_1", "r", 1.08, 1.57), False),  # begins too late to be this contact
        (PlateStep("plate_1", "r", 1.02, 1.50), False),
    ],
)
def test_a_cycle_whose_stance_is_a_clean_whole_step_is_kinetic(step, kinetic):
    found = [is_kinetic(cycle, {}, [step]) for cycle in cut_cycles(CONTACTS, OFFS)]
    assert found == [False, kinetic, False]


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


STEP = np.sin(np.linspace(0, np.pi, 60))
FORE_AFT = 20 * np.sin(np.linspace(0, 2 * np.pi, 60))  # positive first: brakes


def _trial(sign=1.0, unit="%"):
    values = np.full((200, 4), np.nan)
    values[50:110, 0], values[50:110, 1] = sign * FORE_AFT, 110 * STEP
    labels = ("LNormalisedGRF.x", "LNormalisedGRF.z", "RNormalisedGRF.x", "RNormalisedGRF.z")
    channels = tuple(Channel(label, "force", unit) for label in labels)
    return Trial("a", {"moments": Recording(np.arange(200) / 100, values, channels)})


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_step_brakes_first_whichever_way_the_file_counts_and_is_zero_off_the_plate(sign):
    found = scale_forces(_trial(sign))
    assert found.names == ("ground_force_l_vx", "ground_force_l_vy")  # the right foot met no plate
    assert found["ground_force_l_vx"][65] == pytest.approx(-20.0, abs=0.1)
    assert found["ground_force_l_vx"][95] == pytest.approx(20.0, abs=0.2)
    assert found["ground_force_l_vy"].max() == pytest.approx(110.0, abs=0.1)
    assert not found["ground_force_l_vy"][[0, 49, 110, 199]].any()


def test_another_unit_or_no_moments_give_none():
    assert scale_forces(_trial(unit="N")) is None
    knee = Recording(np.arange(3) / 100, np.zeros((3, 1)), (Channel("knee_angle_r", "angle", "deg", "r"),))
    assert scale_forces(Trial("a", {"kinematics": knee})) is None


LABELS = ("RPelvisAngles.x", "LPelvisAngles.y", "RPelvisAngles.z", "RFootProgressAngles.z", "LFootProgressAngles.z")


def _recording(*labels, unit="deg"):
    values = np.arange(1.0, 4.0)[:, None] * np.arange(1, len(labels) + 1)
    suspect = np.zeros(values.shape, bool)
    suspect[1, 0] = True
    quantity = "angle" if unit == "deg" else "signal"
    channels = tuple(Channel(label, quantity, unit) for label in labels)
    return Recording(np.arange(3) / 100, values, channels, suspect=suspect)


def test_plug_in_gait_tilts_forwards_and_the_house_backwards():
    found = with_pelvis_and_foot(_recording(*LABELS))
    assert found.names == (*LABELS, *PLUG_IN_GAIT)
    np.testing.assert_allclose(found["pelvis_tilt"], [-1.0, -2.0, -3.0])
    np.testing.assert_allclose(found["pelvis_list"], [2.0, 4.0, 6.0])
    np.testing.assert_allclose(found["foot_progression_angle_l"], [5.0, 10.0, 15.0])
    assert found.channels[-1] == vocabulary().named("foot_progression_angle_l")
    assert found.suspect[:, 5].tolist() == [False, True, False]


def test_what_is_there_already_stays_and_numbers_without_a_unit_are_no_angle():
    own = _recording("RPelvisAngles.x", "pelvis_tilt")
    assert with_pelvis_and_foot(own).names == own.names
    bare = _recording(*LABELS, unit="1")
    assert with_pelvis_and_foot(bare).names == LABELS


def test_a_pelvis_that_turns_keeps_its_tilt_and_list_about_its_own_heading():
    """Tilt 15 deg forwards and 4 deg of list throughout a quarter turn; about the laboratory's axes they change."""
    time = np.arange(300) / 100
    heading = np.clip((time - 0.5) * 45, 0, 90)
    own = Rotation.from_euler("ZXY", np.tile([-15.0, 4.0, 0.0], (300, 1)), degrees=True)
    turned = Rotation.from_euler("ZXY", np.outer(heading, [0, 0, 1]), degrees=True)
    lab = clinical_angles(np.eye(3)[None], (turned * own).as_matrix())
    values = np.column_stack([-lab[:, 0], lab[:, 1], lab[:, 2], 0 * time, 0 * time])
    channels = tuple(Channel(label, "angle", "deg") for label in LABELS)
    found = with_pelvis_and_foot(Recording(time, values, channels))
    assert np.ptp(lab[:, 0]) > 10.0
    steady = (time > 1.0) & (time < 2.0)
    np.testing.assert_allclose(found["pelvis_tilt"][steady], -15.0, atol=0.5)
    np.testing.assert_allclose(found["pelvis_list"][steady], 4.0, atol=0.5)
    assert np.isnan(found["pelvis_rotation"]).all()
    assert np.isnan(found["foot_progression_angle_r"]).all()


def test_a_straight_walk_that_is_seen_from_one_extreme_of_the_pelvis_to_the_other_does_not_turn():
    time = np.arange(400) / 100
    rotation = np.where((time > 1.0) & (time < 2.5), 10.0 * np.cos(2 * np.pi * (time - 1.0)), np.nan)
    values = np.column_stack([0 * time, 0 * time, rotation, 0 * time, 0 * time])
    found = with_pelvis_and_foot(Recording(time, values, tuple(Channel(label, "angle", "deg") for label in LABELS)))
    np.testing.assert_array_equal(found["pelvis_rotation"], rotation)


def test_tilt_and_list_of_real_turns_are_those_of_the_markers(gait_data):
    """Against `gaitdisc angles` of the same markers; about the laboratory's axes they differ by 5 to 15 deg (rms)."""
    folder = gait_data / "young_straight_and_turn"
    for name, file in (("HC030A", "HC030A22.c3d"), ("HC002D", "HC002D25.c3d")):
        static = next(iter([*(gait_data / "young_static" / name).glob("*"), *(folder / name / "static").glob("*")]))
        walk = read_trial(folder / name / "turn" / file)
        ours = move_body(
            walk.stream("markers"), read_trial(static).stream("markers"), measures=read_body_measures(static)
        ).angles
        found = with_pelvis_and_foot(walk.stream("kinematics"))
        for angle in ("pelvis_tilt", "pelvis_list"):
            assert np.sqrt(np.nanmean((found[angle] - ours[angle]) ** 2)) < 1.0, (name, angle)
