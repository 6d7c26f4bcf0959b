import math
from dataclasses import replace

import pytest
from manufactured_discovery import CUBIC, manufactured

from gaitdisc.report.discovery_tables import (
    closed_share,
    data_findings,
    estimates_table,
    gap_table,
    rivals_table,
    where_table,
)


def test_an_angle_is_told_in_degrees_too():
    rows = estimates_table(manufactured()).rows
    assert rows[0][2:] == ("stiffness", "286 N m/rad", "279 N m/rad", "293 N m/rad", "")
    assert rows[1][-1] == "2.0 deg (95 % 1.9-2.1)"


def test_where_no_number_is_an_angle_no_column_is_in_degrees():
    found = manufactured()
    (effect,) = found.effects
    table = estimates_table(
        replace(found, effects=(replace(effect, estimates={"stiffness": effect.estimates["stiffness"]}),))
    )
    assert table.columns[-1] == "high"
    assert table.rows[0][2:] == ("stiffness", "286 N m/rad", "279 N m/rad", "293 N m/rad")


def test_the_gap_is_told_for_both_parts_of_the_data():
    table = gap_table(manufactured())
    assert [row[0] for row in table.rows] == ["held out", "fitted"]
    assert table.rows[0][2:] == ("3.09 deg", "0.60 deg", "0.50 deg", "99 %", "0.010")
    assert table.numbers["before"].iloc[0] == 0.054


@pytest.mark.parametrize(("sizes", "closed"), [((2.0, 1.0, 1.0), 1.0), ((2.0, 2.0, 1.0), 0.0)])
def test_closed_is_of_the_squared_gap_above_the_noise(sizes, closed):
    assert closed_share(*sizes) == closed


def test_where_nothing_stands_above_the_noise_nothing_is_closed():
    assert math.isnan(closed_share(1.0, 1.0, 1.0))


def test_where_has_share_stride_and_region():
    assert where_table(manufactured()).rows == (("at the ankle_moment port", "97 %", "12 to 55 %", "theta > 0.035"),)


def test_a_rival_is_told_with_what_would_tell_it_apart():
    table = rivals_table(manufactured(rivals=(replace(CUBIC, tied=True),)))
    assert table.rows[0][0] == "cubic stiffness"
    assert table.rows[0][3:] == ("640", "yes", "movement through a wider range, to both sides of rest")
    assert "(what was named: 812)" in table.caption


def test_findings_are_told():
    assert data_findings(manufactured()).rows[0][0] == "warning"
