from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gaitdisc.errors import SchemaError, ShapeError
from gaitdisc.results.participant_response import QUANTITY, QUANTITY_COLUMNS, DataQuantity


def test_r2_of(response):
    assert response.r2_of("hip_flexion_r", "nominal") == pytest.approx(0.3)
    assert np.isnan(response.r2_of("hip_flexion_r", "augmented"))


def test_columns_fit_the_outputs(response):
    with pytest.raises(ShapeError, match=r"residuals\[nominal\].*2.*P01"):
        replace(response, residuals={"nominal": np.zeros((3, 101, 2))})
    with pytest.raises(ShapeError, match="101 points a stride"):
        replace(response, residuals={"nominal": np.zeros((3, 51, 1))})


@pytest.fixture
def quantity():
    rows = [
        (length, int(length * 100), variable, model, "network", "exo", r2, 300)
        for length, low in ((1.0, 0.1), (10.0, 0.6))
        for variable, more in (("knee", 0.0), ("ankle", 0.2), ("hip", 0.3))
        for model, r2 in (("nominal", low + more), ("exo", low + more + 0.05))
    ]
    return DataQuantity("P01", "first", pd.DataFrame(rows, columns=pd.Index(QUANTITY_COLUMNS)), {500.0: "too long"})


def test_medians_over_variables(quantity):
    medians = quantity.medians()
    assert medians.loc[1.0, "nominal"] == pytest.approx(0.3)
    assert medians.loc[10.0, "exo"] == pytest.approx(0.85)


def test_it_comes_back_as_it_was(quantity, tmp_path):
    QUANTITY.save(quantity, tmp_path, "key")
    loaded, key = QUANTITY.load_keyed(tmp_path)
    assert (loaded.participant, loaded.part, loaded.left_away, key) == ("P01", "first", {500.0: "too long"}, "key")
    pd.testing.assert_frame_equal(loaded.table, quantity.table, check_dtype=False)


def test_a_table_without_its_columns(quantity):
    with pytest.raises(SchemaError, match="that of P01 lacks n_training"):
        DataQuantity("P01", "first", quantity.table.drop(columns="n_training"), {})
