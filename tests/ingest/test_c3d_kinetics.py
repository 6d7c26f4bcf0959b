"""Plug-in Gait's kinetics as moments of the muscles, per kg whatever the file states; measures of a person."""

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.ingest.c3d_kinetics import house_kinetics
from gaitdisc.ingest.c3d_parameters import C3DParameters, body_mass, find_body_measures, read_body_measures
from gaitdisc.ingest.reading import read_trial

KINDS = ("per body mass", "body mass", "moment sign")
STEP = np.r_[np.zeros(20), np.sin(np.linspace(0, np.pi, 60)), np.zeros(20)]  # one loading of a plate
PUSH_OFF = np.r_[np.zeros(40), np.sin(np.linspace(0, np.pi, 40)), np.zeros(20)]
NO_PLATE = np.empty((0, 0))


def _kinetics(reaction=11.0, ankle=1.4, unit="N m"):
    """A step of a right leg: reaction force, ankle moment and its power, as a file may hold them."""
    flat = np.zeros(100)
    channels = (
        *(Channel(f"RGroundReactionForce.{axis}", "force", "N", "r") for axis in "xyz"),
        Channel("ankle_angle_r_moment", "moment", unit, "r"),
        Channel("RGroundReactionMoment.x", "moment", unit, "r"),
        Channel("RAnklePower.z", "power", "W", "r"),
    )
    values = np.column_stack([flat, flat, reaction * STEP, ankle * PUSH_OFF, 0.1 * STEP, 3 * PUSH_OFF])
    return values, channels


def _units(channels):
    return {channel.name: channel.unit for channel in channels}


def test_a_plate_shows_that_kinetics_are_per_kg_and_which_mass_it_was():
    (values, channels), findings = house_kinetics(_kinetics(), 11.0 * 60 * STEP[:, None], 60.0, "a.c3d")
    assert set(_units(channels).values()) == {"N/kg", "N m/kg", "W/kg"}
    np.testing.assert_array_equal(values[:, 2], 11.0 * STEP)
    assert (findings[0].severity, findings[0].kind) == ("note", "per body mass")
    assert says(findings[0].what, "plate 1", "660 N", "RGroundReactionForce", "11", "channels: 6")
    assert says(findings[0].what, "body mass 60.0 kg")


def test_another_mass_than_the_file_states_is_a_warning():
    _, findings = house_kinetics(_kinetics(), 11.0 * 60 * STEP[:, None], 75.0, "a.c3d")
    (said,) = (f.what for f in findings if (f.severity, f.kind) == ("warning", "body mass"))
    assert says(said, "60.0 kg", "75.0 kg")


def test_true_newtons_stay():
    (_, channels), findings = house_kinetics(_kinetics(700, 90), 700 * STEP[:, None], 70.0, "a.c3d")
    assert set(_units(channels).values()) == {"N", "N m", "W"}
    assert [f.kind for f in findings] == ["moment sign"]


def test_without_a_plate_the_size_of_the_numbers_decides_and_is_a_warning():
    (_, channels), findings = house_kinetics(_kinetics(), NO_PLATE, None, "a.c3d")
    assert _units(channels)["ankle_angle_r_moment"] == "N m/kg"
    assert (findings[0].severity, findings[0].kind) == ("warning", "per body mass")
    assert says(findings[0].what, "force exceeds 11")
    (_, channels), findings = house_kinetics(_kinetics(700, 90), NO_PLATE, None, "a.c3d")
    assert _units(channels)["ankle_angle_r_moment"] == "N m"


@pytest.mark.parametrize(("reaction", "ankle"), [(700, 1.4), (11, 90)])
def test_forces_and_moments_that_contradict_each_other_are_left_and_named(reaction, ankle):
    (_, channels), findings = house_kinetics(_kinetics(reaction, ankle), NO_PLATE, 60.0, "a.c3d")
    assert set(_units(channels).values()) == {"N", "N m", "W"}
    assert says(findings[0].what, "units of the file are used")
    assert findings[0].severity == "warning"


def test_a_positive_push_off_is_turned_and_the_ground_is_not():
    (values, _), findings = house_kinetics(_kinetics(), NO_PLATE, None, "a.c3d")
    np.testing.assert_array_equal(values[:, 3], -1.4 * PUSH_OFF)
    np.testing.assert_array_equal(values[:, 4], 0.1 * STEP)  # the moment of the ground is no joint moment
    np.testing.assert_array_equal(values[:, 5], 3 * PUSH_OFF)  # generated power stays positive
    assert says(findings[-1].what, "1.40 N m/kg", "channels: 1")


@pytest.mark.parametrize(
    ("ankle", "words"), [(-1.4, "plantarflexion is already negative"), (0.1, "that of Plug-in Gait")]
)
def test_a_negative_push_off_stays_and_somebody_who_stands_is_taken_as_plug_in_gait(ankle, words):
    (values, _), findings = house_kinetics(_kinetics(ankle=ankle), NO_PLATE, None, "a.c3d")
    np.testing.assert_array_equal(values[:, 3], -abs(ankle) * PUSH_OFF)
    assert words in findings[-1].what
    assert bool(findings[-1].spoils) == (ankle > 0)


def test_the_mass_that_a_file_states():
    assert body_mass(C3DParameters({("PROCESSING", "BODYMASS"): np.array([56.8])})) == 56.8
    assert body_mass(C3DParameters({("SUBJECT", "WEIGHT"): np.array([82.7])})) == 82.7
    assert body_mass(C3DParameters({("PROCESSING", "BODYMASS"): np.array([0.0])})) is None


def _people(gait_data):
    return sorted((gait_data / "young_straight_and_turn").rglob("*.c3d"))


def test_plates_of_six_people_show_their_own_mass(gait_data, reader):
    """Plate over reaction force is the body mass of PROCESSING in every file: 27.7 to 60.3 kg."""
    for path in _people(gait_data):
        trial = read_trial(path, reader=reader)
        (said,) = [f for f in trial.findings if f.kind == "per body mass" and "carries" in f.what]
        shown = float(said.what.split("(body mass ")[1].split(" kg")[0])
        stated = {"HC002D": 32.1, "HC030A": 45.8, "HC031A": 27.7, "HC032A": 60.3, "HC033A": 51.5, "HC036A": 33.0}
        assert shown == pytest.approx(stated[path.name[:6]], abs=0.11), path.name
        units = {c.quantity: c.unit for c in trial.stream("moments").channels if "Normalised" not in c.name}
        assert units == {"force": "N/kg", "moment": "N m/kg", "power": "W/kg"}
        assert not [f for f in trial.findings if f.kind in KINDS and f.severity != "note"]


def test_ankle_moments_of_six_people_are_those_of_the_calf_at_push_off(gait_data, reader):
    """Stance peak of the internal ankle moment: plantarflexor, about -1.2 to -1.5 N m/kg (Winter 2009: 1.4 to 1.6)."""
    seen = 0
    for path in [path for path in _people(gait_data) if "straight" in path.parts]:
        moments = read_trial(path, reader=reader).stream("moments")
        for side in "rl":
            ankle, hip = moments[f"ankle_angle_{side}_moment"], moments[f"hip_adduction_{side}_moment"]
            assert -1.7 < np.nanmin(ankle) < -1.0 and np.nanmax(ankle) < 0.35
            assert np.nanmin(hip) < -0.4  # the abductors hold the pelvis in single support
            seen += 1
    assert seen == 12


def test_internal_moments_times_angular_velocity_are_the_power_of_the_file(gait_data, reader):
    """The sign needs no knowledge of walking: moment times velocity, both of dorsiflexion, is the ankle's power."""
    for path in [path for path in _people(gait_data) if "straight" in path.parts]:
        trial = read_trial(path, reader=reader)
        kinematics, moments = trial.stream("kinematics"), trial.stream("moments")
        for side in "rl":
            velocity = np.gradient(np.radians(kinematics[f"ankle_angle_{side}"]), kinematics.time)
            made = moments[f"ankle_angle_{side}_moment"] * velocity
            power = moments[f"ankle_power_{side}"]
            both = np.isfinite(made) & np.isfinite(power) & (np.abs(power) > 0.2)
            assert np.corrcoef(made[both], power[both])[0, 1] > 0.9, (path.name, side)


def parameters(**numbers: float) -> C3DParameters:
    return C3DParameters({("PROCESSING", name): np.array([number]) for name, number in numbers.items()})


@pytest.mark.parametrize(("number", "unit"), [(102.0, "mm"), (10.2, "cm"), (0.102, "m")])
def test_a_length_is_read_in_the_unit_that_makes_it_one(number, unit):
    assert dict(find_body_measures(parameters(RKNEEWIDTH=number)).knee_width_m) == {"r": pytest.approx(0.102)}


def test_zero_and_nonsense_are_not_measured():
    found = find_body_measures(parameters(RKNEEWIDTH=0.0, LKNEEWIDTH=9000.0, INTERASISDISTANCE=float("nan")))
    assert (dict(found.knee_width_m), found.inter_asis_m, found.mass_kg) == ({}, None, None)


def test_a_real_file(gait_data):
    """The numbers that stand in PROCESSING of the file, in mm there."""
    found = read_body_measures(gait_data / "young_straight_and_turn/HC032A/static/HC032A01.c3d")
    assert (found.height_m, found.inter_asis_m, found.marker_diameter_m) == (1.58, 0.228, 0.01)
    assert dict(found.knee_width_m) == {"l": 0.124, "r": 0.121}
    assert dict(found.ankle_width_m) == {"l": 0.064, "r": 0.065}
    assert dict(found.leg_length_m) == {"l": 0.805, "r": 0.8}
    assert found.mass_kg == pytest.approx(60.3)
