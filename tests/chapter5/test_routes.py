import numpy as np
import pytest
from chapter5.routes import Route, along, circuit, fixed, fixed_at_random, joined, random_walk
from hypothesis import given, settings
from hypothesis import strategies as st
from manufactured_field import travelling_wave

from gaitdisc.errors import ChannelError
from gaitdisc.recording.field import Axis, Field

WAVE = travelling_wave(60)


@given(st.integers(0, 2**31))
@settings(max_examples=20, deadline=None)
def test_readings_are_rows_of_the_identity_times_the_state(seed):
    route = joined([random_walk(WAVE, seed), fixed_at_random(WAVE, 2, seed)])
    t = seed % len(WAVE)
    c_t = np.eye(WAVE.points)[route.points[t]]
    np.testing.assert_array_equal(route.readings(WAVE)[t], c_t @ WAVE.values[t].astype(float))
    np.testing.assert_array_equal(route.places(WAVE)[t], WAVE.places[route.points[t]])


@given(st.integers(0, 2**31))
@settings(max_examples=20, deadline=None)
def test_a_walk_takes_one_node_every_third_snapshot_and_stays_inside(seed):
    walk = random_walk(WAVE, seed)
    nodes = WAVE.nodes[walk.points[:, 0]]
    steps = np.abs(np.diff(nodes, axis=0)).sum(axis=1)
    assert (steps[np.arange(1, 60) % 3 != 0] == 0).all()
    assert set(steps[np.arange(1, 60) % 3 == 0]) == {1}
    assert (walk.points >= 0).all()


def test_steps_go_along_each_axis_and_way_equally_often():
    cube = np.arange(21.0)
    axes = tuple(Axis(name, cube) for name in "zyx")
    flow = Field(np.arange(90.0), np.zeros((90, 21**3, 1)), axes, np.ones((21,) * 3, bool), ("u",), ("1",))
    steps = np.vstack([np.diff(flow.nodes[random_walk(flow, k).points[::3, 0]], axis=0) for k in range(40)])
    counts = np.array([(steps[:, axis] == way).sum() for axis in range(3) for way in (-1, 1)])
    assert counts.sum() == len(steps)
    assert np.abs(counts - len(steps) / 6).max() < 4 * np.sqrt(len(steps) / 6)
    assert flow.nodes[random_walk(flow, 0).points[0, 0]].tolist() == [10, 10, 10]


def test_a_walk_that_is_shut_in_stays():
    alone = np.zeros((3, 3), bool)
    alone[1, 1] = True
    axes = (Axis("y", np.arange(3.0)), Axis("x", np.arange(3.0)))
    pond = Field(np.arange(9.0), np.zeros((9, 1, 1)), axes, alone, ("h",), ("m",))
    assert (random_walk(pond, 0).points == 0).all()


def test_a_circuit_comes_back_after_its_period():
    route = circuit(WAVE, [(-2.0, 4.0), (-2.0, 16.0)], 12, "out and back")
    places = route.places(WAVE)[:, 0]
    np.testing.assert_array_equal(places[:48], places[12:])
    assert places[0].tolist() == [-2, 4]
    assert places[6].tolist() == [-2, 16]
    assert places[3].tolist() == places[9].tolist() == [-2, 10]


def test_a_path_outside_the_field_is_one_clear_error():
    away = [(-2.0, 10.0)] * 30 + [(-2.0, 99.0)] * 30
    with pytest.raises(ChannelError, match=r"'ship'.*30 of 60.*lat -2.*99 deg"):
        along(WAVE, away, "ship")
    with pytest.raises(ChannelError, match=r"lat -4.*lon 2 deg"):
        along(WAVE, [(-4.0, 2.0)] * 60, "ship")
    with pytest.raises(ChannelError, match=r"60 snapshots.*2 axes.*\(3, 2\)"):
        along(WAVE, [(0.0, 0.0)] * 3, "ship")
    with pytest.raises(ChannelError, match=r"0 to 69.*70"):
        fixed(WAVE, [3, 70])
    with pytest.raises(ChannelError, match="requested: none"):
        fixed(WAVE, [])


def test_sensors_of_several_routes_stand_side_by_side():
    both = joined([fixed(WAVE, [3], "a"), fixed(WAVE, [5, 6], "b")])
    assert (both.name, both.sensors, both.points[7].tolist()) == ("a + b", 3, [3, 5, 6])
    assert not Route("a", np.zeros((2, 1), int)).points.flags.writeable
