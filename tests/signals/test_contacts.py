"""Initial contacts: events of force and of angles, and who detects what."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import markers_at
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Event, Recording, Source, Trial
from gaitdisc.signals.contact_movement import angle_contacts, marker_contacts
from gaitdisc.signals.contacts import Contacts, event_contacts, force_contacts, loaded, order_findings, plate_contacts
from gaitdisc.signals.direction import state_direction, walking_direction
from gaitdisc.signals.strides import cut_strides


def contacts(times, side="r", detector="force"):
    return Contacts(np.array(times, float), side, detector)


@given(st.lists(st.floats(0.6, 1.4), min_size=2, max_size=20), st.floats(-0.1, 0.1))
def test_a_shift_is_found_and_nothing_is_missed(durations, shift):
    times = np.cumsum(durations)
    found = contacts(times).compared(contacts(times + shift, detector="markers"))
    assert len(found.difference_s) == len(times)
    assert found.median_ms == pytest.approx(1e3 * shift, abs=1e-6)
    assert (len(found.missed), len(found.extra)) == (0, 0)


def test_missed_and_extra_are_counted_within_the_span_of_both():
    found = contacts([0, 1, 2, 3, 4, 5]).compared(contacts([1.01, 2.5, 3.01, 4.03]))
    assert found.missed.tolist() == [2.0]
    assert found.extra.tolist() == [2.5]
    assert says(found.line(), "3 pairs", "+10 ms", "10 ms", "1 missed, 1 extra")


def test_the_interquartile_range_of_0_to_100_ms_is_50_ms():
    times = np.arange(101.0)
    found = contacts(times).compared(contacts(times + np.arange(101) / 1000))
    assert (found.median_ms, found.iqr_ms) == pytest.approx((50.0, 50.0))


def test_without_contacts_there_are_no_pairs():
    assert np.isnan(contacts([]).compared(contacts([1.0])).median_ms)


def test_two_feet_are_not_compared():
    with pytest.raises(StrideError, match=r"force of side 'r'.*'l'"):
        contacts([1.0]).compared(contacts([1.0], "l"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([2.0, 1.0],), "missing or out of order"),
        (([1.0, np.nan],), "missing or out of order"),
        (([1.0], "x"), "the side is 'x', the detector 'force'"),
        (([1.0], "r", "eye"), "one of the detectors force, markers, angles, events, oscillator"),
    ],
)
def test_contacts_that_are_none_are_refused(arguments, words):
    with pytest.raises(StrideError, match=words):
        contacts(*arguments)


def test_alternating_feet_have_no_findings():
    assert order_findings(contacts(np.arange(5)), contacts(np.arange(5) + 0.5, "l")) == []


def test_a_crossover_is_named_on_both_sides():
    right, left = contacts(np.arange(6)), contacts(np.delete(np.arange(6) + 0.5, 2), "l")
    first, second = order_findings(right, left, "walk.c3d")
    assert first.spans == ((2.0, 3.0),)
    assert says(first.what, "strides", "1 of 5", "2.00 s")
    assert second.spans == ((1.5, 3.5),)
    assert says(first.spoils, "plate or belt")


def trial(*events):
    return Trial("HC030A05", {}, tuple(Event(*event) for event in events))


def test_events_become_contacts_with_foot_off():
    found = event_contacts(
        trial(("initial contact", "r", 2.0), ("foot off", "r", 1.6), ("initial contact", "r", 1.0), ("start", "", 0.0))
    )
    assert found["r"].time.tolist() == [1.0, 2.0]
    assert found["r"].foot_off.tolist() == [1.6]
    assert "l" not in found


def test_contacts_without_a_foot_are_counted():
    found = event_contacts(trial(("initial contact", "r", 2.0), ("initial contact", "", 3.0)))
    assert says(found["r"].note, "excluded", "1 contact without")


@pytest.mark.parametrize(
    ("events", "words"),
    [((), "HC030A05 has none in 0 events"), ((("initial contact", "", 1.0),), "has 1 contact of no side")],
)
def test_a_file_without_contacts_is_refused(events, words):
    with pytest.raises(StrideError, match=words):
        event_contacts(trial(*events))


def test_real_events_agree_with_plates_within_20_ms(gait_data, real):
    ezc3d = pytest.importorskip("ezc3d")
    apart = []
    for path in sorted((gait_data / "young_straight_and_turn").glob("*/straight/*.c3d")):
        c3d = ezc3d.c3d(str(path))
        event = c3d["parameters"]["EVENT"]
        words = {"Foot Strike": "initial contact", "Foot Off": "foot off"}
        rows = zip(event["CONTEXTS"]["value"], event["LABELS"]["value"], event["TIMES"]["value"].T, strict=True)
        events = [Event(words[label], context[0].lower(), 60 * t[0] + t[1]) for context, label, t in rows]
        heels, pelvis = {"r": "RHEE", "l": "LHEE"}, ("RASI", "LASI", "SACR")
        markers = real.markers(c3d, (*heels.values(), *pelvis))
        direction = walking_direction(markers, heels, [n for n in pelvis if f"{n}.x" in markers.names])
        seen = event_contacts(Trial(path.stem, {}, tuple(sorted(events, key=lambda e: e.time))))
        plates = plate_contacts(real.plates(c3d), markers, heels, direction)
        for side in "rl":
            found = seen[side].compared(plates[side])
            assert len(found.extra) == 0
            apart += found.difference_s.tolist()
    assert len(apart) >= 12
    assert 0 < np.median(apart) < 0.015  # a plate needs some ms to 50 N
    assert np.abs(apart).max() < 0.02


@pytest.mark.parametrize("stride_s", [0.66, 1.1, 1.6])
def test_one_contact_a_stride_at_the_same_percent(made, stride_s):
    walk, contacts = made.walk(20, stride_s)
    found = angle_contacts(walk)
    percent = [100 * np.abs(contacts - t).min() / stride_s for t in found["r"].time]
    assert 19 <= len(found["r"]) <= 21
    assert 19 <= len(found["l"]) <= 21
    assert max(percent) < 7  # the made knee is straightest at 97 %
    assert np.std(percent) < 1.5
    assert found["r"].note.startswith("end of knee extension")


def test_without_a_knee_the_hip_stands_in(made):
    walk, contacts = made.walk(20)
    found = angle_contacts(walk.selected(["hip_flexion_r"]), ("r",))["r"]
    percent = np.array([(np.interp(t, contacts, np.arange(21)) * 100) % 100 for t in found.time[1:-1]])
    assert says(found.note, "peak hip flexion", "86 %")
    assert np.all((percent > 80) & (percent < 95))


def test_no_hip_and_a_hip_that_does_not_swing_are_refused(made):
    walk, _ = made.walk(5)
    with pytest.raises(ChannelError, match=r"walk\.mot.*1 channels.*'hip_flexion_r'"):
        angle_contacts(walk.selected(["knee_angle_r"]))
    with pytest.raises(StrideError, match=r"5 deg.*walk\.mot, hip_flexion_r:"):
        angle_contacts(walk.with_values(walk.values / 100))


@pytest.mark.parametrize(
    ("file", "strides"),
    [
        ("c3d_Trimmed_running_natural2_manual_scaling_ik.mot", 83),
        ("c3d_Trimmed_running_exotendon3_manual_scaling_ik.mot", 88),
        ("welk002/manual_ik.mot", 90),
    ],
)
def test_real_running_has_its_strides(gait_data, real, file, strides):
    run = real.mot(gait_data / "exotendon_run" / file)
    found = cut_strides(angle_contacts(run)["r"], run)
    assert abs(len(found) - strides) <= 1
    assert found.dropped == ()


def test_real_treadmill_walks_have_221_strides_and_a_stumble(gait_data, real):
    walks = real.treadmill_walks(gait_data)
    walks.pop("S01DE503")
    found = [cut_strides(angle_contacts(walk)["r"], walk) for walk in walks.values()]
    assert len(found) == 12
    assert sum(len(strides) + len(strides.dropped) for strides in found) == pytest.approx(221, rel=0.01)
    assert all(9 < stride.start < 12 for strides in found for stride in strides.dropped)


RATE = 1000.0


def belt(contacts, duration_s=0.65, chatter_n=0.0, length_s=10.0, seed=0):
    """Force that rises by 10 N a millisecond at each contact."""
    t = np.arange(round(length_s * RATE)) / RATE
    f = np.zeros(len(t))
    for start in contacts:
        inside = (t >= start) & (t < start + duration_s)
        f[inside] = np.minimum(np.minimum(1e4 * (t[inside] - start), 1e4 * (start + duration_s - t[inside])), 700.0)
    rng = np.random.default_rng(seed)
    return t, f + chatter_n * (f == 0) * rng.random(len(t))


def forces(t, columns, sides=("r", "l")):
    channels = tuple(Channel(f"ground_force_{s}_vy", "vertical_force", "N", s) for s in sides)
    return Recording(t, np.stack(columns, axis=1), channels, source=Source("walk.c3d"))


RIGHT, LEFT = np.arange(0.5, 9.5, 1.1), np.arange(1.05, 9.3, 1.1)


@pytest.mark.parametrize("chatter", [0.0, 30.0, 45.0])
def test_contacts_are_where_the_force_passes_50_n_whatever_the_chatter(chatter):
    t, right = belt(RIGHT, chatter_n=chatter)
    _, left = belt(LEFT, chatter_n=chatter, seed=1)
    found = force_contacts(forces(t, [right, left]))
    assert np.abs(found["r"].time - RIGHT - 0.005).max() < 1e-3
    assert len(found["l"]) == len(LEFT)
    assert np.abs(found["r"].foot_off - RIGHT - 0.65).max() < 0.05


def test_bursts_above_the_threshold_are_chatter_too():
    t, f = belt(RIGHT)
    for at in RIGHT:  # 60 N for 10 ms, 40 ms after foot off
        f[(t > at + 0.69) & (t < at + 0.70)] = 60.0
    found = force_contacts(forces(t, [f], "r"))
    assert len(found["r"]) == len(RIGHT)


@pytest.mark.parametrize(("mass_kg", "rise_n"), [(15, 20.0), (40, 4 * 9.81), (70, 50.0), (130, 50.0)])
def test_50_n_or_a_tenth_of_a_light_body_s_weight(mass_kg, rise_n):
    t, f = belt(RIGHT)
    found = force_contacts(forces(t, [f], "r"), body_weight_n=9.81 * mass_kg)["r"]
    assert np.abs(found.time - RIGHT - 1e-4 * rise_n).max() < 1e-6
    assert found.note == f"ground_force_r_vy above {rise_n:.0f} N"


def test_the_sign_is_found_and_said():
    t, f = belt(RIGHT)
    up, down = force_contacts(forces(t, [f], "r"))["r"], force_contacts(forces(t, [-f], "r"))["r"]
    assert np.array_equal(up.time, down.time)
    assert "negative when loaded" in down.note


def test_a_recording_that_begins_in_stance_has_no_contact_there():
    t, f = belt([-0.2, 0.9, 2.0], length_s=4.0)
    assert len(force_contacts(forces(t, [f], "r"))["r"]) == 2


def test_loadings_are_whole():
    assert loaded(belt(RIGHT, chatter_n=30.0)[1], RATE).shape == (len(RIGHT), 2)


def test_a_plate_without_a_side_is_refused():
    plate = Recording(np.arange(10) / RATE, np.zeros((10, 1)), (Channel("Fz1", "vertical_force", "N"),))
    with pytest.raises(ChannelError, match=r"Fz1.*plate or belt"):
        force_contacts(plate)


def test_the_leading_heel_tells_the_foot():
    t, first = belt([1.0], length_s=3.0)
    _, second = belt([1.6], length_s=3.0)
    plates = Recording(
        t, np.stack([first, second], axis=1), tuple(Channel(f"plate{k}", "vertical_force", "N") for k in (1, 2))
    )
    slow = np.arange(300) / 100
    right, left = (np.outer(ahead, [1, 0, 0]) for ahead in (np.full(300, 0.6), np.where(slow < 1.3, 0.0, 1.2)))
    marked = markers_at(slow, {"RHEE": right, "LHEE": left})
    found = plate_contacts(plates, marked, {"r": "RHEE", "l": "LHEE"}, state_direction((1, 0, 0)))
    assert found["r"].time == pytest.approx([1.005], abs=1e-3)
    assert found["l"].time == pytest.approx([1.605], abs=1e-3)
    blind = markers_at(slow, {"RHEE": right, "LHEE": left * [np.nan, 1, 1]})
    with pytest.raises(StrideError, match=r"plate1.*1\.005 s"):
        plate_contacts(plates, blind, {"r": "RHEE", "l": "LHEE"}, state_direction((1, 0, 0)))


@pytest.mark.parametrize("missing", ["RHEE", "LHEE"])
def test_one_heel_in_front_of_the_pelvis_or_behind_it_tells_the_foot(missing):
    t, plates = belt([1.0], length_s=3.0)[0], [belt([at], length_s=3.0)[1] for at in (1.0, 1.6)]
    channels = tuple(Channel(f"plate{k}", "vertical_force", "N") for k in (1, 2))
    forces_ = Recording(t, np.stack(plates, axis=1), channels)
    slow = np.arange(300) / 100
    ahead = {"RHEE": np.full(300, 0.6), "LHEE": np.where(slow < 1.3, 0.0, 1.2), "SACR": np.where(slow < 1.3, 0.3, 0.9)}
    ahead[missing] = np.full(300, np.nan)
    given = {"heels": {"r": "RHEE", "l": "LHEE"}, "direction": state_direction((1, 0, 0)), "pelvis": ("SACR",)}
    marked = markers_at(slow, {name: np.outer(one, [1, 0, 0]) for name, one in ahead.items()})
    found = plate_contacts(forces_, marked, **given)
    assert found["r"].time == pytest.approx([1.005], abs=1e-3)
    assert found["l"].time == pytest.approx([1.605], abs=1e-3)
    ahead["SACR"] = np.where(slow < 1.3, 0.55, 0.05) if missing == "LHEE" else np.where(slow < 1.3, 0.05, 1.15)
    near = markers_at(slow, {name: np.outer(one, [1, 0, 0]) for name, one in ahead.items()})
    with pytest.raises(StrideError, match="heel marker is missing"):
        plate_contacts(forces_, near, **given)


def test_real_belts_that_chatter(gait_data, real):
    ezc3d = pytest.importorskip("ezc3d")
    c3d = ezc3d.c3d(str(gait_data / "treadmill_c3d_emg" / "walking_1.c3d"))
    heels, pelvis = {"r": "RCAL", "l": "LCAL"}, ("RASI", "LASI", "RPSI", "LPSI")
    markers, plates = real.markers(c3d, (*heels.values(), *pelvis)), real.plates(c3d)
    direction = walking_direction(markers, heels, pelvis)
    by_foot = plate_contacts(plates, markers, heels, direction)
    feet = {"plate1": "l", "plate2": "r"}
    of_feet = tuple(replace(channel, side=feet.get(channel.name, "")) for channel in plates.channels)
    by_belt = force_contacts(replace(plates, channels=of_feet))
    zeni = marker_contacts(markers, heels, pelvis, direction)
    assert order_findings(by_belt["r"], by_belt["l"]) == []
    for side, count, apart in (("r", 6, -51), ("l", 7, -61)):
        assert np.array_equal(by_foot[side].time, by_belt[side].time)
        assert len(cut_strides(by_belt[side])) == count
        found = by_belt[side].compared(zeni[side])
        assert (len(found.missed), len(found.extra)) == (0, 0)
        assert found.median_ms == pytest.approx(apart, abs=3)
        assert found.iqr_ms < 15
