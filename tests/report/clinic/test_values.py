import xml.etree.ElementTree as ET

from made_clinic import made_controls, made_person

from gaitdisc.clinic.reading import read_beside
from gaitdisc.clinic.values import LEFT, RIGHT, numbers_table, profile_svg, profile_table, values_table


def test_values_of_both_legs_beside_the_reference_with_asymmetry():
    table = values_table(read_beside(made_person(), made_controls(6)))
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["stance [%]"] == ("60.0 ± 0.0 (4)", "60.0 ± 0.0 (4)", "60.0 ± 0.0", "0 %")
    assert rows["cadence [steps/min]"][0] == "120 ± 0 (4)"
    assert set(table.numbers["value"]) >= {"speed_m_per_s", "width_m"}
    alone = values_table(read_beside(made_person(), None))
    assert alone.rows[0][3] == "–" and "no reference" in alone.caption


def test_all_that_stands_out_and_the_profile_have_their_numbers():
    reading = read_beside(made_person(changed={"knee_angle_l": -40.0}), made_controls(20))
    table = numbers_table(reading)
    assert len(table.rows) == len(reading.numbers) > 30 and len(reading.noted) > 1
    assert table.rows[0][-1] != "–" and table.rows[-1][-1] == "–"
    assert f"(standing out: {len(reading.noted)})" in table.caption
    profile = profile_table(reading)
    assert len(profile.rows) == 9 and len(profile.numbers) == 18
    assert profile_table(read_beside(made_person(), None)) is None


def test_bars_are_as_long_as_their_scores():
    profile = read_beside(made_person(changed={"knee_angle_l": -30.0}), made_controls(6)).profile
    root = ET.fromstring(profile_svg(profile))
    bars = [float(one.attrib["width"]) for one in root.iter() if "fill-opacity" in one.attrib]
    scores = [score.value for score in (*profile.variables.values(), *profile.legs.values())]
    assert len(bars) == len(scores) == 20
    assert abs(max(bars) / min(bars) - max(scores) / min(scores)) < 0.05 * max(scores) / min(scores)
    assert max(bars) < RIGHT - LEFT
    assert "knee flexion left" in root.attrib["aria-label"]
