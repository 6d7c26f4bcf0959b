from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.recording import Finding
from gaitdisc.report.tables import (
    dropped_table,
    findings_table,
    fits_table,
    not_computed,
    pairs_table,
    participants_table,
    r2_table,
    refusals_table,
    study_r2_table,
    walks_table,
)

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def test_r2_of_one_participant(run_maker):
    [response] = run_maker(outputs=OUTPUTS).responses
    table = r2_table(response, "P01")
    assert [row[0] for row in table.rows] == ["hip flexion, right [deg/s²]", "ankle angle, left [deg/s²]", "median"]
    assert table.rows[1][3] == f"{response.r2_of('ankle_angle_l', 'augmented'):.2f}"
    assert table.rows[-1][-1] == "0.51"
    assert sum(span for _, span in table.groups) == len(table.columns) == len(table.rows[0])
    assert "n = 749 samples of the device walk and 749" in table.caption
    assert "split: last 7.5 s" in table.caption
    assert table.numbers.loc[1, "augmented_on_exo"] == response.r2_of("ankle_angle_l", "augmented")


def test_a_number_that_is_missing_says_so_and_why(run_maker):
    run = run_maker(outputs=OUTPUTS)
    [response] = run.responses
    rows = response.r2["variable"] == "ankle_angle_l"
    response.r2.loc[rows, "r2"] = np.nan
    assert r2_table(response, "P01").rows[1][1] == "not computed"
    assert not_computed(run, response) == ["ankle angle, left: the run holds no number and no reason for it"]
    response.r2.loc[rows, "n"] = 0
    assert not_computed(run, response) == ["ankle angle, left: no usable sample in the held-out part (n = 0)"]
    dead = Finding("warning", "dead", "a.mot", "constant 0 deg", "this channel", "ankle_angle_l")
    run = replace(run, walks=(replace(run.walks[0], findings=(dead,)),))
    assert not_computed(run, response) == [
        "ankle angle, left: warning: a.mot, ankle_angle_l: dead: constant 0 deg; spoils this channel"
    ]


def test_several_participants(run_maker):
    run = run_maker(3, outputs=OUTPUTS)
    people = participants_table(run)
    assert [row[0] for row in people.rows] == ["P01", "P02", "P03", "median"]
    assert people.rows[0][1] == "749"
    study = study_r2_table(run)
    values = [r.r2_of("hip_flexion_r", "exo") for r in run.responses]
    q1, middle, q3 = np.quantile(values, [0.25, 0.5, 0.75])
    assert study.rows[0][5] == f"{middle:.2f}\n[{q1:.2f}, {q3:.2f}]"
    assert study.rows[0][1] == "3"
    assert "n = 3 participants" in study.caption


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
    assert findings.rows[0][7] == "12.31-12.43; 40.10-40.22"
    assert len(findings.rows) == 3
    dropped = dropped_table(run, "P01", "P01")
    assert sum(int(row[3]) for row in dropped.rows) == len(dropped.numbers)
    clean = replace(run, walks=tuple(replace(w, strides=w.strides.assign(kept=True)) for w in run.walks))
    assert dropped_table(clean, "P01", "P01") is None


def test_fits(run_maker):
    table = fits_table(run_maker(outputs=OUTPUTS))
    assert table.rows[0] == ("P01", "Nominal", "network", "0.1", "40", "5214", "782", "1.31")
    assert "n = 6" in table.caption
    assert fits_table(run_maker(0)).rows == ()


def test_pairs():
    assert pairs_table("files", "Files.", ("file", "SHA-256"), [("a.c3d", "ff")]).rows == (("a.c3d", "ff"),)


@pytest.mark.parametrize("participants", [1, 2])
def test_every_table_has_cells_for_its_columns(run_maker, refusal, participants):
    run = run_maker(participants, outputs=OUTPUTS, refusals=(refusal,))
    for table in (walks_table(run), refusals_table(run), findings_table(run), fits_table(run), study_r2_table(run)):
        assert {len(row) for row in table.rows} == {len(table.columns)}
