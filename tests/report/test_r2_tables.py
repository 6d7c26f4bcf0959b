from dataclasses import replace

import numpy as np

from gaitdisc.recording import Finding
from gaitdisc.report.r2_tables import not_computed, participants_table, r2_table, study_r2_table

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def test_r2_of_one_participant(run_maker):
    [response] = run_maker(outputs=OUTPUTS).responses
    table = r2_table(response, "P01")
    assert [row[0] for row in table.rows] == ["hip flexion, right [deg/s²]", "ankle angle, left [deg/s²]", "median"]
    assert table.rows[1][3] == f"{response.r2_of('ankle_angle_l', 'augmented'):.3f}"
    assert table.rows[-1][-1] == "0.510"
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
    assert study.rows[0][5] == f"{middle:.3f}\n[{q1:.3f}, {q3:.3f}]"
    assert study.rows[0][1] == "3"
    assert "n = 3 participants" in study.caption
