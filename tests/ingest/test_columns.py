"""Labels, maps and units of columns."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, UnitError
from gaitdisc.ingest.columns import check_written_names, column_in_unit, mapped_label, named_channel, split_unit


def test_units_stand_in_brackets_at_the_end():
    assert split_unit(" foo [bar] [mV] ") == ("foo [bar]", "mV")
    assert split_unit("foo []") == ("foo", "")
    assert split_unit("[x] foo") == ("[x] foo", None)


def test_labels_are_mapped_exactly_first_and_then_by_likeness_unless_two_are_alike():
    assert mapped_label("EMG 1", {"EMG 1": "a", "emg1": "b"}) == "a"
    assert mapped_label("emg-1", {"EMG 1": "a"}) == "a"
    assert mapped_label("emg-1", {"EMG 1": "a", "emg1": "b"}) is None
    assert mapped_label("x", None) is None
    assert mapped_label("--", {"..": "a"}) is None


@pytest.mark.parametrize(
    ("name", "quantity", "unit", "side"),
    [
        ("ankle_angle_r", "angle", "deg", "r"),
        ("emg_sol_l", "emg", "V", "l"),
        ("emg_gracilis_r", "emg", "V", "r"),
        ("RHEE.z", "marker", "m", ""),
        ("wrist_flex_l_moment", "moment", "N m", "l"),
        ("pelvis_tx_force", "force", "N", ""),
        ("knee_angle_r_beta_force", "moment", "N m", "r"),
        ("sync", "signal", "1", ""),
    ],
)
def test_names_tell_quantities(name, quantity, unit, side):
    channel = named_channel(name)
    assert (channel.quantity, channel.unit, channel.side) == (quantity, unit, side)


@pytest.mark.parametrize(
    ("name", "unit", "inside", "one"),
    [
        ("knee_angle_r", "rad", "deg", np.degrees(1.0)),
        ("pelvis_tx", "mm", "m", 1e-3),
        ("ground_force_r_vy", "kN", "N", 1e3),
        ("ankle_angle_r_moment", "Nmm", "N m", 1e-3),
        ("ankle_angle_r_moment", "N m/kg", "N m/kg", 1.0),
        ("emg_sol_r", "uV", "V", 1e-6),
        ("emg_sol_r", "%", "%", 1.0),
        ("trigger", "mV", "V", 1e-3),
        ("gyro", "rad/s", "deg/s", np.degrees(1.0)),
    ],
)
def test_stated_units_are_converted_to_those_inside(name, unit, inside, one):
    column = column_in_unit(name, named_channel(name), unit, "a.csv")
    assert column.channel.unit == inside
    assert column.converted(np.array([1.0]))[0] == pytest.approx(one, rel=1e-12)


def test_the_rate_of_an_angle_is_not_the_angle():
    column = column_in_unit("x", named_channel("knee_angle_r"), "deg/s", "a.csv")
    assert (column.channel.name, column.channel.quantity) == ("knee_angle_r/speed", "signal")


def test_an_unknown_unit_and_one_of_another_quantity_are_refused():
    with pytest.raises(UnitError, match=r"a\.csv.*'F'.*'Nn'.*'N'"):
        column_in_unit("F", named_channel("ground_force_r_vy"), "Nn", "a.csv")
    with pytest.raises(UnitError, match=r"'k'.*knee_angle_r.*'mm'"):
        column_in_unit("k", named_channel("knee_angle_r"), "mm", "a.csv")


def test_names_that_a_text_table_cannot_hold_are_refused():
    check_written_names(["R Tib Ant", "µ"], "a.csv")
    for name in ("a\tb", "a\nb", " a"):
        with pytest.raises(ChannelError, match=r"a\.csv.*table holds names"):
            check_written_names([name], "a.csv")


def test_a_column_without_rate_is_converted_whole():
    assert column_in_unit("x", Channel("x", "signal", "1"), "1", "a").converted(np.array([2.0])) == 2.0
