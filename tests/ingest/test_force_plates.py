"""Force plates of each type: corners, origins, wrenches, and files that say of them what cannot be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.ingest.force_plates import ForcePlate, centre_of_pressure, force_plates, plate_streams

CORNERS = np.array([[0.6, 0, 0], [0, 0, 0], [0, 0.4, 0], [0.6, 0.4, 0]]) * 1000  # [mm], z of the plate down
FOOT = np.array([0.1, -0.05, 0])  # where the foot stands, in the plate's axes [m]
FORCE = np.array([20.0, -30, -600])  # ground on foot, in the plate's axes


def _file(kind=2, origin=(0.0, 0, -40), units=("N", "N", "N", "Nmm", "Nmm", "Nmm"), **more):
    values = {
        "USED": np.array([1]),
        "TYPE": np.array([kind]),
        "CHANNEL": np.arange(1, 7)[:, None],
        "CORNERS": CORNERS.T[..., None],
        "ORIGIN": np.array(origin, float)[:, None],
    } | more
    plates = {("FORCE_PLATFORM", name): value for name, value in values.items()}
    return C3DParameters(plates | {("ANALOG", "UNITS"): tuple(units)}, "a.c3d")


def _rows(sensors=(0, 0, -0.04), sign=1.0, count=200):
    moment = 1000 * np.cross(FOOT + np.array(sensors), FORCE)
    rows = np.tile(sign * np.array([*FORCE, *moment]), (count, 1))
    rows[: count // 2] = 0
    return rows


def _read(rows, parameters):
    plates, described = force_plates(parameters, rows.shape[1], "mm")
    streams, columns, findings = plate_streams(rows, plates, parameters, "mm")
    return streams, columns, described + findings


def _check(streams):
    values, channels = streams["forces"]
    last = dict(zip((channel.name for channel in channels), values[-1], strict=True))
    np.testing.assert_allclose([last[f"plate_1_f{axis}"] for axis in "xyz"], [20, 30, 600], atol=1e-9)
    np.testing.assert_allclose([last[f"plate_1_p{axis}"] for axis in "xyz"], [0.4, 0.25, 0], atol=1e-9)
    return values, channels


def test_ground_on_foot_in_the_axes_of_the_laboratory():
    streams, columns, findings = _read(_rows(), _file())
    values, channels = _check(streams)
    assert [channel.quantity for channel in channels] == [
        "force", "force", "vertical_force", "moment", "moment", "moment", *["pressure_centre"] * 3,
    ]  # fmt: skip
    assert np.isnan(values[0, 6:]).all()
    assert columns == set(range(6))
    assert not findings


def test_moments_are_about_the_centre_of_the_surface():
    values, _ = _check(_read(_rows(), _file())[0])
    np.testing.assert_allclose(values[-1, 3:6], np.diag([1, -1, -1]) @ np.cross(FOOT, FORCE), atol=1e-9)


@pytest.mark.parametrize("origin", [(0.0, 0, 40), (0.0, 0, -40)])
def test_both_signs_of_the_origin(origin):
    _check(_read(_rows(), _file(origin=origin))[0])


def test_an_origin_without_depth_is_inferred_by_where_the_foot_stands():
    sensors = np.array([0.25, 0.8, 0])  # at a corner of a treadmill; the file points from the surface to them
    streams, _, findings = _read(_rows(sensors), _file(origin=tuple(-1000 * sensors)))
    _check(streams)
    assert says(findings[0].what, "ORIGIN points")


def test_force_of_the_foot_on_the_ground_is_turned_around_and_reported():
    streams, _, findings = _read(_rows(sign=-1.0), _file())
    _check(streams)
    assert says(findings[0].what, "plate 1:", "reversed")


def test_type_4_through_its_matrix():
    matrix = np.diag([2.0, 3, 4, 500, 600, 700]) + 0.01
    volts = _rows() @ np.linalg.inv(matrix).T
    parameters = _file(kind=4, units=["V"] * 6, CAL_MATRIX=matrix[..., None])
    _check(_read(volts, parameters)[0])


def test_a_last_dimension_of_one_may_be_left_out():
    parameters = _file(CHANNEL=np.arange(1, 7), CORNERS=CORNERS.T, ORIGIN=np.array([0.0, 0, -40]))
    _check(_read(_rows(), parameters)[0])


def test_the_zero_span_is_removed_unless_the_plate_is_loaded_then():
    offset = np.array([3.0, -4, 5, 100, 200, 300])
    _check(_read(_rows() + offset, _file(ZERO=np.array([1, 10])))[0])
    loaded = _rows()[::-1].copy()
    streams, _, findings = _read(np.vstack([loaded, loaded[-1:].repeat(400, axis=0)]), _file(ZERO=np.array([1, 10])))
    assert streams["forces"][0][0, 2] == pytest.approx(600)
    assert says(findings[0].what, "600 N", "samples 1 to 10")


def test_a_plate_far_from_its_foot_is_reported():
    _, _, findings = _read(_rows((0.9, 0, -0.04)), _file())
    assert says(findings[0].what, "centre of pressure lies outside", "100 %")


def _two_belts(channels, sense=1):
    """Two belts side by side whose sensors are at one place between them, with a foot on each."""
    beside = 1000 * np.array([0, 0.5, 0])
    more = {
        "USED": np.array([2]),
        "TYPE": np.array([2, 2]),
        "CHANNEL": np.array(channels).T,
        "CORNERS": np.stack([CORNERS.T, (CORNERS + beside).T], axis=-1),
        "ORIGIN": sense * np.array([[300, 250, 0], [300, -250, 0]], float).T,
    }
    rows = np.hstack([_rows((0.3, 0.25, 0)), _rows((0.3, -0.25, 0))])
    return _read(rows, _file(units=("N", "N", "N", "Nmm", "Nmm", "Nmm") * 2, **more))[2]


@pytest.mark.parametrize("sense", [1, -1])
def test_plates_with_each_others_channels_are_reported(sense):
    first, second = list(range(1, 7)), list(range(7, 13))
    assert not [one for one in _two_belts([first, second], sense) if one.severity == "warning"]
    (swapped,) = [one for one in _two_belts([second, first], sense) if one.kind == "swapped plates"]
    assert says(swapped.what, "plates 1", "2", "100 %")


def test_a_plate_that_nobody_stepped_on():
    _, _, findings = _read(_rows() * 0.05, _file())
    assert says(findings[0].what, "no plate was loaded with more than 100 N")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"kind": 7}, "but only types 1 to 4 are known"),
        ({"kind": 4}, "is of type 4 and has no calibration matrix"),
        ({"kind": 4, "CAL_MATRIX": np.full((6, 6, 1), np.nan)}, "has a calibration matrix that is not finite"),
        ({"CHANNEL": np.array([[1], [2], [3], [4], [5], [60]])}, "channels 1, 2, 3, 4, 5, 60, but the file has 6"),
        ({"CORNERS": np.zeros((3, 4, 1))}, "has corners that span no surface"),
        ({"CORNERS": np.zeros((3, 2, 1))}, "has no corners or no origin"),
        ({"ORIGIN": np.full((3, 1), np.nan)}, "has an origin that is not finite"),
        ({"units": ["ADC"] * 6}, "has channel #1 in 'ADC'"),
        ({"units": [""] * 6}, "states no units; N and N mm are assumed"),
    ],
)
def test_what_cannot_be_used_is_reported(changes, words):
    assert words in _read(_rows(), _file(**changes))[2][0].what


def test_type_2_and_type_4_of_one_trial_agree(gait_data, reader):
    folder = gait_data / "c3d_reader_samples/c3d_org_other"
    two, four = (reader.read(folder / f"type-{kind}.c3d").stream("forces") for kind in ("2a", "4a"))
    for plate in (1, 2):
        for axis in "xyz":  # type 2 leaves the cross-talk in that the matrix of type 4 takes out
            np.testing.assert_allclose(two[f"plate_{plate}_f{axis}"], four[f"plate_{plate}_f{axis}"], atol=2.5)
        heavy = (two[f"plate_{plate}_fz"] > 300) & (four[f"plate_{plate}_fz"] > 300)
        assert heavy.sum() > 300
        for axis in "xy":
            found = (one[f"plate_{plate}_p{axis}"][heavy] for one in (two, four))
            np.testing.assert_allclose(*found, atol=0.002)


def test_feet_stand_where_the_pressure_is(gait_data, reader):
    trial = reader.read(gait_data / "treadmill_c3d_emg/walking_1.c3d")
    forces, markers = trial.stream("forces"), trial.stream("markers")
    for plate, heel in ((1, "LCAL"), (2, "RCAL")):
        loaded = forces[f"plate_{plate}_fz"] > 300
        low, high = np.nanpercentile(forces[f"plate_{plate}_px"][loaded], [5, 95])
        assert markers[f"{heel}.x"].min() - 0.05 < low < high < markers[f"{heel}.x"].max() + 0.05


@pytest.mark.parametrize("part", [b"FORCE_PLATFORM", b"USED", b"USED\x07\x00\x02\x00\x02\x00\x00"], ids=str)
def test_one_wrong_bit_does_not_drop_the_forces_in_silence(gait_data, reader, tmp_path, part):
    raw = bytearray(next((gait_data / "young_straight_and_turn").rglob("*.c3d")).read_bytes())
    at = raw.find(part, raw.find(b"FORCE_PLATFORM"))
    raw[at + 8 * (len(part) == 11)] ^= 2 if len(part) == 11 else 1  # the count of two plates, or a letter of the name
    (tmp_path / "walk.c3d").write_bytes(raw)
    trial = reader.read(tmp_path / "walk.c3d")
    said = [one.what for one in trial.findings if one.kind == "force plate" and one.severity == "warning"]
    assert "forces" not in trial.streams and len(said) == 1
    assert ("no force plate is described" if part == b"FORCE_PLATFORM" else "USED is 0") in said[0]


# 0.6 m x 0.4 m, its z axis down: x forwards, y to the right
ORIGIN = np.array([0.002, -0.001, -0.04])  # the sensors lie 40 mm below the surface


def _plate(kind, origin=ORIGIN, calibration=None):
    columns = tuple(range(8 if kind == 3 else 6))
    return ForcePlate(1, kind, columns, CORNERS / 1000, origin, np.eye(6) if calibration is None else calibration)


def test_axes_of_the_corners():
    plate = _plate(2)
    np.testing.assert_allclose(plate.axes, np.diag([1, -1, -1]))
    np.testing.assert_allclose(plate.surface.centre, [0.3, 0.2, 0])
    assert plate.vertical == 2


points = st.tuples(st.floats(-0.25, 0.25), st.floats(-0.15, 0.15))
forces = st.tuples(st.floats(-200, 200), st.floats(-200, 200), st.floats(-1500, -30))


@given(points, forces, st.floats(-20, 20))
def test_all_types_find_the_force_and_the_point_that_made_their_channels(point, force, free):
    force, at = np.array(force), np.array([*point, 0.0])
    about_surface = np.cross(at, force) + np.array([0, 0, free])
    about_sensors = np.cross(at + ORIGIN, force) + np.array([0, 0, free])
    calibration = np.diag([2.0, 2, 5, 0.5, 0.5, 0.25])
    channels = {
        1: [*force, *point, free],
        2: [*force, *about_sensors],
        4: [*(np.linalg.inv(calibration) @ [*force, *about_sensors])],
    }
    for kind, values in channels.items():
        plate = _plate(kind, calibration=calibration)
        units = ("N", "N", "N", "m", "m", "N m") if kind == 1 else ("N",) * 3 + ("N m",) * 3
        found, moment = plate.wrench(np.array([values]), units)
        np.testing.assert_allclose(found[0], force, atol=1e-9)
        np.testing.assert_allclose(moment[0], about_surface, atol=1e-9)
        np.testing.assert_allclose(centre_of_pressure(found, moment)[0], at, atol=1e-9)


@given(points, st.floats(-1500, -30))
def test_four_pillars_find_the_point_of_a_vertical_force(point, vertical):
    a, b = 0.12, 0.2
    along, across = point[0] / a, point[1] / b
    share = [
        (1 + along) * (1 + across),
        (1 - along) * (1 + across),
        (1 - along) * (1 - across),
        (1 + along) * (1 - across),
    ]
    values = np.array([[0, 0, 0, 0, *(vertical * one / 4 for one in share)]])
    force, moment = _plate(3, np.array([a, b, -0.05])).wrench(values, ("N",) * 8)
    assert force[0, 2] == pytest.approx(vertical)
    np.testing.assert_allclose(centre_of_pressure(force, moment)[0], [*point, 0], atol=1e-9)


def test_four_pillars_sum_the_shear_and_bring_its_moment_to_the_surface():
    values = np.array([[3.0, 7, 1, 4, -100, -100, -100, -100]])
    force, moment = _plate(3, np.array([0.12, 0.2, -0.05])).wrench(values, ("N",) * 8)
    np.testing.assert_allclose(force[0], [10, 5, -400])
    np.testing.assert_allclose(moment[0], [5 * -0.05, -10 * -0.05, 0.2 * 4 + 0.12 * -3], atol=1e-12)


def test_units_of_the_channels_count():
    force, moment = _plate(2, np.zeros(3)).wrench(
        np.array([[1.0, 2, 3, 4000, 5000, 6000]]), ("kN",) * 3 + ("N mm",) * 3
    )
    np.testing.assert_allclose(force, [[1000, 2000, 3000]])
    np.testing.assert_allclose(moment, [[4, 5, 6]])
