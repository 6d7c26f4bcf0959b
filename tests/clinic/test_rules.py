from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.clinic.rules import Rule, part_of, rules, rules_in
from gaitdisc.errors import SchemaError
from gaitdisc.results.leg_curves import BY_NAME
from gaitdisc.results.pooled_cycles import SPATIOTEMPORAL

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
    [("contact", 0, 0), ("loading", 0, 20), ("stance", 0, 60), ("late stance", 30, 60), ("push-off", 50, 75),
     ("swing", 60, 100), ("mid swing", 73, 87), ("cycle", 0, 100)],
)  # fmt: skip
def test_parts_of_a_cycle_with_foot_off_at_60_percent(part, first, last):
    found = part_of(part, 60.0)
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
    with pytest.raises(SchemaError, match=r"rule needs name, least.*0"):
        rules_in({"rules": [{**GOOD, **wrong}]})
    with pytest.raises(SchemaError, match="a name of its own"):
        rules_in({"rules": [GOOD, GOOD]})
