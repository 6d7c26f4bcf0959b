import pandas as pd
import pytest

from gaitdisc.discrepancy.cell import cell_of
from gaitdisc.discrepancy.recommend import COLUMNS, measured_cells, recommend
from gaitdisc.errors import SchemaError

ROWS = [
    ("Van der Pol", "sindy", 0.01, 90.0, 20.0, 0.5, 0.0, 3),
    ("Van der Pol", "dmd", 0.01, 40.0, 20.0, 2.0, 0.0, 3),
    ("Van der Pol", "gp", 0.01, 97.0, 20.0, 5.0, 0.0, 3),
    ("Van der Pol", "nn", 0.01, 94.0, 20.0, 3.0, 0.0, 3),
    ("Van der Pol", "sindy", 0.1, -5.0, 3.0, 0.5, 0.0, 3),
    ("Van der Pol", "gp", 0.1, 60.0, 9.0, 5.0, 0.4, 3),
]
TABLE = pd.DataFrame(ROWS, columns=list(COLUMNS))


@pytest.mark.parametrize(("want", "method"), [("interpretability", "sindy"), ("speed", "nn"), ("forecast", "gp")])
def test_the_measured_cells_decide(want, method):
    found = recommend(0.008, 3000, want, evidence=TABLE)
    assert found.method == method
    assert "Measured at 1.0% noise" in found.why
    assert len(found.evidence) == 4


def test_what_diverged_or_lost_is_not_recommended():
    found = recommend(0.1, 3000, "forecast", evidence=TABLE)
    assert found.method == ""
    assert "none of the methods" in found.why


def test_a_short_record_is_warned_of():
    assert "this record has 200" in recommend(0.01, 200, "forecast", evidence=TABLE).why


def test_another_want_and_other_columns_are_refused():
    with pytest.raises(SchemaError, match="found 'beauty'"):
        recommend(0.01, 200, "beauty", evidence=TABLE)
    with pytest.raises(SchemaError, match="noise, accuracy missing"):
        recommend(0.01, 200, "speed", evidence=TABLE.drop(columns=["noise", "accuracy"]))


def test_evidence_is_made_of_cells(quiet):
    row = measured_cells([cell_of(quiet, "sindy", "dynamics")]).iloc[0]
    assert (row["method"], row["diverged"], row["seeds"]) == ("sindy", 0, 1)
    assert row["accuracy"] > 99
