from dataclasses import replace

import pytest

from gaitdisc.report.r2 import study_r2_table
from gaitdisc.report.run_tables import dropped_table, findings_table, fits_table, refusals_table, walks_table

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def test_walks_have_their_light(run_maker):
    table = walks_table(run_maker(outputs=OUTPUTS))
    assert [row[0] for row in table.rows] == ["light:green:notes only", "light:amber:warnings"]
    kept = table.numbers.loc[0, "kept_r"]
    assert table.rows[0][6].startswith(f"right {kept} / ")


def test_refusals_findings_and_drops(run_maker, refusal):
    run = run_maker(outputs=OUTPUTS, refusals=(refusal,))
    assert refusals_table(run).rows == (("P13", "spring", refusal.reason),)
    findings = findings_table(run)
    assert findings.rows[0][0] == "warning"
    assert findings.rows[0][1:3] == ("P01 spring", "P01_spring.mot, knee_angle_r")
    assert findings.rows[0][3] == "gap: 0.12 s missing (from-to: 12.31-12.43; 40.10-40.22 s)"
    assert len(findings.rows) == 3
    dropped = dropped_table(run, "P01", "P01")
    assert sum(int(row[3]) for row in dropped.rows) == len(dropped.numbers)
    clean = replace(run, walks=tuple(replace(w, strides=w.strides.assign(kept=True)) for w in run.walks))
    assert dropped_table(clean, "P01", "P01") is None


def test_fits(run_maker):
    table = fits_table(run_maker(outputs=OUTPUTS))
    assert table.rows[0] == ("P01", "Nominal", "network", "0.1", "40", "5214", "782")
    assert "n = 6" in table.caption
    assert fits_table(run_maker(0)).rows == ()


@pytest.mark.parametrize("participants", [1, 2])
def test_every_table_has_cells_for_its_columns(run_maker, refusal, participants):
    run = run_maker(participants, outputs=OUTPUTS, refusals=(refusal,))
    for table in (walks_table(run), refusals_table(run), findings_table(run), fits_table(run), study_r2_table(run)):
        assert {len(row) for row in table.rows} == {len(table.columns)}
