"""Controls of the like age and speed, at the leg length of the person (Hof 1996), and a reference made of them."""

from dataclasses import replace

import numpy as np
import pytest
from made_clinic import PROVENANCE, made_person
from texts import says

from gaitdisc.clinic.clinical_reference import ReferenceLeg
from gaitdisc.clinic.like_controls import at_leg_length, described, dimensionless_speed, like_controls, list_groups
from gaitdisc.clinic.reading import read_beside
from gaitdisc.clinic.reference import Sample, bands, make_reference, spatiotemporal_limits
from gaitdisc.clinic.rules import outstanding
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import LegCurves
from gaitdisc.saved.provenance import provenance_now

ADULT_LEG, CHILD_LEG = 0.9, 0.6


def control(person, leg_m=ADULT_LEG, age=30, froude=0.45):
    """Both legs of a control, who walks at a dimensionless speed; some people a little faster than others."""
    speed = (froude + 0.002 * (person % 10)) * np.sqrt(9.81 * leg_m)
    values = {"speed_m_per_s": speed, "step_m": 0.7 * leg_m * (1 + 0.002 * (person % 10)), "stance_percent": 60.0}
    curves = {"ankle_power": np.full(101, 3.0), "knee_flexion": np.full(101, 20.0), "hip_moment": np.full(101, 0.8)}
    return tuple(ReferenceLeg(person, side, 4, 60.0, curves, values, leg_m, age) for side in "lr")


def controls(count=12, first=0, **of):
    return tuple(leg for k in range(first, first + count) for leg in control(k, **of))


def own_leg(leg_m, froude=0.45, side="l"):
    """A leg of somebody who walks as the controls do."""
    values = {"speed_m_per_s": np.full(4, froude * np.sqrt(9.81 * leg_m)), "step_m": np.full(4, 0.7 * leg_m)}
    return LegCurves(side, 4, 60.0, {}, values)


def test_equal_dimensionless_numbers_are_equal_at_any_size():
    small = at_leg_length(control(1)[0], CHILD_LEG)
    assert dimensionless_speed(small) == pytest.approx(dimensionless_speed(control(1)[0]))
    assert small.values["step_m"] == pytest.approx(0.7 * CHILD_LEG * 1.002)
    assert small.values["stance_percent"] == 60.0
    assert small.curves["hip_moment"][0] == pytest.approx(0.8 * CHILD_LEG / ADULT_LEG)
    assert small.curves["ankle_power"][0] == pytest.approx(3.0 * np.sqrt(CHILD_LEG / ADULT_LEG))
    assert small.curves["knee_flexion"][0] == 20.0


def test_a_child_is_not_called_out_for_its_size_but_for_slow_walking():
    child = {"l": own_leg(CHILD_LEG)}
    unscaled = like_controls(controls(20), tuple(child.values()), None, 8)
    noted, _ = outstanding(child, unscaled.curves, of_values=unscaled.values)
    assert {one.words for one in noted} >= {"reduced walking speed", "short steps"}
    assert says(" ".join(unscaled.words), "No value is scaled", "leg length of the person")
    scaled = like_controls(controls(20), tuple(child.values()), CHILD_LEG, 8)
    noted, _ = outstanding(child, scaled.curves, of_values=scaled.values)
    assert not [one.words for one in noted if one.words]
    assert says(" ".join(scaled.words), "controls are adults", "8 years")
    slow = {"l": own_leg(CHILD_LEG, froude=0.25)}
    noted, _ = outstanding(slow, scaled.curves, of_values=scaled.values)
    assert [one.words for one in noted if one.words] == ["reduced walking speed"]


def test_groups_of_ten_by_age_and_speed():
    children, adults = controls(12, age=9, leg_m=0.65), controls(11, first=20)
    slow = controls(10, first=40, froude=0.25)
    few = controls(9, first=60, age=70)
    groups = list_groups(children + adults + slow + few)
    # the children, all of one speed; the grown at two speeds, and all of them; nobody of nine of 70 years
    assert [len({leg.person for leg in one}) for one in groups] == [12, 10, 11, 21]
    assert says(described(groups[0]), "12 controls", "9", "9 years", "0.45", "0.47")
    assert list_groups(adults) == []


@pytest.mark.parametrize(
    ("age", "froude", "who", "words"),
    [
        (9, 0.45, range(12), "the group nearest in age."),
        (15, 0.45, range(12), "the group nearest in age."),
        (30, 0.28, range(40, 50), "the group nearest in age and speed."),
        (30, 0.60, range(20, 31), "the group nearest in age and speed."),
    ],
)
def test_a_person_is_beside_the_group_that_is_nearest(age, froude, who, words):
    legs = controls(12, age=9, leg_m=0.65) + controls(11, first=20) + controls(10, first=40, froude=0.25)
    found = like_controls(legs, (own_leg(0.8, froude),), 0.8, age)
    assert {leg.person for leg in found.group} == set(who)
    assert words in found.words[0]
    whole = set(range(12)) if age < 18 else {*range(20, 31), *range(40, 50)}
    far = froude != 0.45  # a speed that nobody of the group walks at is on the line of everybody
    assert {leg.person for leg in found.curves} == (whole if far else set(who))
    assert found.nearest == "age" and (age < 18 or says(" ".join(found.words), "distances and curves", "outside"))
    assert {leg.person for leg in found.values} == whole  # a slow walker's speed is beside that of all speeds


def test_all_of_them_and_why():
    few = like_controls(controls(8), (own_leg(ADULT_LEG),), ADULT_LEG, 30)
    assert len(few.curves) == 16 and says(few.words[0], "10", "age or speed")
    legs = controls(12, age=9) + controls(12, first=20)
    unknown = like_controls(legs, (), None, None)
    assert len(unknown.curves) == 48 and says(unknown.words[0], "age and speed", "unknown")


def test_a_band_is_at_the_speed_that_the_limits_of_its_sentences_are_at():
    """Knee flexion 20 deg at the slowest and 10 deg more for each m/s, with 1 deg of its own on either side."""
    made = controls(20)
    legs = tuple(
        replace(leg, curves={"knee_flexion": np.full(101, 20 + 10 * leg.values["speed_m_per_s"] + (leg.side == "l"))})
        for leg in made
    )
    speeds = np.array([leg.values["speed_m_per_s"] for leg in legs])
    slow, quick = (bands(legs, speed)["knee_flexion"] for speed in (speeds.min(), speeds.max()))
    assert quick.mean - slow.mean == pytest.approx(np.full(101, 10 * np.ptp(speeds)))
    limits = Sample(np.array([leg.curves["knee_flexion"][0] for leg in legs]), 20, speeds).limits(1, speeds.min())
    assert (slow.mean[0], slow.sd[0], slow.people) == pytest.approx((limits.mean, limits.sd, limits.people))
    assert slow.at_speed and not bands(legs)["knee_flexion"].at_speed
    assert not bands(legs, 10.0)["knee_flexion"].at_speed  # m/s: too far for a line


def test_a_point_that_few_legs_know_has_their_mean_and_spread_at_a_speed_too():
    made = controls(12)
    curve = np.linspace(0.0, 60.0, 101)
    ended = np.where(np.arange(101) < 90, curve, np.nan)
    legs = tuple(replace(leg, curves={"knee_flexion": curve if k < 20 else ended}) for k, leg in enumerate(made))
    few = tuple(replace(leg, curves={"knee_flexion": curve if k < 1 else ended}) for k, leg in enumerate(made))
    speed = float(np.mean([leg.values["speed_m_per_s"] for leg in made]))
    np.testing.assert_allclose(bands(legs, speed)["knee_flexion"].mean, curve, atol=1e-9)
    assert (
        np.isnan(bands(few, speed)["knee_flexion"].sd[95]) and bands(few, speed)["knee_flexion"].mean[95] == curve[95]
    )


def test_what_a_run_knows_of_size_and_age_reaches_the_reading():
    own = [made_person(f"C{k:02d}", leg_m=0.9, age_years=25, seed=5) for k in range(12)]
    reference = make_reference(own, "controls", provenance_now({}, 0, {}, ""))
    person = read_beside(replace(made_person(), leg_m=0.6, age_years=25), reference)
    assert says(person.beside[0], "12 controls", "25", "25 years", "0.41")
    assert person.spatiotemporal["speed_m_per_s"].mean == pytest.approx(1.215 * np.sqrt(0.6 / 0.9))
    assert person.spatiotemporal["step_m"].mean == pytest.approx(0.6 * 0.6 / 0.9)
    assert read_beside(made_person(), None).beside == ()


def test_limits_are_the_prediction_limits_of_a_textbook():
    """Four values 58 60 62 60 of 16 people: 60 +- t(.975, 15) 1.633 root(17/16), t = 2.131."""
    values = np.array([58.0, 60.0, 62.0, 60.0])
    found = Sample(values, 16).limits()
    reach = 2.131 * np.sqrt(8 / 3) * np.sqrt(17 / 16)
    assert (found.low, found.high) == pytest.approx((60 - reach, 60 + reach), abs=1e-3)
    assert found.band == pytest.approx((60 - 2 * np.sqrt(8 / 3), 60 + 2 * np.sqrt(8 / 3)))
    assert Sample(values, 16).limits(tests=40).high > found.high
    assert np.isinf(Sample(values[:2], 2).limits().high)


def test_limits_follow_the_speed_on_a_line_as_in_a_textbook():
    """Ten people, 40 + 10 v + rest, v of mean 1 and Sxx .32: at .4 m/s 44 +- t(.975, 8) s root(1 + 1/10 + .36/.32)."""
    speeds, rest = np.repeat([0.8, 0.8, 1.0, 1.2, 1.2], 2), np.tile([-1.0, 1.0], 5)
    sample = Sample(40 + 10 * speeds + rest, 10, speeds)
    found, spread = sample.limits(speed=0.4), np.sqrt(10 / 8)
    assert found.mean == pytest.approx(44.0)
    assert found.high - found.mean == pytest.approx(2.306 * spread * np.sqrt(1.1 + 0.36 / 0.32), rel=1e-3)
    assert found.sd == pytest.approx(spread * np.sqrt(1 + 0.36 / 0.32))
    assert sample.limits(speed=0.1).mean == pytest.approx(50.0)  # too far: .81 / .32 beyond 2, the line is not followed


def test_of_healthy_pages_one_in_twenty_speaks_of_what_is_beyond_its_limits():
    """Of 40 independent values one in 20 pages has one beyond its limits, and 4.6 % of values are outside 2 sd."""
    rng, pages, eye = np.random.default_rng(1), 0, 0
    for _ in range(200):
        values, more = rng.normal(size=(20, 40)), rng.normal(size=40)
        limits = [Sample(column, 20).limits(tests=40) for column in values.T]
        pages += any(not one.low <= value <= one.high for one, value in zip(limits, more, strict=True))
        eye += sum(not one.band[0] <= value <= one.band[1] for one, value in zip(limits, more, strict=True))
    assert pages <= 20 and 0.04 < eye / 8000 < 0.08


def test_the_first_session_of_a_person_counts_and_no_pseudonym_is_kept():
    people = [made_person("C1", session="before"), made_person("C1", session="after"), made_person("C2")]
    found = make_reference(people, "controls", PROVENANCE)
    assert found.people("walk") == 2 and len(found.of("walk")) == 4
    assert {leg.person for leg in found.of("walk")} == {1, 2}
    assert found.of("turn") == ()
    with pytest.raises(SchemaError, match=r"controls.*none.*0"):
        make_reference([], "controls", PROVENANCE)


def test_a_band_is_the_mean_and_spread_of_legs():
    legs = make_reference([made_person(f"C{k}") for k in range(3)], "", PROVENANCE).of("walk")
    band = bands(legs)["knee_flexion"]
    each = np.array([leg.curves["knee_flexion"] for leg in legs])
    np.testing.assert_allclose(band.mean, each.mean(axis=0))
    np.testing.assert_allclose(band.sd, each.std(axis=0, ddof=1))
    assert band.people == 3
    assert bands(legs[:2]) == {}
    assert spatiotemporal_limits(legs)["stance_percent"].mean == 60.0
