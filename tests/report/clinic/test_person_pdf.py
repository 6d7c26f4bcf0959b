from __future__ import annotations

import numpy as np
import pytest
from made_clinic import PROVENANCE, made_controls, made_person

from gaitdisc.clinic.reading import read_beside
from gaitdisc.report.clinic.panels import Panel, sheet
from gaitdisc.report.clinic.person_pdf import draw_panel, write_person_pdf
from gaitdisc.results.clinical_reference import PersonSession
from gaitdisc.results.leg_curves import KINEMATICS


@pytest.fixture(scope="module")
def reading():
    return read_beside(made_person(), made_controls(6))


def test_a_person_is_three_pages_of_pdf_with_the_same_bytes_again(reading, tmp_path):
    person = PersonSession("P01", (reading,))
    first = write_person_pdf(person, PROVENANCE, tmp_path / "a.pdf").read_bytes()
    assert first[:5] == b"%PDF-"
    assert first.count(b"/Type /Page ") == 3
    assert write_person_pdf(person, PROVENANCE, tmp_path / "b.pdf").read_bytes() == first
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.pdf", "b.pdf"]


def test_a_panel_has_the_very_curves(reading):
    from matplotlib.figure import Figure

    panel: Panel = next(one for one in sheet(reading, KINEMATICS) if one.name == "knee_flexion")
    axes = Figure().add_axes((0, 0, 1, 1))
    draw_panel(axes, panel)
    drawn = [line.get_ydata() for line in axes.lines if len(line.get_ydata()) == 101]
    np.testing.assert_array_equal(drawn[1], reading.legs["l"].mean("knee_flexion"))
    assert axes.get_title(loc="left").splitlines() == ["knee flexion [deg]", "L 4, R 4"]


def test_a_person_without_a_kept_cycle_has_a_sheet_with_the_reason(tmp_path):
    person = made_person()
    nothing = made_person(cycles=person.cycles.assign(kept=False), curves=person.curves[:0])
    path = write_person_pdf(PersonSession("P01", (read_beside(nothing, None),)), PROVENANCE, tmp_path / "a.pdf")
    assert path.read_bytes().count(b"/Type /Page ") == 1
