"""A trial, and what it carries: plates, findings, cycles, measures of the person."""

import copy
import math
import pickle

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError, ShapeError, UnitError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Cycle, Finding, Recording, Surface, Trial
from gaitdisc.recording.trial import BodyMeasures

KNEE = Channel("knee_angle_r", "angle", "deg", "r")
FORCE = Channel("ground_force_r_vy", "vertical_force", "N", "r")


def trial(start=0.0):
    slow, fast = np.arange(101) / 100, start + np.arange(2001) / 1000
    return Trial(
        "walk",
        {
            "kinematics": Recording(slow, 2 * slow[:, None], (KNEE,)),
            "forces": Recording(fast, 3 * fast[:, None], (FORCE,)),
        },
    )


def test_one_base_is_the_common_span_at_the_rate_asked_for():
    both = trial(start=0.25).on_one_base(200.0)
    assert both.names == ("knee_angle_r", "ground_force_r_vy")
    assert both.rate_hz == 200.0
    assert (both.time[0], both.time[-1]) == (0.25, 1.0)
    np.testing.assert_allclose(both.values, np.column_stack([2 * both.time, 3 * both.time]), atol=1e-9)


def test_streams_that_share_no_time_are_not_there_or_of_no_kind_are_refused():
    with pytest.raises(SamplingError, match=r"5.000 s.*1.000 s"):
        trial(start=5.0).on_one_base(100.0)
    with pytest.raises(ChannelError, match=r"emg.*has kinematics, forces"):
        trial().stream("emg")
    with pytest.raises(ChannelError, match="walk has 'grf'"):
        Trial("walk", {"grf": trial().stream("forces")})


@pytest.mark.parametrize("sent", [lambda one: pickle.loads(pickle.dumps(one)), copy.deepcopy], ids=["pickle", "copy"])
def test_a_trial_goes_to_another_process_and_stays_frozen(sent):
    again = sent(trial())
    assert repr(again) == repr(trial())
    np.testing.assert_array_equal(again.stream("forces").values, trial().stream("forces").values)
    for one in (trial(), again):
        with pytest.raises(TypeError):
            one.streams["emg"] = one.stream("forces")


def test_line_without_channel():
    assert says(
        Finding("note", "second reader", "a.c3d", "read by c3d", "").line(),
        "note: a.c3d",
        "second reader",
        "read by c3d",
    )


def test_the_severest_comes_first():
    findings = [Finding(severity, "gap", "a.c3d", "", "") for severity in ("note", "refused", "warning")]
    assert [f.severity for f in sorted(findings, key=lambda f: f.rank)] == ["refused", "warning", "note"]


def test_unknown_severity():
    with pytest.raises(ValueError, match="severity must be one of"):
        Finding("fatal", "gap", "a", "b", "c")


def test_shares_of_a_cycle_that_is_known():
    one = Cycle("r", 2.0, 3.0, ("events", "events"), foot_off=2.6, opposite_off=2.1, opposite_contact=2.5)
    assert one.duration_s == 1.0
    assert one.stance_percent == pytest.approx(60.0)
    assert one.double_support_percent == pytest.approx(20.0)


def test_what_is_not_known_is_missing():
    assert math.isnan(Cycle("l", 0.0, 1.0, ("force", "force")).stance_percent)
    assert math.isnan(Cycle("l", 0.0, 1.0, ("force", "force"), foot_off=0.6).double_support_percent)


def test_sides_are_read_only():
    measures = BodyMeasures(knee_width_m={"l": 0.1})
    with pytest.raises(TypeError):
        measures.knee_width_m["l"] = 0.2  # pyright: ignore


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"knee_width_m": {"r": 102.0}}, r"knee_width_m of side 'r' must be between 0\.03 and 0\.25 m; found 102 m"),
        ({"mass_kg": 0.7}, "mass_kg must be between 5 and 300 kg; found 0.7 kg"),
        ({"mass_kg": 700.0}, "found 700 kg"),
        ({"height_m": 1580.0}, r"found 1580 m\. Give it in m"),
        ({"inter_asis_m": float("nan")}, "found nan m"),
    ],
)
def test_what_no_person_measures_is_refused(given, words):
    with pytest.raises(UnitError, match=words):
        BodyMeasures(**given)


TILTED = np.array([[0.0, 0, 0], [0.4, 0, 0.3], [0.4, 0.6, 0.3], [0, 0.6, 0]])  # 0.5 m long, 0.6 m wide


def test_distances_are_measured_in_the_surface():
    plate = Surface("ramp", TILTED)
    along, across = np.array([0.8, 0.0, 0.6]), np.array([0.0, 1.0, 0.0])
    points = [
        plate.centre,
        plate.centre + 0.35 * along,
        plate.centre - 0.35 * across,
        plate.centre + 0.7 * plate.normal,
    ]
    assert plate.outside(np.array(points)) == pytest.approx([-0.25, 0.1, 0.05, -0.25])
    assert abs(plate.normal @ [0.6, 0, -0.8]) == pytest.approx(1)


def test_the_order_of_the_corners_does_not_matter():
    around = Surface("ramp", TILTED[::-1])
    assert around.outside(np.array([[0.5, 0.3, 0.3]])) == pytest.approx(Surface("a", TILTED).outside(np.array([[0.5, 0.3, 0.3]])))  # fmt: skip  # noqa: E501


def test_a_marker_that_is_missing_is_nowhere():
    assert np.isnan(Surface("ramp", TILTED).outside(np.full((1, 3), np.nan))).all()


@pytest.mark.parametrize("corners", [TILTED[:3], np.zeros((4, 3)), TILTED * np.nan])
def test_corners_that_span_nothing_are_refused(corners):
    with pytest.raises(ShapeError, match=r"corners \(4, 3\).*plate_3"):
        Surface("plate_3", corners)


def test_a_c3d_file_says_where_its_plates_lie(gait_data):
    trial = read_trial(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d")
    assert [surface.name for surface in trial.surfaces] == ["plate_1", "plate_2"]
    # FORCE_PLATFORM:CORNERS: 463.8 by 508 mm, the second plate beside the first
    assert trial.surfaces[0].centre == pytest.approx([0.232, 0.254, 0.0], abs=1e-4)
    assert trial.surfaces[1].centre == pytest.approx([0.232, -0.324, 0.0], abs=1e-4)
