import numpy as np
from chapter5.reconstruct_field import BINS, FieldCell, error_counts, field_cells_table, load_cells, save_cells

from gaitdisc.saved.unit_folder import sealed_text
from gaitdisc.whole_file import write_whole


def cell(errors, **changed):
    return FieldCell(**{
        "field": "sea", "quantity": "sst", "unit": "degC", "route": "1 fixed", "split": "temporal", "model": "shred",
        "relative_l2": 0.5, "rmse": 1.0, "bias": 0.0, "sd": 1.0, "r2": 0.7, "fitted": 100, "tested": 20, "seconds": 1.0,
        "run": 0, "errors": error_counts(errors, 1.0),
    } | changed)  # fmt: skip


def test_every_error_is_counted_once_also_those_beyond():
    errors = np.random.default_rng(0).normal(size=(50, 40)) * 3
    counts = error_counts(errors, 1.0)
    assert counts.counts.sum() == 2000
    assert counts.counts[-1] >= (errors > 4).sum()
    assert (len(counts.counts), counts.edges[0], counts.edges[-1]) == (BINS, -4, 4)


def test_what_is_kept_is_found_again_unless_other_settings_made_it(tmp_path):
    kept = cell(np.array([0.1, -9.0, 0.1]))
    save_cells([kept], {"lags": (13, 8), "seed": 1}, tmp_path / "a.json")
    found = load_cells({"lags": (13, 8), "seed": 1}, tmp_path / "a.json")
    assert found is not None
    assert found[0].relative_l2 == kept.relative_l2
    np.testing.assert_array_equal(found[0].errors.counts, kept.errors.counts)
    np.testing.assert_array_equal(found[0].errors.edges, kept.errors.edges)
    assert load_cells({"lags": (25, 4), "seed": 1}, tmp_path / "a.json") is None
    assert load_cells({}, tmp_path / "b.json") is None


def test_cells_that_were_saved_under_an_earlier_name_of_their_test_snapshots_are_found_again(tmp_path):
    cells = {**vars(cell(np.zeros(3))), "errors": {"edges": [0.0, 1.0], "counts": [3]}}
    cells["judged"] = cells.pop("tested")
    write_whole(tmp_path / "a.json", sealed_text({"made_by": {}, "cells": [cells]}))
    assert [one.tested for one in load_cells({}, tmp_path / "a.json") or []] == [20]


def test_the_table_has_a_row_a_cell():
    table = field_cells_table([cell(np.zeros(3)), cell(np.zeros(3), model="linear")])
    assert table["model"].tolist() == ["shred", "linear"]
    assert "errors" not in table
