"""Widths and lengths of a person from the parameters of a C3D file."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.ingest.c3d_kinetics import body_measures_of, read_body_measures
from gaitdisc.ingest.c3d_parameters import C3DParameters


def parameters(**numbers: float) -> C3DParameters:
    return C3DParameters({("PROCESSING", name): np.array([number]) for name, number in numbers.items()})


@pytest.mark.parametrize(("number", "unit"), [(102.0, "mm"), (10.2, "cm"), (0.102, "m")])
def test_a_length_is_read_in_the_unit_that_makes_it_one(number, unit):
    assert dict(body_measures_of(parameters(RKNEEWIDTH=number), "a.c3d").knee_width_m) == {"r": pytest.approx(0.102)}


def test_zero_and_nonsense_are_not_measured():
    found = body_measures_of(parameters(RKNEEWIDTH=0.0, LKNEEWIDTH=9000.0, INTERASISDISTANCE=float("nan")), "a.c3d")
    assert (dict(found.knee_width_m), found.inter_asis_m, found.mass_kg) == ({}, None, None)


def test_a_real_file(gait_data):
    """The numbers that stand in PROCESSING of the file, in mm there."""
    found = read_body_measures(gait_data / "young_straight_and_turn/HC032A/static/HC032A01.c3d")
    assert (found.height_m, found.inter_asis_m, found.marker_diameter_m) == (1.58, 0.228, 0.01)
    assert dict(found.knee_width_m) == {"l": 0.124, "r": 0.121}
    assert dict(found.ankle_width_m) == {"l": 0.064, "r": 0.065}
    assert dict(found.leg_length_m) == {"l": 0.805, "r": 0.8}
    assert found.mass_kg == pytest.approx(60.3)
    assert found.source == "HC032A01.c3d"
