from __future__ import annotations

import pytest
from made_clinic import made_person
from texts import says

from gaitdisc.clinic.reading import contrast_of, read_beside
from gaitdisc.recording import PERCENT


def _reading(session, each=8, **changed):
    return read_beside(made_person("P01", session=session, each=each, changed=changed), None)


def test_where_the_knee_bends_more_after_is_found_and_nothing_on_the_other_side():
    bump = 15.0 * ((PERCENT >= 65) & (PERCENT <= 80))
    before = made_person("P01", session="before", each=8, spread=0.0)
    after = made_person("P01", session="after", each=8, spread=0.0, seed=1, changed={"knee_angle_l": bump})
    found = contrast_of(read_beside(before, None), read_beside(after, None))
    large = [one for one in found.spans if one.matters]
    assert [(one.variable, one.side) for one in large] == [("knee_flexion", "l")]
    assert (large[0].first, large[0].last) == (65, 80)
    assert large[0].difference == pytest.approx(15.0, abs=1.0)
    assert large[0].p < 0.025
    assert found.untested == {} and found.tested == {"l": 9, "r": 9}


def test_few_cycles_are_not_tested_and_the_reason_is_said():
    found = contrast_of(_reading("before", each=2), _reading("after", each=2))
    assert found.spans == () and found.tested == {}
    assert says(found.untested["l"], "6 units", "more", "2")
