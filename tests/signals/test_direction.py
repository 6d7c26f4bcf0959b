import numpy as np
import pytest
from changed_trials import markers_at, with_column

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.signals.direction import marker_position, pelvis_position, state_direction, walking_direction

HEELS, PELVIS = {"r": "RHEE", "l": "LHEE"}, ("SACR",)


def walker(forward, up=(0.0, 0.0, 1.0), speed=0.0):
    """Heels go back for 62 % of the stride and forward for 38 %; speed 0 is a treadmill."""
    t = np.arange(1000) / 100
    forward, up = np.asarray(forward, float), np.asarray(up, float)
    parts = {"SACR": speed * t[:, None] * forward + 0.9 * up}
    for side, late in (("R", 0.0), ("L", 0.5)):
        phase = (t + late) % 1.0
        ahead = np.where(phase < 0.62, 0.3 - 0.6 * phase / 0.62, -0.3 + 0.6 * (phase - 0.62) / 0.38)
        parts[f"{side}HEE"] = (speed * t + ahead)[:, None] * forward + 0.05 * up
    return markers_at(t, parts)


def turning(turn_deg):
    """Ten seconds at 1.2 m/s that turn between the fourth and the sixth; and the heading, (time, 2)."""
    straight = walker((1, 0, 0))
    t = straight.time
    angle = np.radians(turn_deg) * np.clip((t - 4) / 2, 0, 1)
    heading = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    path = np.cumsum(1.2 / 100 * heading, axis=0)
    values = straight.values.copy()
    for name in ("SACR", "RHEE", "LHEE"):
        x = straight.index(f"{name}.x")
        values[:, [x, x + 1]] = path + straight.values[:, [x]] * heading
    return straight.with_values(values), heading


@pytest.mark.parametrize("speed", [0.0, 1.2])
@pytest.mark.parametrize("forward", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0.6, 0.8, 0)])
def test_the_direction_is_found_on_a_treadmill_and_over_ground(forward, speed):
    found = walking_direction(walker(forward, speed=speed), HEELS, PELVIS)
    assert found.forward @ np.array(forward) > 0.999
    assert found.up.tolist() == [0, 0, 1]
    said = "path of the pelvis" if speed else "inferred: heels"
    assert said in found.how


@pytest.mark.parametrize("turn_deg", [90.0, -180.0])
def test_forward_turns_with_the_path(turn_deg):
    walk, heading = turning(turn_deg)
    found = walking_direction(walk, HEELS, PELVIS)
    assert found.headings is not None
    off = np.degrees(np.arccos(np.clip(np.sum(found.headings[:, :2] * heading, axis=1), -1, 1)))
    assert off.max() < 12  # at the corners of a turn that begins at once
    assert off[(walk.time < 3.5) | (walk.time > 6.5)].max() < 0.1
    assert f"turns by {abs(turn_deg):.0f} deg" in found.how


def test_the_direction_is_held_where_the_person_stands():
    walk = walker((1, 0, 0), speed=1.2)
    values = walk.values.copy()
    values[800:] = values[800]
    found = walking_direction(walk.with_values(values), HEELS, PELVIS)
    assert found.headings is not None
    assert found.headings[-1] @ [1, 0, 0] > 0.999


def test_markers_that_are_never_there_are_named():
    walk = walker((1, 0, 0))
    with pytest.raises(StrideError, match=r"RHEE, LHEE.*SACR"):
        walking_direction(with_column(walk, "SACR.x", np.nan), HEELS, PELVIS)


def test_the_vertical_need_not_be_z():
    found = walking_direction(walker((1, 0, 0), (0, 1, 0)), HEELS, PELVIS)
    assert found.up.tolist() == [0, 1, 0]


def test_a_swing_without_a_direction_is_refused():
    t = np.arange(1000) / 100
    still = walker((1, 0, 0))
    swing = 0.3 * np.sin(2 * np.pi * t)
    even = with_column(with_column(still, "RHEE.x", swing), "LHEE.x", -swing)
    with pytest.raises(StrideError, match=r"0\.2.*[+-]0\.0"):
        walking_direction(even, HEELS, PELVIS)


def test_a_given_direction_is_made_a_unit_vector():
    assert state_direction((0, -3, 0)).forward.tolist() == [0, -1, 0]
    with pytest.raises(StrideError, match="perpendicular and not"):
        state_direction((0, 0, 1))


def test_positions_and_names():
    walk = walker((1, 0, 0))
    assert marker_position(walk, "SACR").shape == (1000, 3)
    assert pelvis_position(walk, ["SACR", "SACR"])[0].tolist() == [0, 0, 0.9]
    with pytest.raises(ChannelError, match=r"nearest is 'RHEE\.x'"):
        marker_position(walk, "RHEEL")
    with pytest.raises(ChannelError, match="pelvis marker is required"):
        pelvis_position(walk, [])
