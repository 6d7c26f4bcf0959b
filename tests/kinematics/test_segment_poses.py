"""Segments through a trial: each over its own points, held together at joints, carried over gaps; their angles."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column
from manufactured_body import (
    MEASURES,
    PLUG_IN_GAIT,
    RAJAGOPAL,
    body_frames,
    known_angles,
    markers_of,
    static_of,
    without,
)
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.motion import Motion, motion, move_body, segment_angles
from gaitdisc.kinematics.pose import SEGMENTS, Pose
from gaitdisc.kinematics.segment_poses import (
    carry_joint,
    carry_over,
    free_poses,
    join_poses,
    name_places,
    place_markers,
)
from gaitdisc.recording import Recording, Source

KNOWN = known_angles(40)
WALKER = np.tile(np.eye(3), (40, 1, 1))


def test_markers_that_the_static_trial_lacks_are_not_followed():
    calibration = calibrate_body(without(static_of(RAJAGOPAL), "RTH3"), marker_set("rajagopal"))
    body, places = place_markers(name_places(markers_of(KNOWN, RAJAGOPAL), calibration), calibration)["thigh_r"]
    assert (body.shape, places.shape) == ((3, 3), (40, 3, 3))


def test_too_few_points_in_the_trial_are_refused():
    calibration = calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal"))
    markers = without(markers_of(KNOWN, RAJAGOPAL), "LTB1", "LTB2")
    with pytest.raises(ChannelError, match=r"shank_l.*3 points.*LTB3, LLMAL.*missing: LTB1, LTB2"):
        place_markers(name_places(markers, calibration), calibration, markers.source.file)


@pytest.mark.parametrize("joints", ["free", "held"])
def test_the_chain_from_the_pelvis_down_is_that_of_the_body(joints):
    calibration = calibrate_body(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait").with_joints(joints), MEASURES)
    placed = place_markers(name_places(markers_of(KNOWN, PLUG_IN_GAIT), calibration), calibration)
    poses = join_poses(free_poses(placed, calibration), placed, calibration, WALKER)
    for segment, (origin, rotation) in body_frames(KNOWN).items():
        np.testing.assert_allclose(poses[segment].origin, origin, atol=1e-9, err_msg=segment)
        np.testing.assert_allclose(poses[segment].rotation, rotation, atol=1e-9, err_msg=segment)
    np.testing.assert_allclose(carry_joint("ankle_l", poses, calibration), poses["foot_l"].origin, atol=1e-9)


FRAMES, GAP = 60, slice(20, 40)


def swinging(offset_deg: float = 0.0, shift_m: float = 0.0) -> Pose:
    angle = 20 * np.sin(np.arange(FRAMES) / 10) + offset_deg
    origin = np.stack([np.arange(FRAMES) / 100, np.zeros(FRAMES) + shift_m, np.zeros(FRAMES)], axis=1)
    return Pose(origin, Rotation.from_euler("z", angle[:, None], degrees=True).as_matrix())


def with_gap(pose: Pose, gap: slice) -> Pose:
    origin, rotation = np.array(pose.origin), np.array(pose.rotation)
    origin[gap], rotation[gap] = np.nan, np.nan
    return Pose(origin, rotation)


def test_a_held_body_that_differs_by_a_constant_closes_the_gap_exactly():
    whole = swinging()
    found = carry_over(with_gap(whole, GAP), swinging(7.0, 0.02))
    np.testing.assert_allclose(found.rotation, whole.rotation, atol=1e-12)
    np.testing.assert_allclose(found.origin, whole.origin, atol=1e-12)


def test_frames_that_are_known_stay_as_they_are():
    whole = swinging()
    assert carry_over(whole, swinging(7.0)) is whole


def test_a_gap_at_the_end_keeps_the_last_difference():
    whole = swinging()
    found = carry_over(with_gap(whole, slice(50, FRAMES)), swinging(7.0, 0.02))
    np.testing.assert_allclose(found.rotation, whole.rotation, atol=1e-12)


def test_where_the_held_body_is_unknown_the_gap_stays():
    found = carry_over(with_gap(swinging(), GAP), with_gap(swinging(), slice(25, 30)))
    assert np.flatnonzero(~found.known).tolist() == [25, 26, 27, 28, 29]


def test_a_held_body_that_has_flipped_is_not_followed():
    """Within the gap the held body is turned by 70 deg, as in another minimum of the squares."""
    held = swinging()
    rotation = np.array(held.rotation)
    rotation[25:30] = rotation[25:30] @ Rotation.from_euler("y", 70, degrees=True).as_matrix()
    found = carry_over(with_gap(swinging(), GAP), Pose(held.origin, rotation))
    assert np.flatnonzero(~found.known).tolist() == [25, 26, 27, 28, 29]


HELD = marker_set("rajagopal")
FREE = HELD.with_joints("free")
FLEXIONS = ("hip_flexion", "knee_angle", "ankle_angle")
ANGLES = known_angles(60)
CALIBRATION = calibrate_body(static_of(RAJAGOPAL), HELD)
PLANAR = calibrate_body(static_of(RAJAGOPAL), HELD.with_joints("planar"))
JOINTS = {"thigh": "hip", "shank": "knee", "foot": "ankle"}


def shaken(markers: Recording, seed: int, size: float = 0.008) -> Recording:
    return markers.with_values(markers.values + size * np.random.default_rng(seed).normal(size=markers.values.shape))


def slid(markers: Recording, amplitude: float) -> Recording:
    """The markers of both thighs go up and forward on the skin together, once a stride."""
    values = np.array(markers.values)
    wave = amplitude * np.sin(np.linspace(0, 4 * np.pi, len(values)))
    for side in "LR":
        for name in ("TH1", "TH2", "TH3", "LFC"):
            values[:, markers.index(f"{side}{name}.x")] += wave
    return markers.with_values(values)


def joints_apart(found: Motion) -> float:
    apart = []
    for segment in SEGMENTS[1:]:
        joint = JOINTS[segment[:-2]] + segment[-2:]
        inside = found.poses[segment].to_laboratory(CALIBRATION.points[segment][joint])
        apart.append(np.linalg.norm(inside - carry_joint(joint, found.poses, found.calibration), axis=1).max())
    return max(apart)


@pytest.mark.slow
def test_joints_do_not_part():
    markers = shaken(markers_of(known_angles(40), RAJAGOPAL), 0)
    assert joints_apart(motion(markers, CALIBRATION)) < 1e-9
    assert joints_apart(motion(markers, replace(CALIBRATION, marker_set=FREE))) > 1e-3


def test_the_squares_are_the_least_that_an_independent_minimiser_finds():
    """Place of the pelvis and seven rotation vectors, minimised by scipy from the same rigid bodies."""
    markers = shaken(markers_of(known_angles(40), RAJAGOPAL), 1).between(0.2, 0.205)
    found = motion(markers, CALIBRATION, (1, 0, 0))

    def apart(numbers: np.ndarray) -> np.ndarray:
        turns = {segment: Rotation.from_rotvec(numbers[3 + 3 * i : 6 + 3 * i]) for i, segment in enumerate(SEGMENTS)}
        origins, left = {"pelvis": numbers[:3]}, []
        for segment in SEGMENTS:
            if segment != "pelvis":
                part, side = segment.split("_")
                above = {"thigh": "pelvis", "shank": f"thigh_{side}", "foot": f"shank_{side}"}[part]
                joint = f"{JOINTS[part]}_{side}"
                origins[segment] = origins[above] + turns[above].apply(CALIBRATION.points[above][joint])
            for name, place in CALIBRATION.body[segment].items():
                if f"{name}.x" in markers.names:
                    seen = np.array([markers[f"{name}.{axis}"][0] for axis in "xyz"])
                    left.append(origins[segment] + turns[segment].apply(place) - seen)
        return np.concatenate(left)

    start = np.concatenate(
        [found.poses["pelvis"].origin[0]]
        + [Rotation.from_matrix(found.poses[segment].rotation[0]).as_rotvec() for segment in SEGMENTS]
    )
    best = least_squares(apart, start + 0.05, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    np.testing.assert_allclose((apart(start) ** 2).sum(), 2 * best.cost, rtol=1e-9)


def test_a_body_that_moves_in_a_plane_is_followed_in_it():
    """Out of the plane nothing is reported; in it the angles are exact though the markers shake across it."""
    known = {name: values * (name[:-2] in FLEXIONS or name == "pelvis_tilt") for name, values in ANGLES.items()}
    markers = markers_of(known, RAJAGOPAL)
    across = np.array([name.endswith(".z") for name in markers.names])
    shaking = 0.008 * np.random.default_rng(2).normal(size=markers.values.shape) * across
    found = motion(markers.with_values(markers.values + shaking), PLANAR, (1, 0, 0)).angles
    assert set(found.names) == {*(f"{name}_{side}" for name in FLEXIONS for side in "rl"), "pelvis_tilt",
                                "pelvis_tx", "pelvis_ty"}  # fmt: skip
    for name in set(found.names) & set(known):
        np.testing.assert_allclose(found[name], known[name], atol=1e-8, err_msg=name)


def test_a_planar_body_agrees_with_opensim_s_planar_model(gait_data):
    """gait10dof's own inverse kinematics of the same markers: after the mean difference, sagittal rms <= 3 deg."""
    folder = gait_data.parent / "opensim_gait10dof"
    if not folder.is_dir():
        pytest.skip(f"real recordings are absent: {folder}")
    files = (folder / "ExperimentalData" / "subject01_static.trc", folder / "ExperimentalData" / "subject01_walk.trc")
    static, walk = (read_trial(file).stream("markers") for file in files)
    theirs = read_trial(folder / "IK" / "subject01_walk_IK.mot").stream("kinematics")
    ours = move_body(walk, static, joints="planar").angles
    for name in ("pelvis_tilt", *(f"{flexion}_{side}" for flexion in FLEXIONS for side in "rl")):
        apart = ours[name] - np.interp(walk.time, theirs.time, theirs[name])
        assert apart.std() <= 3.0, f"{name} {apart.std():.2f} deg"


def test_a_thigh_laid_over_sliding_skin_leaves_its_hip_and_a_held_one_does_not():
    """The thigh's markers slide by 15 mm: as one body they shift, but the hip does not follow."""
    known = known_angles(100)
    markers = slid(markers_of(known, RAJAGOPAL), 0.015)
    errors = {}
    for name, chosen in (("held", HELD), ("free", FREE)):
        found = motion(markers, replace(CALIBRATION, marker_set=chosen), (1, 0, 0))
        centre = found.poses["thigh_r"].origin - carry_joint("hip_r", found.poses, found.calibration)
        errors[name] = np.linalg.norm(centre, axis=1).max()
    assert errors["held"] < 1e-9
    np.testing.assert_allclose(errors["free"], 0.015, rtol=0.05)


LABORATORY = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # forward y, up z, right x, as Theia3D has it
BACK = [2, 0, 1]  # columns forward, up, right as right, forward, up


def segments_of(angles: dict[str, np.ndarray], speed: float = 1.3) -> Recording:
    """Poses of a body as a system without markers writes them."""
    channels, columns = [], []
    for name, (origin, rotation) in body_frames(angles, speed).items():
        part, _, side = name.partition("_")
        label = f"{side}_{part}" if side else part
        axes = (LABORATORY @ rotation)[:, :, BACK]
        columns += [origin @ LABORATORY.T, axes.reshape(-1, 9)]
        channels += [Channel(f"{label}.{axis}", "translation", "m") for axis in "xyz"]
        channels += [Channel(f"{label}.r{row}{column}", "signal", "1") for row in "123" for column in "123"]
    values = np.hstack(columns).astype(np.float32).astype(float)  # as a file holds them
    return Recording(np.arange(len(values)) / 100, values, tuple(channels), source=Source("theia.c3d"))


@pytest.mark.parametrize("speed", [0.0, 1.3])
def test_known_angles_come_back(speed):
    known = known_angles(300)
    angles, findings = segment_angles(segments_of(known, speed))
    for name, expected in known.items():
        # on its path a walker has the mean of the pelvis' rotation as a turn of the whole, in place too
        apart = angles[name] - expected
        apart -= apart.mean() if name == "pelvis_rotation" else 0.0
        slack = 0.5 if name in ("pelvis_tilt", "pelvis_list", "pelvis_rotation") else 1e-4
        assert np.abs(apart).max() < slack, name
    assert {finding.kind for finding in findings} == {"segments", "direction"}


def test_frames_without_a_pose_are_empty_and_counted():
    segments = segments_of(known_angles(200))
    angles, findings = segment_angles(with_column(segments, "l_shank", np.nan, slice(20, 30)))
    assert np.isnan(angles["knee_angle_l"][20:30]).all() and np.isfinite(angles["knee_angle_r"]).all()
    (said,) = [finding.what for finding in findings if finding.kind == "gap"]
    assert says(said, "l_shank:", "10 of 200 frames")


def test_a_segment_that_is_missing_and_axes_that_are_none_are_refused():
    segments = segments_of(known_angles(50))
    with pytest.raises(ChannelError, match=r"theia\.c3d.*no r_foot.*l_foot, l_shank, l_thigh"):
        segment_angles(segments.selected([name for name in segments.names if not name.startswith("r_foot")]))
    longer = with_column(segments, "l_thigh.r11", 1.2 * segments["l_thigh.r11"][9:10], slice(9, 10))
    with pytest.raises(ShapeError, match=r"theia\.c3d: .* l_thigh.*frame 10"):
        segment_angles(longer)
