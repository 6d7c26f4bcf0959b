from __future__ import annotations

import re

import pandas as pd
from made_clinic import made_controls, made_person, made_run
from texts import says

from gaitdisc.clinic.reading import read_beside
from gaitdisc.report.clinic.person_page import write_index
from gaitdisc.results.clinical_reference import PersonSession
from gaitdisc.results.provenance import Refusal


def test_refused_first_then_amber_then_green_each_with_why_and_link(tmp_path):
    reference = made_controls(20)
    good, few = made_person("P01"), made_person("P02", each=2, changed={"knee_angle_l": -40.0})
    run = made_run(good, few, refusals=(Refusal("P09", "", "no walk. Record again."),))
    sessions = [(PersonSession(one.subject, (read_beside(one, reference),)), one.subject) for one in (good, few)]
    text = write_index(run, sessions, reference, tmp_path).read_text(encoding="utf-8")
    rows = re.findall(r'<td class="light (\w+)">.*?<th scope="row">(.*?)</th>', text)
    assert rows == [
        ("red", "P09"),
        ("amber", '<a href="people/P02.html">P02</a>'),
        ("green", '<a href="people/P01.html">P01</a>'),
    ]
    assert says(text, "no walk. Record again") and says(text, "2 left, 2 right")
    assert "Knee" in text or "knee" in text
    assert says(text, "3 people; 1 refused, 1", "amber, 1 green")
    assert len(pd.read_csv(tmp_path / "tables" / "people.csv")) == 3


def test_an_index_of_nobody_but_refused_people_still_stands(tmp_path):
    run = made_run(refusals=(Refusal("P01", "", "<b>no</b> walk"),))
    text = write_index(run, [], None, tmp_path).read_text(encoding="utf-8")
    assert "&lt;b&gt;no" in text and "No reference" in text
