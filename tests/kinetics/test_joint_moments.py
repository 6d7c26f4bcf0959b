import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitdisc.errors import SamplingError, SchemaError, ShapeError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.foot_loads import FootLoad
from gaitdisc.kinetics.joint_moments import KineticsSettings, joint_moments, legs
from gaitdisc.kinetics.newton_euler import GRAVITY, joint_wrenches
from gaitdisc.kinetics.plate_steps import FootPath
from gaitdisc.kinetics.wrench import Wrench
from gaitdisc.signals.derivatives import differentiated

TIME = np.arange(120) / 100
PERSON = Person(70.0, "m", 1.75)
RAW = KineticsSettings(np.inf, np.inf)


def walker(turn=None, shift=0.0):
    """Right leg that swings in three planes over a force that moves; y up, x forward; or in another laboratory."""
    s = np.sin(2 * np.pi * TIME)
    c = np.cos(2 * np.pi * TIME)

    def turns(*angles):
        return Rotation.from_euler("ZXY", np.stack(angles, 1)).as_matrix()

    pelvis = turns(0.05 * s, 0.05 * c, 0.1 * s)
    thigh = turns(0.4 * s, 0.1 * c, 0.05 * s)
    shank = turns(0.4 * s - 0.3 + 0.2 * c, 0.1 * c, 0.1 * s)
    foot = turns(0.2 * s, 0.05 * c, 0.1 * s)
    hip = np.stack([1.2 * TIME, 0.9 + 0.02 * c, 0.1 + 0 * s], 1)
    knee = hip + thigh @ [0.0, -0.41, 0.0]
    ankle = knee + shank @ [0.0, -0.42, 0.0]
    poses = {"pelvis": Pose(hip - [0, 0, 0.1], pelvis), "thigh_r": Pose(hip, thigh), "shank_r": Pose(knee, shank)}
    poses["foot_r"] = Pose(ankle, foot)
    place = np.stack([ankle[:, 0] + 0.1 * s, 0 * s, ankle[:, 2]], 1)
    ground = Wrench.at(place, np.stack([80 * s, 500 + 200 * c, 20 * s], 1), np.outer(3 * c, [0, 1, 0]))
    heel, toe = (poses["foot_r"].to_laboratory(np.array(p)) for p in ([-0.05, -0.07, 0.0], [0.13, -0.06, 0.01]))
    turn = np.eye(3) if turn is None else turn
    poses = {name: Pose(p.origin @ turn.T + shift, turn @ p.rotation) for name, p in poses.items()}
    moved = Wrench.at(place @ turn.T + shift, ground.force @ turn.T, np.outer(3 * c, [0, 1, 0]) @ turn.T)
    path = FootPath("r", TIME, heel @ turn.T + shift, toe @ turn.T + shift)
    return poses, {"r": path}, moved, turn @ [0.0, 1.0, 0.0]


def moments_of(walk, settings=RAW, person=PERSON, known=True):
    poses, paths, ground, up = walk
    found = legs(poses, paths, person, settings)
    load = FootLoad(ground, np.full(len(TIME), known) if isinstance(known, bool) else known)
    return joint_moments(found, {"r": load}, TIME, up, person, settings)


@pytest.mark.parametrize("settings", [RAW, KineticsSettings(frame="distal"), KineticsSettings(inertia="deleva1996")])
def test_moments_and_powers_are_the_same_in_every_laboratory(settings):
    here = moments_of(walker(), settings)
    turn = Rotation.random(random_state=4).as_matrix()
    there = moments_of(walker(turn, np.array([5.0, -2.0, 1.0])), settings)
    inner = slice(2, -2)
    assert there.values[inner] == pytest.approx(here.values[inner], abs=1e-8)
    assert np.isfinite(here.values[inner]).all()
    assert {channel.unit for channel in here.channels} == {"N m/kg", "W/kg"}


def test_the_ankle_holds_a_force_ahead_of_it_with_the_calf():
    """At push-off the plantarflexors work: negative, as dorsiflexion is the positive angle."""
    poses, paths, _, up = walker()
    ahead = Wrench.at(poses["foot_r"].origin * [1, 0, 1] + [0.12, 0.0, 0.0], np.tile(700 * up, (len(TIME), 1)))
    found = moments_of((poses, paths, ahead, up))
    assert found["ankle_angle_r_moment"][2:-2] == pytest.approx(-0.12 * 700 / 70, abs=0.1)


def test_kinetics_per_kg_do_not_change_when_mass_and_force_grow_alike():
    poses, paths, ground, up = walker()
    twice = moments_of((poses, paths, ground + ground, up), person=Person(140.0, "m", 1.75))
    assert twice.values[2:-2] == pytest.approx(moments_of(walker()).values[2:-2], abs=1e-12)


def test_powers_do_the_work_that_changes_the_energy():
    """Power of all joints and of the pelvis and the ground on the leg is the rate of the leg's energy."""
    poses, paths, ground, up = walker()
    found = legs(poses, paths, PERSON, RAW)["r"]
    chain = [(found.moving[s], found.bodies[s]) for s in ("foot", "shank", "thigh")]
    energy = 0.0
    for moving, body in chain:
        centre = moving.pose.to_laboratory(body.centre)
        velocity = differentiated(centre, 100.0)
        tensor = moving.pose.rotation @ body.tensor @ np.swapaxes(moving.pose.rotation, 1, 2)
        spin = moving.angular_velocity
        energy = energy + body.mass_kg * (0.5 * (velocity**2).sum(1) + GRAVITY * centre @ up)
        energy = energy + 0.5 * np.einsum("fi,fij,fj->f", spin, tensor, spin)
    gained = differentiated(energy[:, None], 100.0)[:, 0]
    carried = joint_wrenches(chain, ground, up)
    recording = moments_of((poses, paths, ground, up))
    joints = 70.0 * sum(recording[f"{joint}_power_r"] for joint in ("ankle", "knee", "hip"))
    # at the hip the trunk also moves the leg: force times hip velocity and moment times the pelvis' turning
    hip, foot = poses["thigh_r"].origin, found.moving["foot"]
    on_hip = np.einsum("fx,fx->f", carried[2].force, differentiated(hip, 100.0))
    on_hip += np.einsum("fx,fx->f", carried[2].about(hip), found.moving["pelvis"].angular_velocity)
    on_foot = np.einsum("fx,fx->f", ground.force, differentiated(foot.pose.origin, 100.0))
    on_foot += np.einsum("fx,fx->f", ground.about(foot.pose.origin), foot.angular_velocity)
    inner = slice(6, -6)
    assert (joints + on_hip + on_foot)[inner] == pytest.approx(gained[inner], abs=0.02 * np.nanmax(np.abs(gained)))


def test_no_moment_where_the_load_is_unknown():
    known = TIME < 0.5
    found = moments_of(walker(), known=known)
    assert np.isnan(found.values[~known]).all() and np.isfinite(found.values[2:50]).all()


def test_a_leg_without_a_segment_is_left_out():
    poses, paths, _, _ = walker()
    del poses["shank_r"]
    assert legs(poses, paths, PERSON, RAW) == {}


def test_a_foot_without_its_heel_is_refused():
    poses, paths, _, _ = walker()
    blind = FootPath("r", TIME, np.full((len(TIME), 3), np.nan), paths["r"].toe)
    with pytest.raises(ShapeError, match=r"foot_r needs a frame.*no"):
        legs(poses, {"r": blind}, PERSON, RAW)


def test_settings_that_cannot_be_are_refused():
    with pytest.raises(SamplingError, match=r"force_cutoff_hz.*0 Hz"):
        KineticsSettings(force_cutoff_hz=0.0)
    with pytest.raises(SchemaError, match="dumas2007, deleva1996; 'winter'"):
        KineticsSettings(inertia="winter")
    with pytest.raises(SchemaError, match="of joint, distal; 'global'"):
        KineticsSettings(frame="global")
