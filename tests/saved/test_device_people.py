import numpy as np
import pytest
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.discovery.discover_device import NOTHING, lines, over_people
from gaitdisc.discovery.result import Estimate, FoundEffect


def spring(stiffness):
    estimates = {"stiffness": Estimate(stiffness, stiffness - 9, stiffness + 9, "N m/rad")}
    return manufactured(effects=(FoundEffect("port", "ankle_moment", "one_sided_spring", "", estimates),))


def test_an_effect_is_said_with_who_shows_it_and_an_interval_over_people():
    found = {"W01": spring(200.0), "W02": spring(300.0), "W03": spring(280.0), "W04": manufactured(effects=())}
    table = over_people(found)
    row = table.iloc[0]
    assert (row["effect"], row["people"], row["of"]) == ("one_sided_spring", 3, 4)
    assert row["who"].split(", ") == ["W02 300", "W03 280", "W01 200"]
    half = 4.302653 * np.std([200.0, 300.0, 280.0], ddof=1) / np.sqrt(3)  # Student's t, 2 degrees of freedom
    assert (row["mean"], row["low"]) == (pytest.approx(260.0), pytest.approx(260.0 - half, rel=1e-6))
    assert says(lines(table)[0], "one_sided_spring", "ankle_moment", "3 of 4, mean 260", "(95 %")
    assert says(lines(table)[1], "nothing", "1 of 4: W04")
    assert (table.iloc[1]["effect"], table.iloc[1]["who"]) == (NOTHING, "W04")


def test_one_person_has_no_interval_over_people():
    row = over_people({"W01": spring(200.0)}).iloc[0]
    assert np.isnan(row["low"])
