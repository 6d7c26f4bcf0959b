from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Recording, Source
from gaitdisc.signals.contact_movement import marker_contacts
from gaitdisc.signals.contacts import force_contacts, loaded, order_findings, plate_contacts
from gaitdisc.signals.direction import given_direction, walking_direction
from gaitdisc.signals.strides import cut_strides

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
    heels = np.zeros((300, 6))
    heels[:, 0], heels[:, 3] = np.where(slow < 1.3, 0.6, 0.6), np.where(slow < 1.3, 0.0, 1.2)
    channels = tuple(Channel(f"{n}.{a}", "marker", "m") for n in ("RHEE", "LHEE") for a in "xyz")
    marked = Recording(slow, heels, channels)
    found = plate_contacts(plates, marked, {"r": "RHEE", "l": "LHEE"}, given_direction((1, 0, 0)))
    assert found["r"].time == pytest.approx([1.005], abs=1e-3)
    assert found["l"].time == pytest.approx([1.605], abs=1e-3)
    heels[:, 3] = np.nan
    with pytest.raises(StrideError, match=r"plate1.*1\.005 s"):
        plate_contacts(plates, Recording(slow, heels, channels), {"r": "RHEE", "l": "LHEE"}, given_direction((1, 0, 0)))


@pytest.mark.parametrize("missing", ["RHEE", "LHEE"])
def test_one_heel_in_front_of_the_pelvis_or_behind_it_tells_the_foot(missing):
    t, plates = belt([1.0], length_s=3.0)[0], [belt([at], length_s=3.0)[1] for at in (1.0, 1.6)]
    channels = tuple(Channel(f"plate{k}", "vertical_force", "N") for k in (1, 2))
    forces_ = Recording(t, np.stack(plates, axis=1), channels)
    slow = np.arange(300) / 100
    ahead = {"RHEE": np.full(300, 0.6), "LHEE": np.where(slow < 1.3, 0.0, 1.2), "SACR": np.where(slow < 1.3, 0.3, 0.9)}
    ahead[missing] = np.full(300, np.nan)
    zero = np.zeros(300)
    names = tuple(Channel(f"{n}.{a}", "marker", "m") for n in ahead for a in "xyz")
    given = {"heels": {"r": "RHEE", "l": "LHEE"}, "direction": given_direction((1, 0, 0)), "pelvis": ("SACR",)}
    marked = Recording(slow, np.stack([x for one in ahead.values() for x in (one, zero, zero)], axis=1), names)
    found = plate_contacts(forces_, marked, **given)
    assert found["r"].time == pytest.approx([1.005], abs=1e-3)
    assert found["l"].time == pytest.approx([1.605], abs=1e-3)
    ahead["SACR"] = np.where(slow < 1.3, 0.55, 0.05) if missing == "LHEE" else np.where(slow < 1.3, 0.05, 1.15)
    near = Recording(slow, np.stack([x for one in ahead.values() for x in (one, zero, zero)], axis=1), names)
    with pytest.raises(StrideError, match="heel missing there"):
        plate_contacts(forces_, near, **given)


def test_real_belts_that_chatter(gait_data, real):
    ezc3d = pytest.importorskip("ezc3d")
    c3d = ezc3d.c3d(str(gait_data / "treadmill_c3d_emg" / "walking_1.c3d"))
    heels, pelvis = {"r": "RCAL", "l": "LCAL"}, ("RASI", "LASI", "RPSI", "LPSI")
    markers, plates = real.markers(c3d, (*heels.values(), *pelvis)), real.plates(c3d)
    direction = walking_direction(markers, heels, pelvis)
    by_foot = plate_contacts(plates, markers, heels, direction)
    by_belt = force_contacts(plates, {"plate1": "l", "plate2": "r"})
    zeni = marker_contacts(markers, heels, pelvis, direction)
    assert order_findings(by_belt["r"], by_belt["l"]) == []
    for side, count, apart in (("r", 6, -51), ("l", 7, -61)):
        assert np.array_equal(by_foot[side].time, by_belt[side].time)
        assert len(cut_strides(by_belt[side])) == count
        found = by_belt[side].compared(zeni[side])
        assert (len(found.missed), len(found.extra)) == (0, 0)
        assert found.median_ms == pytest.approx(apart, abs=3)
        assert found.iqr_ms < 15
