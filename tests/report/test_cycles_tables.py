import numpy as np
import pytest
from made_cycles import made_cycles
from texts import says

from gaitdisc.processing.tables import (
    all_cycles,
    all_means,
    all_spatiotemporal,
    emg_counts,
    offset_words,
    overview_table,
    spatiotemporal_table,
    tabulate_left_out,
)


def test_every_cycle_stands_once_with_who_and_where():
    table = all_cycles([made_cycles(), made_cycles("P02", session="after", group="control")])
    assert len(table) == 20 and set(table["participant"]) == {"P01", "P02"}
    assert set(table[table["participant"] == "P02"]["session"]) == {"after"}
    assert list(all_cycles([]).columns) == list(table.columns)


def test_means_and_spatiotemporal_values_are_tidy():
    means = all_means([made_cycles(), made_cycles("P02", each=0)])
    assert set(means["participant"]) == {"P01"}
    assert {"channel", "unit", "side", "percent", "n", "mean", "sd"} <= set(means.columns)
    values = all_spatiotemporal([made_cycles(each=4)])
    stride = values[(values["value"] == "stride_m") & (values["side"] == "r")].iloc[0]
    assert (stride["n"], stride["mean"]) == (4, pytest.approx(1.35))
    assert stride["sd"] == pytest.approx(np.std([1.2, 1.3, 1.4, 1.5], ddof=1))


def test_the_overview_counts_cycles_plates_and_muscles():
    table = overview_table([made_cycles(each=4, out=1)])
    assert table.rows[0][4:8] == ("4 / 1", "4 / 1", "1, 1", "1 usable, 4 cycles")
    assert emg_counts(made_cycles(each=4)) == {"emg_ta_l": 4}


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({}, "–"),
        ({"detectors": {"markers": 1}, "contact_offset_s": 0.0598, "offset_steps": 1}, "+60 ms (1 step recorded by"),
        ({"detectors": {"markers": 1}, "contact_offset_s": 0.04, "offset_steps": 3}, "+40 ms (3 steps recorded by"),
        ({"detectors": {"angles": 1}}, "not shifted: no step was recorded by a plate or marked by an event"),
    ],
)
def test_by_how_much_contacts_were_moved_is_said(fields, said):
    assert offset_words(made_cycles(**fields)).startswith(said)


def test_values_of_two_conditions_stand_side_by_side():
    table = spatiotemporal_table([made_cycles(), made_cycles(condition="turn")], "P01")
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["stance [%]"] == ("60.0 ± 0.0 (4)",) * 4
    assert rows["stride length [m]"][0] == "1.35 ± 0.13 (4)"
    assert table.groups == (("", 1), ("walk", 2), ("turn", 2))


def test_what_is_left_out_has_its_reason():
    table = tabulate_left_out([made_cycles(out=1)], "P01")
    assert table is not None and len(table.rows) == 2
    assert says(table.rows[0][-1], "no", "other foot within")
    assert tabulate_left_out([made_cycles(out=0)], "P01") is None
