from dataclasses import replace


def test_tables(run):
    table = run.r2_table()
    assert table["participant"].tolist() == ["P01", "P01"]
    findings = run.findings_table()
    assert findings.loc[0, "spans_s"] == "1.00-1.10"
    assert list(replace(run, units={}).r2_table().columns) == list(table.columns)
