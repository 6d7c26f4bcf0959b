from __future__ import annotations

import xml.etree.ElementTree as ET

from made_clinic import made_controls, made_person

from gaitdisc.clinic.reading import read_beside
from gaitdisc.report.clinic.profile_chart import LEFT, RIGHT, profile_svg


def test_bars_are_as_long_as_their_scores():
    profile = read_beside(made_person(changed={"knee_angle_l": -30.0}), made_controls(6)).profile
    root = ET.fromstring(profile_svg(profile))
    bars = [float(one.attrib["width"]) for one in root.iter() if "fill-opacity" in one.attrib]
    scores = [score.value for score in (*profile.variables.values(), *profile.legs.values())]
    assert len(bars) == len(scores) == 20
    assert abs(max(bars) / min(bars) - max(scores) / min(scores)) < 0.05 * max(scores) / min(scores)
    assert max(bars) < RIGHT - LEFT
    assert "knee flexion left" in root.attrib["aria-label"]
