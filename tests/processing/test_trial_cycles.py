"""Cycles whose events are known."""

from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.kinetics.plate_steps import PlateStep
from gaitdisc.processing.step_events import StepEvents
from gaitdisc.processing.trial_cycles import (
    cut_cycles,
    feet_in,
    heel_paths,
    plate_loadings,
    with_gaps,
    with_plate_steps,
    with_plates,
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
    right = [one for one in with_plates(cut_cycles(CONTACTS, OFFS), plate_loadings(_plates(*spans))) if one.side == "r"]
    assert [one.kinetic for one in right] == kinetic


def test_each_foot_s_own_belt_is_kinetic_throughout():
    time = np.arange(400) / 100
    belts = tuple(Channel(f"ground_force_{side}_vy", "vertical_force", "N", side) for side in "rl")
    trial = Trial("belts", {"forces": Recording(time, np.ones((400, 2)), belts)})
    assert all(one.kinetic for one in with_plates(cut_cycles(CONTACTS, OFFS), plate_loadings(trial)))


def _feet(speed, turned=False):
    """Heels that stand still from contact to contact of their foot, 0.1 m beside the middle; the pelvis between."""
    time = np.arange(450) / 100
    places = {}
    for side, phase, across in (("R", 0.0, -0.1), ("L", 0.5, 0.1)):
        stride = time - phase
        swing = np.clip((stride % 1.0 - 0.6) / 0.4, 0, 1)
        places[f"{side}HEE"] = (speed * (np.floor(stride) + phase + swing * swing * (3 - 2 * swing)), across, 0.05)
    places["SACR"] = (speed * time, 0.0, 0.9)
    columns, channels = [], []
    for name, (along, across, up) in places.items():
        axes = (0 * time + across, -along) if turned else (along, 0 * time + across)
        columns += [*axes, 0 * time + up]
        channels += [Channel(f"{name}.{axis}", "marker", "m") for axis in "xyz"]
    return Trial("feet", {"markers": Recording(time, np.column_stack(columns), tuple(channels))})


@pytest.mark.parametrize("turned", [False, True])
def test_lengths_are_those_that_the_heels_walked(turned):
    contacts = {"r": ((1.0, "events"), (2.0, "events"), (3.0, "events")), "l": ((1.5, "events"), (2.5, "events"))}
    places = feet_in(cut_cycles(contacts, OFFS), heel_paths(_feet(1.3, turned)))
    for place in places:
        assert place.stride_m == pytest.approx(1.3, abs=0.01)
        assert place.step_m == pytest.approx(0.65, abs=0.01)
        assert place.width_m == pytest.approx(0.2, abs=0.01)  # feet do not cross: positive for both
        assert place.step_s == pytest.approx(0.5)


def test_without_markers_only_the_step_s_time_is_known():
    place = feet_in(cut_cycles(CONTACTS, OFFS), heel_paths(Trial("none", {})))[0]
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
    found = with_plate_steps(cut_cycles(CONTACTS, OFFS), [step])
    assert [one.kinetic for one in found] == [False, kinetic, False]
