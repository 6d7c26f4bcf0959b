import numpy as np
import pandas as pd
import pytest

from gaitdisc.chapters.pages.sensor_sets_table import MEASURES, sensor_sets_table


@pytest.fixture
def table():
    rows = [
        {"data": "cohort", "sensors": "1 sagittal", "participant": f"P{k}", "model": model,
         **dict.fromkeys(MEASURES, value + 0.1 * k)}
        for k in range(3) for model, value in (("linear", 2.0), ("delay ridge", 1.0))
    ]  # fmt: skip
    printed = pd.DataFrame({"sensors": ["1 sagittal"], "model": ["linear"], "mean": [1.083], "sd": [0.705]})
    return sensor_sets_table(pd.DataFrame(rows), printed, "sets", "temporal")


def test_mean_interval_and_deviation_over_participants(table):
    row = dict(zip(table.columns, table.rows[0], strict=True))
    half = 4.3027 * 0.1 / np.sqrt(3)
    assert row["RMSE [deg]"] == f"2.10 [{2.1 - half:.2f}, {2.1 + half:.2f}]"
    assert row["relative L2 with sensors ± sd [1]"] == "2.100 ± 0.100"


def test_what_is_printed_stands_beside_it_and_nothing_where_nothing_is(table):
    assert [row[-2] for row in table.rows] == ["1.083 ± 0.705", "–"]


def test_the_caption_says_what_the_printed_numbers_are(table):
    assert "calls the norm of the error" in table.caption
    assert "no claim of better or worse is made" in table.caption
