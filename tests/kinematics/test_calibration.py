"""Frames and joint centres of a standing person whose bones are known, hips found by circling too."""

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column
from manufactured_body import (
    ANKLE_WIDTH,
    DEPTH,
    GAIT2354,
    HELEN_HAYES,
    KNEE_WIDTH,
    MEASURES,
    PLUG_IN_GAIT,
    RADIUS,
    RAJAGOPAL,
    SHANK,
    THIGH,
    WIDTH,
    Laboratory,
    known_angles,
    markers_of,
    renamed,
    static_of,
    without,
)
from texts import says

from gaitdisc.errors import ChannelError, SamplingError, SchemaError, ShapeError
from gaitdisc.kinematics.calibration import calibrate_body, find_exchanged_in_static, landmark_order
from gaitdisc.kinematics.functional_hips import functional_hips, sphere_centre
from gaitdisc.kinematics.marker_set import MarkerSet, marker_set
from gaitdisc.kinematics.markers import marker_labels, marker_places
from gaitdisc.kinematics.motion import motion
from gaitdisc.kinematics.pose import davis_hip, harrington_hip
from gaitdisc.recording import Recording
from gaitdisc.recording.trial import BodyMeasures

STATIC = static_of(RAJAGOPAL)
TWO_EXCHANGES = {"RCAL": "RTOE", "RTOE": "RCAL", "LCAL": "LTOE", "LTOE": "LCAL"}


def with_methods(name: str, **methods: str) -> MarkerSet:
    plain = marker_set(name)
    centres = {**plain.joint_centres, **{joint: (method,) for joint, method in methods.items()}}
    return replace(plain, joint_centres=centres)


def test_joint_centres_and_landmarks_lie_where_the_bones_have_them():
    for name, body in (("plug_in_gait", PLUG_IN_GAIT), ("rajagopal", RAJAGOPAL), ("gait2354", GAIT2354)):
        points = calibrate_body(static_of(body), marker_set(name), MEASURES).points
        for side in "lr":
            np.testing.assert_allclose(points["pelvis"][f"hip_{side}"], harrington_hip(WIDTH, DEPTH, side), atol=1e-9)
            np.testing.assert_allclose(points[f"thigh_{side}"][f"hip_{side}"], 0, atol=1e-9)
            np.testing.assert_allclose(points[f"thigh_{side}"][f"knee_{side}"], [0, -THIGH, 0], atol=1e-9)
            np.testing.assert_allclose(points[f"shank_{side}"][f"ankle_{side}"], [0, -SHANK, 0], atol=1e-9)
            np.testing.assert_allclose(points[f"foot_{side}"][f"heel_{side}"], [-0.06, -0.04, 0], atol=1e-9)


def test_the_measured_distance_of_the_spines_comes_before_that_of_the_markers():
    measures = BodyMeasures(inter_asis_m=0.22)
    calibration = calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal"), measures)
    np.testing.assert_allclose(calibration.points["pelvis"]["hip_r"], harrington_hip(0.22, DEPTH, "r"), atol=1e-9)
    said = [finding.what for finding in calibration.findings if finding.kind == "pelvis width"]
    assert len(said) == 1 and says(said[0], "iliac spines", "220 mm", "240 mm")


def test_hips_after_davis_need_leg_lengths():
    chosen = with_methods("plug_in_gait", hip="davis")
    with pytest.raises(ChannelError, match=r"both.*static\.c3d.*none"):
        calibrate_body(static_of(PLUG_IN_GAIT), chosen, MEASURES)
    legs = BodyMeasures(
        marker_diameter_m=2 * RADIUS,
        leg_length_m={"l": 0.80, "r": 0.82},
        knee_width_m=MEASURES.knee_width_m,
        ankle_width_m=MEASURES.ankle_width_m,
    )
    points = calibrate_body(static_of(PLUG_IN_GAIT), chosen, legs).points
    expected = davis_hip(WIDTH, 0.81, 0.82, RADIUS, "r")
    np.testing.assert_allclose(points["pelvis"]["hip_r"], expected, atol=1e-9)


def test_plug_in_gait_takes_its_own_hips_where_leg_lengths_are_known():
    legs = replace(MEASURES, leg_length_m={"l": 0.80, "r": 0.82})
    static, chosen = static_of(PLUG_IN_GAIT), marker_set("plug_in_gait")
    davis = calibrate_body(static, chosen, legs)
    expected = davis_hip(WIDTH, 0.81, 0.82, RADIUS, "r")
    np.testing.assert_allclose(davis.points["pelvis"]["hip_r"], expected, atol=1e-9)
    assert not [finding for finding in davis.findings if finding.kind == "hip"]
    without_legs = calibrate_body(static, chosen, MEASURES)
    place = harrington_hip(WIDTH, DEPTH, "r")
    np.testing.assert_allclose(without_legs.points["pelvis"]["hip_r"], place, atol=1e-9)
    said = [finding.what for finding in without_legs.findings if finding.kind == "hip"]
    assert len(said) == 1 and says(said[0], "Harrington, not Davis", "static.c3d")
    other = calibrate_body(static, chosen.with_hip("harrington"), legs)
    np.testing.assert_allclose(other.points["pelvis"]["hip_r"], place, atol=1e-9)
    with pytest.raises(SchemaError, match=r"hip.*harrington.*'davies'"):
        chosen.with_hip("davies")


def test_medial_markers_make_a_midpoint_and_without_them_the_width_is_needed():
    chosen = marker_set("helen_hayes")
    both = calibrate_body(static_of(HELEN_HAYES), chosen)
    medial = [f"{side}.{name}.Medial" for side in "LR" for name in ("Knee", "Ankle")]
    lateral = without(static_of(HELEN_HAYES), *medial)
    one = calibrate_body(lateral, chosen, MEASURES)
    for segment in both.points:
        for name in set(both.points[segment]) & set(one.points[segment]):
            np.testing.assert_allclose(one.points[segment][name], both.points[segment][name], atol=1e-9)
    with pytest.raises(ChannelError, match=r"neither static\.c3d.*'l'"):
        calibrate_body(lateral, chosen)


def test_a_width_is_taken_from_both_markers_where_nobody_measured_it():
    """Plug-in Gait's chord on a person who also wears a medial malleolus marker."""
    plain = with_methods("helen_hayes", knee="chord", ankle="chord")
    found = calibrate_body(static_of(HELEN_HAYES), plain, BodyMeasures(marker_diameter_m=2 * RADIUS))
    widths = [finding.what for finding in found.findings if finding.kind == "width"]
    assert f"the width of knee_r, between its two markers, is {KNEE_WIDTH * 1000:.0f} mm" in widths
    assert f"the width of ankle_l, between its two markers, is {ANKLE_WIDTH * 1000:.0f} mm" in widths
    np.testing.assert_allclose(found.points["shank_r"]["ankle_r"], [0, -SHANK, 0], atol=1e-9)


def test_a_diameter_that_is_not_known_is_said_once():
    measures = BodyMeasures(knee_width_m=MEASURES.knee_width_m, ankle_width_m=MEASURES.ankle_width_m)
    found = calibrate_body(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait"), measures)
    (said,) = (finding.what for finding in found.findings if finding.kind == "marker diameter")
    assert says(said, "known", "14 mm")


def test_the_person_may_stand_still_in_a_part_of_the_trial_only():
    moving = markers_of(known_angles(100), RAJAGOPAL)
    still = static_of(RAJAGOPAL)
    values = np.concatenate([moving.values, still.values, moving.values])
    static = Recording(np.arange(300) / 100, values, still.channels, source=still.source)
    points = calibrate_body(static, marker_set("rajagopal")).points
    np.testing.assert_allclose(points["thigh_r"]["knee_r"], [0, -THIGH, 0], atol=1e-9)


def test_a_marker_with_gaps_and_one_frame_are_enough():
    static = static_of(RAJAGOPAL)
    lost = with_column(static, "RCAL.x", np.nan, slice(10, None))
    expected = calibrate_body(static, marker_set("rajagopal")).points["foot_r"]["heel_r"]
    for recording in (lost, static.between(0, 0.005)):
        found = calibrate_body(recording, marker_set("rajagopal")).points["foot_r"]["heel_r"]
        np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize(
    ("static", "error", "words"),
    [
        (without(STATIC, "RMFC"), ChannelError, r"rajagopal; static\.c3d.*no RMFC"),
        (with_column(STATIC, "RMFC.x", np.nan), ChannelError, r"static\.c3d has no RMFC\."),
        (markers_of(known_angles(200), RAJAGOPAL), SamplingError, r"walk\.c3d"),
        (static_of(RAJAGOPAL, Laboratory(np.diag([-1.0, 1, 1]))), ShapeError, r"static\.c3d.*left.*right"),
        (renamed(STATIC, TWO_EXCHANGES), ShapeError, r"static\.c3d .TOE.*not.*.CAL \(200 mm\)"),
    ],
    ids=["a marker is missing", "is never seen", "a walk", "mirrored", "labels that no single exchange puts right"],
)
def test_a_static_trial_that_shows_no_body_is_refused(static, error, words):
    with pytest.raises(error, match=words):
        calibrate_body(static, marker_set("rajagopal"))


def test_too_few_markers_to_follow_a_segment_are_refused():
    static = without(static_of(GAIT2354), "R.Thigh.Front")
    with pytest.raises(ChannelError, match=r"thigh_r.*3 points.*R\.Thigh\.Upper, R\.Thigh\.Rear.*missing: "):
        calibrate_body(static, marker_set("gait2354"))


@pytest.mark.parametrize(
    ("pair", "spoiled"),
    [
        (("RCAL", "LCAL"), ("foot_l", "foot_r")),
        (("RCAL", "RTOE"), ("foot_r",)),
        (("LLMAL", "LCAL"), ("shank_l", "foot_l")),
    ],
)
def test_two_exchanged_labels_spoil_their_segments_alone_and_are_named(pair, spoiled):
    static = renamed(static_of(RAJAGOPAL), dict(zip(pair, pair[::-1], strict=True)))
    found = calibrate_body(static, marker_set("rajagopal"))
    (said,) = (one for one in found.findings if one.kind == "exchanged markers")
    assert all(label in said.what for label in pair)
    assert (said.severity, said.file, found.spoiled) == ("warning", "static.c3d", spoiled)


def test_landmarks_on_a_line_are_refused():
    static = static_of(RAJAGOPAL)
    values = np.array(static.values)
    for axis in "xyz":
        middle = (static[f"LASI.{axis}"] + static[f"RASI.{axis}"]) / 2
        for label in ("LPSI", "RPSI"):
            values[:, static.index(f"{label}.{axis}")] = middle
    with pytest.raises(ShapeError, match="landmarks"):
        calibrate_body(static.with_values(values), marker_set("rajagopal"))


BODIES = {"plug_in_gait": PLUG_IN_GAIT, "rajagopal": RAJAGOPAL}
TIME = np.arange(1500) / 100


def circled(name: str, flexion: float = 25.0, adduction: float = 20.0) -> Recording:
    """Each leg drawn to the front and the back, to the side, and round, knees straight."""
    turn = 2 * np.pi * TIME / 5
    angles = {key: np.zeros(len(TIME)) for key in known_angles(2)}
    for side in "rl":
        angles[f"hip_flexion_{side}"] = flexion * np.sin(turn)
        angles[f"hip_adduction_{side}"] = adduction * np.sin(turn * 1.5 + 0.4) - 5
        angles[f"hip_rotation_{side}"] = 5 * np.sin(turn * 0.5)
    angles["pelvis_tilt"] = 6 * np.sin(turn + 1)
    return markers_of(angles, BODIES[name], speed=0.0, file="circles.c3d")


def body(name: str, wrong_m: float = 0.0):
    """Calibration of a person whose hips the landmarks place by so much beside where they are, and the true hips."""
    right = calibrate_body(static_of(BODIES[name]), marker_set(name).with_hip("harrington"), MEASURES)
    true = {joint: place for joint, place in right.points["pelvis"].items() if joint.startswith("hip")}
    points = dict(right.points)
    points["pelvis"] = {k: place + wrong_m * (k in true) for k, place in right.points["pelvis"].items()}
    return type(right)(right.marker_set, right.body, points), true


@pytest.mark.parametrize("name", BODIES)
def test_known_hips_are_found_whatever_the_landmarks_say(name):
    calibration, true = body(name, wrong_m=0.012)
    hips, findings = functional_hips(circled(name), calibration)
    for joint, place in true.items():
        np.testing.assert_allclose(hips[joint], place, atol=1e-5)
    assert [finding.kind for finding in findings] == ["functional hip"] * 2
    assert says(findings[0].what, "21 mm", "of the landmarks")


@pytest.mark.parametrize(("skin_mm", "within_mm"), [(1.0, 3.0), (5.0, 13.0)])
def test_sliding_skin_moves_them_by_millimetres(skin_mm, within_mm):
    random = np.random.default_rng(3)
    markers = circled("rajagopal")
    values = np.array(markers.values)
    for column, channel in enumerate(markers.channels):
        if channel.name.startswith(("RTH", "LTH", "RLFC", "LLFC", "RMFC", "LMFC")):
            phase = random.uniform(0, 2 * np.pi, 2)
            slid = np.sin(2 * np.pi * TIME / 5 + phase[0]) + np.sin(4 * np.pi * TIME / 5 + phase[1])
            values[:, column] += skin_mm / 1000 * slid
    calibration, true = body("rajagopal")
    hips, _ = functional_hips(markers.with_values(values), calibration)
    apart = [1000 * np.linalg.norm(hips[joint] - place) for joint, place in true.items()]
    assert max(apart) < within_mm


def test_noise_of_the_cameras_gives_no_bias():
    random = np.random.default_rng(0)
    way = random.normal(size=(20_000, 3)) * [0.3, 0.05, 0.2] + [0, -1, 0]
    way = 0.4 * way / np.linalg.norm(way, axis=1, keepdims=True)
    noisy = way[:, None] + random.normal(scale=0.003, size=(20_000, 1, 3))
    assert np.linalg.norm(sphere_centre(noisy, np.array([0.02, 0.02, 0.02])).centre) < 4e-4


@pytest.mark.parametrize(
    ("flexion", "adduction", "words"),
    [(25.0, 2.0, r"turns by \d\.\d deg \(rms\) perpendicular"), (3.0, 2.0, "turns by"), (0.0, 0.0, "turns by")],
)
def test_one_plane_or_none_keeps_the_hip_of_the_landmarks(flexion, adduction, words):
    calibration, _ = body("rajagopal")
    hips, findings = functional_hips(circled("rajagopal", flexion, adduction), calibration)
    assert not hips
    for finding in findings:
        assert finding.severity == "warning" and says(finding.what, "not", "from")
        assert re.search(words, finding.what)


def test_a_body_calibrated_with_them_has_its_joints_there():
    _, true = body("rajagopal")
    moved = {joint: place + np.array([0.01, -0.01, 0.0]) for joint, place in true.items()}
    found = calibrate_body(static_of(RAJAGOPAL), marker_set("rajagopal"), MEASURES, moved)
    for joint, place in moved.items():
        np.testing.assert_allclose(found.points["pelvis"][joint], place, atol=1e-12)
    standing = motion(static_of(RAJAGOPAL), found)
    assert abs(standing.angles["hip_flexion_r"]).max() > 0.5  # thigh axes end in the hip


UP = np.array([0.0, 1.0, 0.0])
PIG = marker_set("plug_in_gait")


@pytest.fixture(scope="module")
def places():
    static = static_of(PLUG_IN_GAIT)
    names = PIG.names(marker_labels(static))
    return dict(zip(names, marker_places(static, list(names.values()))[0], strict=True))


def test_a_standing_person_contradicts_nothing(places):
    assert min(landmark_order(PIG, places, UP))[0] > 0


def test_exchanges_of_two_plug_in_gait_markers_are_found_and_named(places):
    for pair in [*itertools.combinations(places, 2)][::4]:
        wrong = {**places, pair[0]: places[pair[1]], pair[1]: places[pair[0]]}
        assert min(landmark_order(PIG, wrong, UP))[0] <= 0, pair
        assert find_exchanged_in_static(PIG, wrong, UP) == pair


@pytest.mark.parametrize("turn_deg", [-70, -30, 30, 70])
def test_feet_that_turn_out_or_in_are_no_exchange(places, turn_deg):
    angle = np.radians(turn_deg)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    turned = dict(places)
    for side, way in (("R", turn), ("L", turn.T)):
        for name in ("HEE", "TOE"):
            turned[side + name] = places[f"{side}ANK"] + way @ (places[side + name] - places[f"{side}ANK"])
    assert not [what for value, what in landmark_order(PIG, turned, UP) if value <= 0 and "ahead" in what]
