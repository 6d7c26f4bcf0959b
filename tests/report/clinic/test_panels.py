import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from made_clinic import made_controls, made_person
from texts import says

from gaitdisc.clinic.page_words import PageWords
from gaitdisc.clinic.panels import contrast_sheet, emg_sheet, panel_numbers, raw_numbers, sheet
from gaitdisc.clinic.reading import contrast, read_beside
from gaitdisc.processing.leg_curves import KINEMATICS, POWERS
from gaitdisc.report.curve_panels import BOTTOM, LEFT, MARGIN, TOP, Band, Line, Panel, in_rows, svg, ticks


def _panel(**fields):
    curve = np.linspace(0.0, 60.0, 101)
    given = {
        "name": "knee_flexion", "title": "knee flexion", "unit": "deg", "up": "flexion", "down": "extension",
        "note": "L 2, R 2", "lines": (Line("l", curve), Line("r", curve[::-1])),
        "band": Band(curve, np.full(101, 5.0), 6), "foot_off": (("l", 60.0),),
    }  # fmt: skip
    return Panel(**{**given, **fields})


def test_curves_lie_where_their_numbers_say():
    panel = _panel()
    drawing = svg(panel)
    root = ET.fromstring(drawing)
    low, high = (float(root.attrib[key]) for key in ("data-low", "data-high"))
    path = next(one.attrib["d"] for one in root.iter() if one.attrib.get("class") == "mean")
    places = np.array(re.findall(r"[\d.]+", path), float).reshape(-1, 2)
    assert len(places) == 101 and (places[0, 0], places[-1, 0]) == (LEFT, panel.width - MARGIN)
    values = low + (BOTTOM - places[:, 1]) / (BOTTOM - TOP) * (high - low)
    np.testing.assert_allclose(values, panel.lines[0].values, atol=(high - low) / (BOTTOM - TOP))


def test_left_and_right_differ_in_grey_print_too():
    root = ET.fromstring(svg(_panel()))
    means = [one.attrib for one in root.iter() if one.attrib.get("class") == "mean"]
    assert [one["data-side"] for one in means] == ["l", "r"]
    assert "stroke-dasharray" not in means[0] and means[1]["stroke-dasharray"]


def test_words_are_escaped_and_the_drawing_is_described():
    hostile = '<script>alert("x")</script>'
    drawing = svg(_panel(title=hostile, up=hostile))
    root = ET.fromstring(drawing)
    assert "<script" not in drawing
    assert hostile in root.attrib["aria-label"]
    alt = _panel().alt
    assert says(alt, "[deg]", "left 0.0", "60.0", "100 %") and "6 people" in alt


@pytest.mark.parametrize(("low", "high"), [(-4.2, 61.0), (0.0, 0.0031), (-1.3, 0.2), (1e3, 9e3)])
def test_ticks_are_few_and_inside(low, high):
    found = ticks(low, high)
    assert 2 <= len(found) <= 5
    assert all(low <= value <= high for value in found)


def test_bars_of_a_muscle_and_of_a_difference():
    root = ET.fromstring(svg(_panel(normal=((0, 12), (56, 100)), differs=(("l", 10, 20, True), ("r", 40, 50, False)))))
    kinds = [one.attrib.get("class") for one in root.iter() if one.tag == "rect"]
    assert kinds == ["normal", "normal", "matters", "small"]


def test_a_curve_whose_end_is_not_known_ends_there():
    curve = np.linspace(0.0, 60.0, 101)
    curve[95:] = np.nan
    panel = _panel(lines=(Line("l", curve),), band=Band(curve, np.where(np.isfinite(curve), 5.0, np.nan), 6))
    root = ET.fromstring(svg(panel))
    path = next(one.attrib["d"] for one in root.iter() if one.attrib.get("class") == "mean")
    assert len(re.findall(r"[\d.]+", path)) == 2 * 95 and "nan" not in svg(panel)
    assert "peak at 94 %" in panel.alt


def test_every_tick_is_printed_as_it_is():
    small = np.linspace(-0.16, 0.01, 101)
    root = ET.fromstring(svg(_panel(lines=(Line("l", small),), band=None)))
    said = [one.text for one in root.iter() if one.attrib.get("text-anchor") == "end" and one.text]
    assert {"−0.05", "−0.10", "−0.15"} <= set(said)


@pytest.fixture(scope="module")
def reading():
    return read_beside(made_person(), made_controls(6))


def test_a_panel_for_every_curve_with_both_legs_band_and_counts(reading):
    panels = sheet(reading, KINEMATICS)
    assert [panel.name for panel in panels][:4] == ["pelvis_tilt", "pelvis_obliquity", "pelvis_rotation", "hip_flexion"]
    for panel in panels:
        assert [line.side for line in panel.lines if line.look == "mean"] == ["l", "r"]
        assert panel.note.startswith("L 4, R 4; CMC ") and panel.band.people == 6
        assert panel.foot_off == (("l", 60.0), ("r", 60.0))
        assert sum(line.look == "single" for line in panel.lines) == 8
    assert [panel.name for panel in sheet(reading, POWERS)] == ["ankle_power"]


@pytest.mark.parametrize(("count", "spans"), [(1, [3]), (2, [3, 3]), (4, [3] * 4), (5, [2, 2, 2, 3, 3]), (9, [2] * 9)])
def test_rows_are_as_wide_as_the_sheet(count, spans):
    panels = in_rows([_panel()] * count)
    assert [one.span for one in panels] == spans
    assert {one.width for one in panels} <= {300, 456}


@pytest.mark.parametrize(
    ("offset", "ends", "words"),
    [
        (0.0, (-15.0, 75.0), "↑ flexion   ↓ extension"),
        (-30.0, (-33.6, 75.0), "(wider axis)"),
        (20.0, (-15.0, 83.6), ""),
    ],
)
def test_an_axis_is_the_same_on_all_pages_unless_a_curve_goes_beyond(offset, ends, words):
    """A curve of 0 to 60 deg, moved; 6 % of it is left beside what goes beyond."""
    curve = np.linspace(0.0, 60.0, 101) + offset
    far = Line("l", np.full(101, 200.0), "single")
    panel = PageWords().panel(_panel(lines=(Line("l", curve), far), band=None))
    assert panel.ends() == pytest.approx(ends, abs=0.1) and words in panel.signs
    assert panel.is_wider == (offset != 0.0)
    root = ET.fromstring(svg(panel))
    assert [one.text for one in root.iter() if one.attrib.get("class") == "sign"] == [panel.signs]


def test_emg_is_in_percent_of_its_own_peak_over_the_normal_bar():
    (panel,) = emg_sheet(made_person())
    assert panel.title == "tibialis anterior" and panel.normal == ((0, 12), (56, 100))
    assert [float(line.values.max()) for line in panel.lines] == pytest.approx([100.0, 100.0])
    assert (panel.note, panel.signs) == ("L 4, R 4", "peak L 220, R 220 µV")


def test_raw_emg_lies_below_its_envelope_in_microvolts():
    raw = {side: 1e-4 * np.sin(np.arange(1200.0))[:, None] + 0.003 for side in "lr"}
    (panel,) = emg_sheet(made_person(raw_emg=raw))
    assert panel.signs == "peak L 220, R 220 µV; below: raw [µV]"
    np.testing.assert_allclose(panel.raw[0].values, 1e6 * (raw["l"] - raw["l"].mean())[:, 0])
    root = ET.fromstring(svg(panel))
    paths = [one.attrib["d"] for one in root.iter() if one.attrib.get("class") == "raw"]
    x, y = np.array(re.findall(r"[\d.]+", paths[1]), float).reshape(-1, 2).T
    assert (x.min(), x.max()) == pytest.approx((LEFT, panel.width - MARGIN), abs=1.0)
    assert np.ptp(y) == pytest.approx(28.0, abs=0.5) and y.min() > BOTTOM + 20
    assert "±100" in [one.text for one in root.iter()]
    assert list(raw_numbers([panel])) == ["percent_l", "emg_ta_l [µV]", "percent_r", "emg_ta_r [µV]"]


def test_numbers_drawn_are_a_table_of_101_rows(reading):
    numbers = panel_numbers(sheet(reading, KINEMATICS))
    assert len(numbers) == 101
    np.testing.assert_allclose(numbers["knee_flexion_l_mean [deg]"], reading.legs["l"].mean("knee_flexion"))
    assert "knee_flexion_reference_sd [deg]" in numbers


def test_two_sets_of_cycles_lie_over_each_other(reading):
    other = read_beside(made_person(session="after", changed={"knee_angle_l": 9.0}), None)
    panels = contrast_sheet(contrast(reading, other))
    assert [(line.side, line.look) for line in panels[0].lines] == [(s, w) for s in "lr" for w in ("before", "mean")]
