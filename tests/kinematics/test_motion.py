"""A body that moves by known angles, seen by markers in any laboratory, has these angles; bad input is refused."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column
from hypothesis import given, settings
from hypothesis import strategies as st
from manufactured_body import (
    MEASURES,
    PLUG_IN_GAIT,
    RAJAGOPAL,
    SETS,
    Laboratory,
    body_frames,
    known_angles,
    markers_of,
    renamed,
    static_of,
    without,
)
from scipy.spatial.transform import Rotation
from texts import says

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.markers import WalkingFrame
from gaitdisc.kinematics.motion import angles_of_poses, choose_marker_set, motion, move_body
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinematics.segment_poses import carry_joint
from gaitdisc.recording import Recording

PIG_ENDS = ("ASI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE")
WALK = markers_of(known_angles(60), PLUG_IN_GAIT)
MIRRORED = Laboratory(np.diag([1.0, 1.0, -1.0]))


def laboratory(seed: int) -> Laboratory:
    """Any axis up, any direction of walking, the origin anywhere."""
    random = np.random.default_rng(seed)
    level = Rotation.from_euler("y", random.uniform(0, 360), degrees=True).as_matrix()
    upwards = [np.eye(3), Rotation.from_euler("x", 90, degrees=True).as_matrix(),
               Rotation.from_euler("z", -90, degrees=True).as_matrix()][seed % 3]  # fmt: skip
    return Laboratory(upwards @ level, random.normal(size=3))


def check_angles(angles: Recording, known: dict[str, np.ndarray], atol: float = 1e-9) -> None:
    for name, expected in known.items():
        np.testing.assert_allclose(angles[name], expected, atol=atol, err_msg=name)


@pytest.mark.parametrize("joints", ["free", "held"])
@pytest.mark.parametrize("name", SETS)
def test_known_angles_are_recovered_by_every_set(name, joints):
    known = known_angles(150)
    markers, static = markers_of(known, SETS[name]), static_of(SETS[name])
    check_angles(
        move_body(markers, static, replace(marker_set(name), joints=joints), MEASURES, (1, 0, 0)).angles, known
    )


@pytest.mark.parametrize("name", SETS)
def test_the_set_is_recognised_and_said(name):
    static = static_of(SETS[name])
    chosen = choose_marker_set(static, static)
    assert chosen.name == name
    found = motion(static, calibrate_body(static, chosen, MEASURES))
    assert found.calibration.marker_set.name == name
    assert any(finding.kind == "marker set" and finding.what.startswith(name) for finding in found.findings)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10_000))
def test_angles_do_not_depend_on_the_laboratory(seed):
    """The static trial may stand in another laboratory than the walk."""
    known = known_angles(150, seed)
    here, there = laboratory(seed), laboratory(seed + 1)
    markers = markers_of(known, PLUG_IN_GAIT, here)
    forward = here.axes @ [1, 0, 0]
    check_angles(move_body(markers, static_of(PLUG_IN_GAIT, there), None, MEASURES, tuple(forward)).angles, known)


@pytest.mark.parametrize("seed", range(3))
def test_the_direction_of_walking_is_found(seed):
    """The pelvis goes straight on, so forward is found exactly, and with it pelvis and foot progression."""
    known, here = known_angles(200, seed), laboratory(seed)
    found = move_body(markers_of(known, RAJAGOPAL, here), static_of(RAJAGOPAL), None).angles
    check_angles(found, known, 1e-6)


def test_poses_are_those_of_the_body():
    known, here = known_angles(60), laboratory(4)
    found = motion(markers_of(known, RAJAGOPAL, here), calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal")))
    for segment, (origin, rotation) in body_frames(known).items():
        np.testing.assert_allclose(found.poses[segment].rotation, here.axes @ rotation, atol=1e-9, err_msg=segment)
        expected = origin @ here.axes.T + here.origin
        np.testing.assert_allclose(found.poses[segment].origin, expected, atol=1e-9, err_msg=segment)
    for joint, segment in (("knee_l", "shank_l"), ("ankle_r", "foot_r")):
        centre = carry_joint(joint, found.poses, found.calibration)
        np.testing.assert_allclose(centre, found.poses[segment].origin, atol=1e-9)
    assert max(residual.max() for residual in found.residual_m.values()) < 1e-9


def test_foot_progression_is_the_way_the_toes_point():
    """Standing with the right foot turned out by 20 deg and the left one turned in by 5."""
    known = {name: np.zeros(150) for name in known_angles(2)}
    known["ankle_rotation_r"][:], known["ankle_rotation_l"][:] = -20.0, 5.0
    angles = move_body(markers_of(known, RAJAGOPAL), static_of(RAJAGOPAL), None).angles
    np.testing.assert_allclose(angles["foot_progression_angle_r"], -20.0, atol=1e-6)
    np.testing.assert_allclose(angles["foot_progression_angle_l"], 5.0, atol=1e-6)


def test_the_pelvis_is_followed_in_the_walker_s_frame():
    here = laboratory(1)
    angles = move_body(markers_of(known_angles(150), RAJAGOPAL, here), static_of(RAJAGOPAL), None).angles
    np.testing.assert_allclose(np.diff(angles["pelvis_tx"]), 0.013, atol=1e-8)
    up = here.axes @ [0, 1, 0]
    np.testing.assert_allclose(angles["pelvis_ty"] * up.sum(), 0.95 * up.sum() + here.origin @ up * up.sum(), atol=1e-8)


def test_missing_markers_are_bridged_and_counted():
    known = known_angles(150)
    markers = with_column(markers_of(known, RAJAGOPAL), "RTH2", np.nan, slice(20, 50))
    found = motion(markers, calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal")), (1, 0, 0))
    check_angles(found.angles, known)
    bridged = next(finding for finding in found.findings if finding.kind == "bridged")
    assert says(bridged.what, "thigh_r", "missing", "30 of 150 frames")
    np.testing.assert_allclose(bridged.spans, [(0.2, 0.5)])
    assert found.angles.suspect is not None
    marked = dict(zip(found.angles.names, found.angles.suspect.sum(axis=0), strict=True))
    assert (marked["hip_flexion_r"], marked["knee_angle_r"], marked["ankle_angle_r"], marked["knee_angle_l"]) == (
        30, 30, 0, 0)  # fmt: skip


def test_joints_carry_a_segment_that_has_lost_its_markers():
    """A shank whose knee and foot are known turns about no axis freely with one marker left."""
    known = known_angles(150)
    markers = markers_of(known, RAJAGOPAL)
    for label in ("RTB1", "RTB2", "RTB3"):
        markers = with_column(markers, label, np.nan, slice(60, 70))
    found = motion(markers, calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal")), (1, 0, 0))
    check_angles(found.angles, known, 1e-6)


@pytest.mark.parametrize("lost", ["LASI", "RASI"])
def test_a_marker_of_three_on_the_pelvis_is_bridged_by_the_legs(lost):
    """Plug-in Gait has three markers there; where one is missing, both hips carry the other two."""
    known = known_angles(150)
    markers = with_column(markers_of(known, PLUG_IN_GAIT), lost, np.nan, slice(20, 50))
    found = motion(markers, calibrate_body(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait"), MEASURES), (1, 0, 0))
    check_angles(found.angles, known, 1e-6)
    assert any(finding.kind == "bridged" and "30 of 150 frames" in finding.what for finding in found.findings)
    assert found.angles.suspect is not None
    assert set(found.angles.suspect.sum(axis=0)) == {0, 30}


def test_where_too_few_markers_are_left_the_angles_are_missing_and_said():
    known = known_angles(150)
    markers = with_column(markers_of(known, PLUG_IN_GAIT), "RTHI", np.nan, slice(20, 50))
    found = motion(markers, calibrate_body(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait"), MEASURES), (1, 0, 0))
    missing = {name: int(np.isnan(found.angles[name]).sum()) for name in found.angles.names}
    assert missing["knee_angle_r"] == missing["hip_flexion_r"] == 30
    assert missing["knee_angle_l"] == missing["pelvis_tilt"] == 0
    warning = next(finding for finding in found.findings if finding.kind == "gap")
    assert warning.severity == "warning"
    assert says(warning.what, "thigh_r", "unknown", "30 of 150 frames")


def test_a_static_trial_of_another_person_is_said():
    taller = {segment: {label: 1.2 * place for label, place in part.items()} for segment, part in RAJAGOPAL.items()}
    found = motion(markers_of(known_angles(60), RAJAGOPAL), calibrate_body(static_of(taller), marker_set("rajagopal")))
    said = [finding.what for finding in found.findings if finding.kind == "another shape"]
    assert says(said[0], "the static")
    same = motion(
        markers_of(known_angles(60), RAJAGOPAL), calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal"))
    )
    assert not [finding for finding in same.findings if finding.kind == "another shape"]


def test_an_ankle_apart_from_the_line_of_a_foot_that_rolls_is_said():
    known, swing = known_angles(150), np.arange(150) > 100
    roll = {**known, "ankle_rotation_r": np.full(150, -35.0), "ankle_inversion_r": 35.0 * swing}
    seen = [move_body(markers_of(one, PLUG_IN_GAIT), static_of(PLUG_IN_GAIT), None, MEASURES) for one in (known, roll)]
    plain, said = ([one for one in moved.findings if one.kind == "rolled foot"] for moved in seen)
    assert not plain and len(said) == 1
    assert says(said[0].what, "ankle_angle_r", "deg from the line from heel to toe")


EXCHANGED = {f"{side}{end}": f"{other}{end}" for side, other in ("LR", "RL") for end in PIG_ENDS}


@pytest.mark.parametrize(
    ("markers", "error", "words"),
    [
        (markers_of(known_angles(60), PLUG_IN_GAIT, MIRRORED), ShapeError, r"walk\.c3d.*left.*right"),
        (renamed(WALK, EXCHANGED), ShapeError, "left and right are exchanged"),
        (without(WALK, "RTHI"), ChannelError, r"thigh_r.*3 points.*walk\.c3d.*RKNE.*missing: RTHI"),
    ],
    ids=["mirrored", "sides exchanged", "a marker less"],
)
def test_markers_that_do_not_fit_the_static_trial_are_refused(markers, error, words):
    calibration = calibrate_body(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait"), MEASURES)
    with pytest.raises(error, match=words):
        motion(markers, calibration)


STRANGE = renamed(WALK, {"RTHI": "Q1", "LKNE": "Q2"})
ANGLES = move_body(markers_of(known_angles(60), RAJAGOPAL), static_of(RAJAGOPAL)).angles


@pytest.mark.parametrize(
    ("markers", "static", "given_set", "words"),
    [
        (WALK, None, None, r"a static trial .*must be given; none"),
        (WALK, None, "rajagopal", r"a static trial .*must be given; none"),
        (STRANGE, STRANGE, None, r"plug_in_gait.*LKNE, RTHI"),
        (static_of(PLUG_IN_GAIT), static_of(PLUG_IN_GAIT), "gait2354", r"gait2354; static\.c3d.*no L\.ASIS.*1"),
        (
            ANGLES,
            replace(ANGLES, source=static_of(RAJAGOPAL).source),
            None,
            r"<marker>\.x.*static\.c3d has pelvis_tilt",
        ),
    ],
    ids=["no static trial", "nor with a set", "labels of no set", "markers of another set", "angles"],
)
def test_without_the_markers_of_one_set_in_both_trials_a_body_is_not_followed(markers, static, given_set, words):
    with pytest.raises(ChannelError, match=words):
        move_body(markers, static, given_set, MEASURES)


def test_a_plane_in_which_nobody_walks_is_refused():
    with pytest.raises(ShapeError, match=r"40 mm.*no such frame.*joints = \"free\""):
        move_body(WALK, static_of(PLUG_IN_GAIT), "plug_in_gait", MEASURES, (0, 0, 1), "planar")


@pytest.fixture(scope="module")
def person(gait_data):
    with C3DReader() as reader:
        path = gait_data / "young_static" / "HC030A" / "HC030A01.c3d"
        static = read_trial(path, reader=reader)
        walk = read_trial(gait_data / "young_straight_and_turn/HC030A/straight/HC030A05.c3d", reader=reader)
        calibration = calibrate_body(static.stream("markers"), marker_set("plug_in_gait"), read_body_measures(path))
        return static, walk, calibration


def test_a_real_walk_has_the_angles_that_the_laboratory_computed(person):
    """Plug-in Gait's own angles stand in the file; after the difference of the static trial, sagittal rms <= 2 deg."""
    static, walk, calibration = person
    moving, still = (motion(trial.stream("markers"), calibration).angles for trial in (walk, static))
    theirs, theirs_still = walk.stream("kinematics"), static.stream("kinematics")
    for side in "rl":
        for joint, most in (("hip_flexion", 2), ("knee_angle", 2), ("ankle_angle", 2), ("hip_adduction", 4),
                            ("knee_adduction", 4), ("hip_rotation", 4), ("knee_rotation", 4)):  # fmt: skip
            name = f"{joint}_{side}"
            offset = np.median(still[name] - theirs_still[name])
            rms = np.sqrt(np.mean((moving[name] - theirs[name] - offset) ** 2))
            assert rms <= most, f"{name} {rms:.2f} deg"


def test_pelvis_and_feet_of_a_real_walk_have_the_signs_of_the_package(person):
    """Tilt backwards is positive where Plug-in Gait has forwards; list is right side down, its left obliquity."""
    _, walk, calibration = person
    found, theirs = motion(walk.stream("markers"), calibration, (0, 1, 0)).angles, walk.stream("kinematics")
    for ours, label, sign in (("pelvis_tilt", "RPelvisAngles.x", -1), ("pelvis_list", "LPelvisAngles.y", 1),
                              ("pelvis_rotation", "RPelvisAngles.z", 1)):  # fmt: skip
        np.testing.assert_allclose(found[ours], sign * theirs[label], atol=1.0, err_msg=ours)
    for side in "rl":
        for ours, label in ((f"foot_progression_angle_{side}", "FootProgressAngles.z"),
                            (f"ankle_rotation_{side}", "AnkleAngles.z")):  # fmt: skip
            other = theirs[f"{side.upper()}{label}"]
            assert np.corrcoef(found[ours], other)[0, 1] > 0.8, ours
            assert np.sqrt(np.mean((found[ours] - other) ** 2)) < 4.0, ours


def test_a_real_walk_in_another_laboratory_s_frame_has_the_same_angles(person):
    """y up in place of z, the walkway askew by 37 deg, the origin elsewhere; neither up nor forward is given."""
    _, walk, calibration = person
    turned = Rotation.from_euler("xy", [-90, 37], degrees=True).as_matrix()
    markers = walk.stream("markers")
    places = markers.values.reshape(len(markers.time), -1, 3) @ turned.T + np.array([0.3, -0.2, 1.0])
    elsewhere = markers.with_values(places.reshape(markers.values.shape))
    here, there = (motion(one, calibration).angles for one in (markers, elsewhere))
    for name in here.names[:-3]:
        np.testing.assert_allclose(there[name], here[name], atol=1e-6, err_msg=name)


def test_a_real_static_trial_of_another_person_is_said(person, gait_data):
    _, walk, own = person
    path = gait_data / "young_static" / "HC031A" / "HC031A01.c3d"
    other = calibrate_body(read_trial(path).stream("markers"), marker_set("plug_in_gait"), read_body_measures(path))
    kinds = ("another shape", "exchanged markers", "broken segment")
    assert not [one for one in motion(walk.stream("markers"), own).findings if one.kind in kinds]
    with pytest.raises(ShapeError, match=r"HC030A05\.c3d.*197 of 197"):
        motion(walk.stream("markers"), other)


def test_pelvis_list_is_that_of_opensim(gait_data):
    """The right side down is positive: height of the right spine over the left one against OpenSim's own angle."""
    folder = gait_data / "opensim_walks" / "mrs_emg_walking"
    markers, angles = (read_trial(folder / name) for name in ("TRC_gait.trc", "IK_gait.mot"))
    markers, angles = markers.stream("markers"), angles.stream("kinematics")
    higher = markers["RASI.y"] - markers["LASI.y"]
    list_deg = np.interp(markers.time, angles.time, angles["pelvis_list"])
    walking = (markers.time > 1.06) & (markers.time < 3.23)  # the part of the file that its inverse dynamics covers
    assert np.corrcoef(higher[walking], list_deg[walking])[0, 1] < -0.9
    assert says(vocabulary().positive["pelvis_list"], "right", "down")


def test_left_and_right_have_one_sign_in_a_walk_of_unlike_legs():
    """Legs of exchanged angles give exchanged angles: no sign belongs to a side."""
    known = known_angles(60)
    other = {f"{name[:-1]}{'l' if name[-1] == 'r' else 'r'}" if name[-2] == "_" else name: each
             for name, each in known.items()}  # fmt: skip
    calibration = calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal"), MEASURES)
    found, exchanged = (motion(markers_of(one, RAJAGOPAL), calibration, (1, 0, 0)).angles for one in (known, other))
    for name in known:
        if name[-2] == "_":
            mirror = f"{name[:-1]}{'l' if name[-1] == 'r' else 'r'}"
            np.testing.assert_allclose(exchanged[mirror], found[name], atol=1e-6, err_msg=name)
            assert not np.allclose(found[mirror], found[name], atol=1.0), name


def test_hip_rotation_has_opensim_s_sign_on_both_sides(gait_data):
    """Against OpenSim's inverse kinematics, whose knee has no rotation: r 0.50 right, 0.73 left; mirrored it were -."""
    folder = gait_data / "opensim_walks" / "mrs_emg_walking"
    markers, angles = (read_trial(folder / name) for name in ("TRC_gait.trc", "IK_gait.mot"))
    markers, angles = markers.stream("markers"), angles.stream("kinematics")
    feet = {"foot_l1": "LHEE", "foot_l6": "LTOE", "Foot_r1": "RHEE", "Foot_r6": "RTOE"}
    markers = renamed(markers, feet)

    def between(start, end):
        some = (markers.time >= start) & (markers.time <= end)
        return replace(markers, time=markers.time[some], values=markers.values[some], suspect=None)

    found = move_body(between(1.06, 3.23), between(1.995, 2.015), "rajagopal", joints="free").angles
    for side in "lr":
        theirs = np.interp(found.time, angles.time, angles[f"hip_rotation_{side}"])
        assert np.corrcoef(found[f"hip_rotation_{side}"], theirs)[0, 1] > 0.4


def test_the_place_in_a_turn_is_the_path_walked_wherever_the_laboratory_has_its_origin():
    """On a circle the walker goes forward by the arc and never aside; seen from 5 m away nothing leaps."""
    time, radius, speed = np.arange(400) / 100, 3.0, 1.2
    angle = speed * time / radius
    ahead = np.column_stack([np.cos(angle), 0 * angle, -np.sin(angle)])
    aside = np.column_stack([np.sin(angle), 0 * angle, np.cos(angle)])
    rotation = np.stack([ahead, np.tile([0.0, 1.0, 0.0], (400, 1)), aside], axis=2)
    origin = np.array([5.0, 1.0, -4.0]) + radius * aside
    origin[150:160] = np.nan
    still = {f"{part}_{side}": Pose(origin, rotation) for part in ("thigh", "shank", "foot") for side in "lr"}
    poses = {"pelvis": Pose(origin, rotation), **still}
    base = Recording(time, np.zeros((400, 1)), (Channel("a", "signal", "1"),))
    doubt = {name: np.zeros(400, bool) for name in poses}
    found = angles_of_poses(base, poses, doubt, WalkingFrame(rotation, ""))
    known = np.isfinite(found["pelvis_tx"])
    assert list(np.flatnonzero(~known)) == list(range(150, 160))
    assert np.abs(found["pelvis_tx"] - found["pelvis_tx"][0] - speed * time)[known].max() < 0.01
    assert np.ptp(found["pelvis_tz"][known]) < 0.01
    assert found["pelvis_ty"][known] == pytest.approx(1.0)
