import numpy as np
import pytest

from gaitdisc.errors import SchemaError, ShapeError, UnitError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.body_inertia import FootPoints, Person, inertia_table, leg_inertia, segment_lengths

LENGTHS = {"shank": 0.42, "thigh": 0.41}
FOOT = FootPoints(np.array([-0.05, -0.06, 0.0]), np.array([0.13, -0.06, 0.0]))


# Sums of the columns that the papers print, rounding included
@pytest.mark.parametrize(
    ("table", "sex", "total"),
    [("dumas2007", "f", 99.9), ("dumas2007", "m", 100.2), ("deleva1996", "f", 99.99), ("deleva1996", "m", 100.0)],
)
def test_the_segments_of_a_table_make_a_whole_body(table, sex, total):
    rows = inertia_table(table, sex).values()
    assert sum(row.mass * row.count for row in rows) == pytest.approx(total, abs=1e-9)


@pytest.mark.parametrize("table", ["dumas2007", "deleva1996"])
@pytest.mark.parametrize("sex", ["f", "m", ""])
def test_a_leg_is_a_body_of_positive_inertia_and_the_other_its_mirror(table, sex):
    person = Person(70.0, sex, 1.74)
    right, left = (leg_inertia(person, side, LENGTHS, FOOT, table) for side in "rl")
    mirror = np.diag([1.0, 1.0, -1.0])
    for segment, body in right.items():
        one, two, three = np.linalg.eigvalsh(body.tensor)
        assert one > 0 and one + two > three, segment  # what any distribution of mass fulfils
        assert left[segment].mass_kg == body.mass_kg
        assert left[segment].centre == pytest.approx(mirror @ body.centre)
        assert left[segment].tensor == pytest.approx(mirror @ body.tensor @ mirror)


def test_numbers_of_the_tables():
    thigh = leg_inertia(Person(70.0, "m"), "r", LENGTHS, FOOT)["thigh"]
    assert thigh.mass_kg == pytest.approx(0.123 * 70)
    assert thigh.centre == pytest.approx(0.41 * np.array([-0.041, -0.429, 0.033]))
    assert np.sqrt(np.diag(thigh.tensor) / thigh.mass_kg) == pytest.approx(0.41 * np.array([0.29, 0.15, 0.30]))
    shank = leg_inertia(Person(50.0, "f", 1.6), "l", LENGTHS, FOOT, "deleva1996")["shank"]
    assert (shank.mass_kg, shank.centre[1]) == pytest.approx((0.0481 * 50, -0.4352 * 0.42))


def test_de_levas_foot_lies_between_heel_and_toe_tip():
    foot = leg_inertia(Person(70.0, "m", 1.741), "r", LENGTHS, FOOT, "deleva1996")["foot"]
    assert foot.centre == pytest.approx([-0.05 + 0.4415 * 0.2581, -0.06, 0.0])
    assert np.sqrt(np.diag(foot.tensor) / foot.mass_kg) == pytest.approx(0.2581 * np.array([0.124, 0.245, 0.257]))


def test_an_unknown_sex_takes_the_mean():
    masses = [leg_inertia(Person(60.0, sex), "r", LENGTHS, FOOT)["thigh"].mass_kg for sex in ("f", "m", "")]
    assert masses[2] == pytest.approx((masses[0] + masses[1]) / 2)


@pytest.mark.parametrize("mass", [0.7, 700.0, -60.0])
def test_a_mass_that_is_no_persons_is_refused(mass):
    with pytest.raises(UnitError, match=rf"mass.*5.*300 kg.*mass.*{mass:g} kg"):
        Person(mass)


@pytest.mark.parametrize("mass", [None, np.nan])
def test_a_person_without_mass_is_refused(mass):
    with pytest.raises(UnitError, match=r"mass.*none.*PROCESSING:BODYMASS"):
        Person(mass)


def test_what_fits_no_leg_is_refused():
    with pytest.raises(SchemaError, match=r"'f'.*'m'.*the sex given.*'w'"):
        Person(60.0, "w")
    with pytest.raises(UnitError, match=r"thigh.*0.1.*0.8 m.*thigh_r.*410 m"):
        leg_inertia(Person(60.0), "r", {"shank": 0.4, "thigh": 410.0}, FOOT)
    with pytest.raises(UnitError, match=r"the person's stature.*no"):
        leg_inertia(Person(60.0, "f"), "r", LENGTHS, FOOT, "deleva1996")
    with pytest.raises(SchemaError, match="dumas2007, deleva1996; 'winter'"):
        leg_inertia(Person(60.0), "r", LENGTHS, FOOT, "winter")


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
