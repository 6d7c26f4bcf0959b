"""Joint moments of segments with published inertia."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitdisc.errors import SamplingError, SchemaError, ShapeError, UnitError
from gaitdisc.kinematics.pose import JOINT_CHANNELS, Pose
from gaitdisc.kinetics.body_inertia import Person, inertia_table, leg_inertia, segment_lengths
from gaitdisc.kinetics.joint_moments import FootLoad, KineticsSettings, along, joint_axes, joint_moments, legs
from gaitdisc.kinetics.newton_euler import GRAVITY, joint_wrenches, segment_motion
from gaitdisc.kinetics.plate_steps import FootPath
from gaitdisc.kinetics.platform import Wrench
from gaitdisc.signals.derivatives import derivative

TIME = np.arange(120) / 100
PERSON = Person(70.0, "m")
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


@pytest.mark.parametrize("settings", [RAW, KineticsSettings(frame="distal")])
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
    twice = moments_of((poses, paths, ground + ground, up), person=Person(140.0, "m"))
    assert twice.values[2:-2] == pytest.approx(moments_of(walker()).values[2:-2], abs=1e-12)


def test_powers_do_the_work_that_changes_the_energy():
    """Power of all joints and of the pelvis and the ground on the leg is the rate of the leg's energy."""
    poses, paths, ground, up = walker()
    found = legs(poses, paths, PERSON, RAW)["r"]
    energy = 0.0
    for segment, body in found.bodies.items():
        moving = found.moving[segment]
        centre = moving.pose.to_laboratory(body.centre)
        velocity = derivative(centre, 100.0)
        tensor = moving.pose.rotation @ body.tensor @ np.swapaxes(moving.pose.rotation, 1, 2)
        spin = moving.angular_velocity
        energy = energy + body.mass_kg * (0.5 * (velocity**2).sum(1) + GRAVITY * centre @ up)
        energy = energy + 0.5 * np.einsum("fi,fij,fj->f", spin, tensor, spin)
    gained = derivative(energy[:, None], 100.0)[:, 0]
    carried = joint_wrenches(list(found.needed(up).values()), ground)
    recording = moments_of((poses, paths, ground, up))
    joints = 70.0 * sum(recording[f"{joint}_power_r"] for joint in ("ankle", "knee", "hip"))
    # at the hip the trunk also moves the leg: force times hip velocity and moment times the pelvis' turning
    hip, foot = poses["thigh_r"].origin, found.moving["foot"]
    on_hip = np.einsum("fx,fx->f", carried[2].force, derivative(hip, 100.0))
    on_hip += np.einsum("fx,fx->f", carried[2].about(hip), found.moving["pelvis"].angular_velocity)
    on_foot = np.einsum("fx,fx->f", ground.force, derivative(foot.pose.origin, 100.0))
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
    with pytest.raises(ShapeError, match=r"a frame must have .* foot_r.*no"):
        legs(poses, {"r": blind}, PERSON, RAW)


def test_settings_that_cannot_be_are_refused():
    with pytest.raises(SamplingError, match=r"force_cutoff_hz.*0 Hz"):
        KineticsSettings(force_cutoff_hz=0.0)
    with pytest.raises(SchemaError, match="'global'"):
        KineticsSettings(frame="global")


LENGTHS = {"shank": 0.42, "thigh": 0.41}
TOE = np.array([0.13, -0.06, 0.0])


# Sums of the columns that the papers print, rounding included
@pytest.mark.parametrize(("sex", "total"), [("f", 99.9), ("m", 100.2)])
def test_the_segments_of_the_table_make_a_whole_body(sex, total):
    rows = inertia_table(sex)
    assert (rows.mass * rows.whole).sum() == pytest.approx(total, abs=1e-9)


@pytest.mark.parametrize("sex", ["f", "m", ""])
def test_a_leg_is_a_body_of_positive_inertia_and_the_other_its_mirror(sex):
    person = Person(70.0, sex)
    right, left = (leg_inertia(person, side, LENGTHS, TOE) for side in "rl")
    mirror = np.diag([1.0, 1.0, -1.0])
    for segment, body in right.items():
        one, two, three = np.linalg.eigvalsh(body.tensor)
        assert one > 0 and one + two > three, segment  # what any distribution of mass fulfils
        assert left[segment].mass_kg == body.mass_kg
        assert left[segment].centre == pytest.approx(mirror @ body.centre)
        assert left[segment].tensor == pytest.approx(mirror @ body.tensor @ mirror)


def test_numbers_of_the_tables():
    thigh = leg_inertia(Person(70.0, "m"), "r", LENGTHS, TOE)["thigh"]
    assert thigh.mass_kg == pytest.approx(0.123 * 70)
    assert thigh.centre == pytest.approx(0.41 * np.array([-0.041, -0.429, 0.033]))
    assert np.sqrt(np.diag(thigh.tensor) / thigh.mass_kg) == pytest.approx(0.41 * np.array([0.29, 0.15, 0.30]))


def test_an_unknown_sex_takes_the_mean():
    masses = [leg_inertia(Person(60.0, sex), "r", LENGTHS, TOE)["thigh"].mass_kg for sex in ("f", "m", "")]
    assert masses[2] == pytest.approx((masses[0] + masses[1]) / 2)


@pytest.mark.parametrize("mass", [0.7, 700.0, -60.0])
def test_a_mass_that_is_no_persons_is_refused(mass):
    with pytest.raises(UnitError, match=rf"mass.*5.*300 kg.*{mass:g} kg"):
        Person(mass)


@pytest.mark.parametrize("mass", [None, np.nan])
def test_a_person_without_mass_is_refused(mass):
    with pytest.raises(UnitError, match=r"mass.*PROCESSING:BODYMASS"):
        Person(mass)


def test_what_fits_no_leg_is_refused():
    with pytest.raises(SchemaError, match=r"'f'.*'m'.*it is.*'w'"):
        Person(60.0, "w")
    with pytest.raises(UnitError, match=r"thigh.*0.1.*0.8 m.*thigh_r.*410 m"):
        leg_inertia(Person(60.0), "r", {"shank": 0.4, "thigh": 410.0}, TOE)


def test_lengths_are_those_between_joint_centres():
    turned = np.tile(np.eye(3), (20, 1, 1))
    at = {name: Pose(np.tile(place, (20, 1)), turned) for name, place in
          {"thigh_r": [0.0, 0.9, 0], "shank_r": [0.0, 0.5, 0], "foot_r": [0.3, 0.1, 0]}.items()}  # fmt: skip
    assert segment_lengths(at, "r") == pytest.approx({"thigh": 0.4, "shank": 0.5})
    with pytest.raises(ShapeError, match=r"shank_l.*shank_l.*foot_l"):
        segment_lengths(at, "l")
    grows = np.column_stack([np.linspace(0.3, 0.6, 20), np.full(20, 0.1), np.zeros(20)])
    with pytest.raises(ShapeError, match=r"shank_r.*0\.50\d.*0\.7\d\d m"):
        segment_lengths({**at, "foot_r": Pose(grows, turned)}, "r")


TURNING = np.arange(200) / 100


def pose(rotation):
    return Pose(np.zeros((len(rotation), 3)), rotation)


def relative(angles, sign):
    """Grood & Suntay: flexion about the nearer z, adduction about the floating x, rotation about the farther y."""
    flexion, adduction, rotation = angles
    turns = np.stack([flexion, sign * adduction, sign * rotation], axis=1)
    return Rotation.from_euler("ZXY", turns).as_matrix()


@pytest.mark.parametrize(("side", "sign"), [("r", 1), ("l", -1)])
def test_the_parts_of_a_moment_times_the_rates_of_the_angles_are_the_power(side, sign):
    angles = [0.5 * np.sin(4 * TURNING), 0.2 + 0.2 * np.cos(3 * TURNING), -0.3 * np.sin(2 * TURNING + 1)]
    rates = [2.0 * np.cos(4 * TURNING), -0.6 * np.sin(3 * TURNING), -0.6 * np.cos(2 * TURNING + 1)]
    nearer = Rotation.from_rotvec(np.outer(np.sin(TURNING), [0.3, -0.2, 0.5])).as_matrix()
    near, far = pose(nearer), pose(nearer @ relative(angles, sign))
    turning = segment_motion(far, 100.0).angular_velocity - segment_motion(near, 100.0).angular_velocity
    moment = np.random.default_rng(5).normal(size=(len(TURNING), 3))
    power = np.einsum("fx,fx->f", moment, turning)
    axes = joint_axes(near, far)
    by_parts = (along(moment, axes, "hip", side) * np.stack(rates, axis=1)).sum(axis=1)
    assert by_parts[3:-3] == pytest.approx(power[3:-3], abs=1e-4)
    assert np.abs(power[3:-3]).max() > 1


def test_positive_is_the_movement_that_the_moment_makes():
    """A moment turns the farther segment: its lower end goes forwards, to the middle, its front inwards."""
    straight = pose(np.eye(3)[None])
    axes = joint_axes(straight, straight)
    down, front = np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    cases = {"hip_flexion": (down, [1, 0, 0]), "hip_adduction": (down, None), "hip_rotation": (front, None)}
    cases |= {"knee_angle": (down, [-1, 0, 0]), "ankle_angle": (front, [0, 1, 0]), "ankle_inversion": (down, None)}
    for side, inwards in (("r", [0, 0, -1]), ("l", [0, 0, 1])):
        for name, (end, goes) in cases.items():
            joint = name.split("_")[0]
            at = JOINT_CHANNELS[joint][0].index(name)
            moment = next(
                m for m in np.vstack([np.eye(3), -np.eye(3)]) if along(m[None], axes, joint, side)[0, at] > 0.5
            )
            assert np.cross(moment, end) == pytest.approx(np.array(goes or inwards)), (side, name)


def test_axes_on_one_line_have_no_parts():
    locked = pose(Rotation.from_euler("x", [[np.pi / 2]]).as_matrix().reshape(1, 3, 3))
    assert np.isnan(joint_axes(pose(np.eye(3)[None]), locked)[0, 1]).all()
