from __future__ import annotations

import numpy as np
import pytest
from made_clinic import made_controls, made_person

from gaitdisc.clinic.contrast import contrast_of
from gaitdisc.clinic.reading import read_beside
from gaitdisc.report.clinic.person_panels import consistency_sheet, contrast_sheet, emg_sheet, panel_numbers, sheet
from gaitdisc.results.clinical_variables import KINEMATICS, POWERS


@pytest.fixture(scope="module")
def reading():
    return read_beside(made_person(), made_controls(6))


def test_a_panel_for_every_curve_with_both_legs_band_and_counts(reading):
    panels = sheet(reading, KINEMATICS)
    assert [panel.name for panel in panels][:4] == ["pelvis_tilt", "pelvis_obliquity", "pelvis_rotation", "hip_flexion"]
    for panel in panels:
        assert [line.side for line in panel.lines] == ["l", "r"]
        assert panel.note == "L 4, R 4" and panel.band.people == 6
        assert panel.foot_off == (("l", 60.0), ("r", 60.0))
    assert len({(panel.row, panel.column) for panel in panels}) == len(panels)
    assert [panel.name for panel in sheet(reading, POWERS)] == ["ankle_power"]


def test_every_cycle_with_its_coefficient(reading):
    knee = next(panel for panel in consistency_sheet(reading) if panel.name == "knee_flexion")
    assert sum(line.look == "single" for line in knee.lines) == 8
    assert knee.note == "CMC L >0.99, R >0.99" and knee.band is None


def test_emg_is_in_percent_of_its_own_peak_over_the_normal_bar():
    (panel,) = emg_sheet(made_person())
    assert panel.title == "tibialis anterior" and panel.normal == ((0, 12), (56, 100))
    assert [float(line.values.max()) for line in panel.lines] == pytest.approx([100.0, 100.0])


def test_numbers_drawn_are_a_table_of_101_rows(reading):
    numbers = panel_numbers(sheet(reading, KINEMATICS))
    assert len(numbers) == 101
    np.testing.assert_allclose(numbers["knee_flexion_l_mean [deg]"], reading.legs["l"].mean("knee_flexion"))
    assert "knee_flexion_reference_sd [deg]" in numbers


def test_two_sets_of_cycles_lie_over_each_other(reading):
    other = read_beside(made_person(session="after", changed={"knee_angle_l": 9.0}), None)
    panels = contrast_sheet(contrast_of(reading, other), "l")
    assert [line.look for line in panels[0].lines] == ["before", "mean"]
    assert all(line.side == "l" for panel in panels for line in panel.lines)
