"""Rules of what stands out: the table that holds them, and what each of them finds."""

from dataclasses import replace

import numpy as np
import pytest
from made_clinic import ANKLE, made_controls, made_person
from texts import says

from gaitdisc.clinic.rules import Rule, find_part, outstanding, rules, rules_in
from gaitdisc.clinic.sentences import write_noted
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import BY_NAME, make_legs
from gaitdisc.processing.pooled_cycles import SPATIOTEMPORAL
from gaitdisc.recording import PERCENT

GOOD = {"name": "a", "variable": "knee_flexion", "part": "swing", "take": "max", "least": 5.0, "less": "reduced"}


def test_every_rule_of_the_table_names_what_is_there():
    assert len(rules()) >= 20
    for rule in rules():
        assert rule.variable in BY_NAME or rule.value in SPATIOTEMPORAL
        assert rule.less or rule.more


def test_no_rule_is_a_diagnosis():
    words = " ".join(rule.less + " " + rule.more for rule in rules())
    for word in ("spastic", "paresis", "weak", "crouch", "stiff", "equinus", "contracture", "drop foot"):
        assert word not in words


@pytest.mark.parametrize(
    ("part", "first", "last"),
    [("contact", 0, 0), ("loading", 0, 20), ("mid stance", 23, 37), ("stance", 0, 60), ("late stance", 30, 60),
     ("push-off", 50, 75), ("swing", 60, 100), ("mid swing", 73, 87), ("cycle", 0, 100)],
)  # fmt: skip
def test_parts_of_a_cycle_with_foot_off_at_60_percent(part, first, last):
    found = find_part(part, 60.0)
    assert (found.start, found.stop - 1) == (first, last)


def test_a_rule_takes_its_number_and_none_where_it_cannot():
    (rule,) = rules_in({"rules": [GOOD]})
    curves = {"knee_flexion": np.arange(101.0)}
    assert rule.number(curves, {}, 60.0) == 100.0
    assert rule.number(curves, {}, float("nan")) is None
    assert rule.number({}, {}, 60.0) is None
    speed = Rule("speed", "", "speed_m_per_s", "", "", 0.1, "reduced speed", "")
    assert (speed.number({}, {"speed_m_per_s": 1.2}, 60.0), speed.unit, speed.digits) == (1.2, "m/s", 2)


@pytest.mark.parametrize(
    "wrong",
    [{"least": 0.0}, {"least": 5}, {"variable": "elbow"}, {"part": "start"}, {"less": ""}, {"value": "speed_m_per_s"}],
)
def test_a_rule_that_cannot_be_applied_is_refused(wrong):
    with pytest.raises(SchemaError, match=r"rule must have name, least.*0"):
        rules_in({"rules": [{**GOOD, **wrong}]})
    with pytest.raises(SchemaError, match="each rule must have its own name"):
        rules_in({"rules": [GOOD, GOOD]})


@pytest.fixture(scope="module")
def reference():
    return made_controls(20).of("walk")


def test_a_knee_that_bends_little_in_swing_is_found_with_its_number_limits_and_cycles(reference):
    person = made_person("P01", spread=0.0, changed={"knee_angle_l": -0.45 * 55 * (PERCENT > 55)})
    numbers, why = outstanding(make_legs(person), reference)
    first, noted = numbers[0], [one for one in numbers if one.words]
    assert (first.words, first.side, why) == ("reduced knee flexion in swing", "l", "")
    assert first.value == pytest.approx(60 - 0.45 * 55, abs=0.5)
    assert first.value < first.limits.low < 60 < first.limits.high
    assert (first.cycles, first.limits.people) == (4, 20)
    assert first.excess > 1 and len(numbers) > 30
    assert {one.side for one in noted} == {"l"}


def test_a_foot_that_drops_in_swing_is_found(reference):
    person = made_person("P01", spread=0.0, changed={"ankle_angle_r": -15.0 * (PERCENT > 60)})
    noted, _ = outstanding(make_legs(person), reference)
    assert ("reduced dorsiflexion in swing", "r") in [(one.words, one.side) for one in noted]
    assert ANKLE[80] == pytest.approx(0.0, abs=0.1)


def test_of_forty_more_healthy_people_few_pages_say_anything(reference):
    """5 % of pages are allowed; of 40 more than 6 would have a chance of 1 %."""
    pages = [outstanding(make_legs(made_person(f"H{k:02d}", seed=9)), reference)[0] for k in range(40)]
    assert sum(any(one.words for one in page) for page in pages) <= 6


def test_what_is_beyond_the_limits_by_less_than_matters_is_not_spoken_of():
    alike = made_controls(20).of("walk")
    rule = {"name": "a", "variable": "knee_flexion", "part": "contact", "take": "mean", "least": 400.0, "more": "more"}
    person = make_legs(made_person("P01", changed={"knee_angle_l": 300.0}))
    assert [one.words for one in outstanding(person, alike, rules_in({"rules": [rule]}))[0]] == ["", "", ""]
    found = outstanding(person, alike, rules_in({"rules": [{**rule, "least": 200.0}]}))[0]
    assert [(one.words, one.side, one.other) for one in found] == [("more", "l", ""), ("", "l", "r"), ("", "r", "")]


def test_too_few_controls_say_nothing_in_words():
    numbers, why = outstanding(make_legs(made_person()), made_controls(4).of("walk"))
    assert numbers == ()
    assert says(why, "5 people", "4 people")


def _of_leg(side, numbers):
    (found,) = [one for one in numbers if one.side == side and not one.other]
    return found


def test_legs_that_differ_more_than_those_of_controls_are_noted_where_neither_is_unusual_by_itself(reference):
    rule = {"name": "knee in swing", "variable": "knee_flexion", "part": "swing", "take": "max", "least": 1.0}
    table = rules_in({"rules": [{**rule, "less": "reduced", "more": "increased"}]})
    alike = _of_leg("l", outstanding(make_legs(made_person("P01", spread=0.0)), reference, table)[0])
    even = [
        replace(leg, curves={"knee_flexion": reference[k // 2 * 2].curves["knee_flexion"] + 0.1 * (k % 2)})
        for k, leg in enumerate(reference)
    ]
    less = 1.2 * alike.limits.sd
    legs = make_legs(made_person("P01", spread=0.0, changed={"knee_angle_l": -less, "knee_angle_r": 0.5 * less}))
    for controls, tier in ((even, 2), (reference, 0)):
        numbers, _ = outstanding(legs, controls, table)
        (sides,) = [one for one in numbers if one.other]
        assert (sides.side, sides.other, sides.tier, sides.words) == ("l", "r", tier, "knee in swing" if tier else "")
        assert sides.value == pytest.approx(-1.5 * less, abs=0.2) and sides.limits.mean == pytest.approx(0.0)
        assert sides.limits.people == 20 and [one.tier for one in numbers if not one.other] == [0, 0]
    (said,) = write_noted(outstanding(legs, even, table)[0][:1], 2)
    assert said.startswith("Knee in swing: left") and says(
        said, "deg less than right", "neither leg stands out", "limits", "20 people"
    )
    few = {side: replace(leg, cycles={name: one[:2] for name, one in leg.cycles.items()}) for side, leg in legs.items()}
    assert not any(one.tier for one in outstanding(few, even, table)[0])


def test_a_number_that_prints_as_the_limit_is_not_beyond_it(reference):
    """0.3 deg below the limit is said only where the limit itself prints as a larger number."""
    rule = {"name": "a", "variable": "knee_flexion", "part": "swing", "take": "max", "least": 5.0, "less": "less"}
    plain, table = made_person("P01", spread=0.0), rules_in({"rules": [rule]})
    usual = _of_leg("l", outstanding(make_legs(plain), reference, table)[0])
    for shown, words in ((round(usual.limits.low), ""), (round(usual.limits.low) - 1, "less")):
        person = made_person("P01", spread=0.0, changed={"knee_angle_l": shown - usual.value})
        found = _of_leg("l", outstanding(make_legs(person), reference, table)[0])
        assert (round(found.value), found.words) == (shown, words)
    edge = made_person("P01", spread=0.0, changed={"knee_angle_l": usual.limits.low - 0.02 - usual.value})
    found = _of_leg("l", outstanding(make_legs(edge), reference, table)[0])
    assert found.value < found.limits.low and (found.words == "") == (round(found.value) == round(found.limits.low))
