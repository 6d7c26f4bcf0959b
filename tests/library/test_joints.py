"""Joint angles and moments of a real walk, as the commands give them."""

import numpy as np
import pytest

import gaitdisc as gd
from gaitdisc.errors import GaitdiscError
from gaitdisc.kinematics.motion import joint_angles


@pytest.fixture(scope="module")
def files(gait_data):
    walks = sorted((gait_data / "young_straight_and_turn" / "HC030A").rglob("*.c3d"))
    statics = sorted((gait_data / "young_static" / "HC030A").rglob("*.c3d"))
    if not walks or not statics:
        pytest.skip("no walk of HC030A with its static trial")
    return walks[0], statics[0]


def test_angles_are_those_of_the_room_below(files):
    from gaitdisc.ingest.c3d_kinetics import read_body_measures

    walk, static = files
    trial, standing = gd.read(walk), gd.read(static)
    found = gd.angles(trial, static)
    below = joint_angles(trial.stream("markers"), standing.stream("markers"), measures=read_body_measures(static))
    np.testing.assert_array_equal(found.values, below.values)
    assert found.channels == below.channels and "knee_angle_r" in found.names


def test_moments_come_with_a_mass_and_are_refused_without_forces(files):
    walk, static = files
    trial = gd.read(walk)
    if "forces" in trial.streams:
        found = gd.moments(trial, static, mass_kg=45.8)  # of HC030A; 70 kg contradict the plates
        assert {"N m/kg", "W/kg"} <= {channel.unit for channel in found.channels}
    bare = gd.Trial("bare", {"markers": trial.stream("markers")})
    with pytest.raises(GaitdiscError, match="forces"):
        gd.moments(bare, static, mass_kg=70.0)
