import numpy as np

from gaitdisc.results.field_cell import BINS, FieldCell, error_counts, field_cells_table, shares_within


def cell(errors, **changed):
    return FieldCell(**{
        "field": "sea", "quantity": "sst", "unit": "degC", "route": "1 fixed", "split": "temporal", "model": "shred",
        "relative_l2": 0.5, "rmse": 1.0, "bias": 0.0, "sd": 1.0, "r2": 0.7, "fitted": 100, "judged": 20, "seconds": 1.0,
        "run": 0, "errors": error_counts(errors, 1.0),
    } | changed)  # fmt: skip


def test_every_error_is_counted_once_also_those_beyond():
    errors = np.random.default_rng(0).normal(size=(50, 40)) * 3
    counts = error_counts(errors, 1.0)
    assert counts.counts.sum() == 2000
    assert counts.counts[-1] >= (errors > 4).sum()
    assert (len(counts.counts), counts.edges[0], counts.edges[-1]) == (BINS, -4, 4)


def test_a_gaussian_has_two_thirds_within_one_sd():
    found = shares_within(cell(np.random.default_rng(0).normal(size=200_000)))
    assert abs(found["within one sd"] - 0.683) < 0.02


def test_the_table_has_a_row_a_cell():
    table = field_cells_table([cell(np.zeros(3)), cell(np.zeros(3), model="linear")])
    assert table["model"].tolist() == ["shred", "linear"]
    assert "errors" not in table
