from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.report.r2 import study_r2_table
from gaitdisc.report.table import findings_table, refusals_table
from gaitdisc.report.walks import dropped_table, fits_table, reason_kind, stride_numbers, strides_figure, walks_table
from gaitdisc.results.pooled_cycles import WALK

STRIDES = pd.DataFrame(
    [
        ("r", 0.0, 1.0, True, ""),
        ("r", 1.0, 2.9, False, "lasts 1.90 s, the median is 1.00 s"),
        ("r", 2.9, 3.9, True, ""),
        ("l", 0.5, 1.5, False, "0.2 s are missing"),
        ("l", 1.5, 2.5, True, ""),
        ("l", 2.5, 4.1, False, "lasts 1.60 s, the median is 1.00 s"),
    ],
    columns=["side", "start_s", "end_s", "kept", "reason"],
)


def test_like_reasons_have_one_letter(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    run = run.with_units(WALK, tuple(replace(walk, strides=STRIDES) for walk in run.walks))
    numbers = stride_numbers(run, "P01")
    assert list(numbers["code"]) == ["", "A", "", "B", "", "A"] * 2
    assert says(walks_table(run).rows[0][6], "right 2 / 1", "left 1 / 2")
    np.testing.assert_allclose(numbers["duration_s"][:3], [1.0, 1.9, 1.0])
    assert reason_kind("") == "no reason was given"


def test_every_stride_is_drawn(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    figure = strides_figure(run, "P01", "P01")
    strip, durations = figure.drawn.axes[:2]
    of_walk = figure.numbers[figure.numbers["condition"] == "natural"]
    bars = [path.get_extents() for collection in strip.collections for path in collection.get_paths()]
    np.testing.assert_allclose(sorted(bar.x0 for bar in bars), sorted(of_walk["start_s"]))
    np.testing.assert_allclose(sorted(bar.width for bar in bars), sorted(of_walk["duration_s"]))
    drawn = np.concatenate([line.get_ydata() for line in durations.get_lines()])
    np.testing.assert_allclose(np.sort(drawn), np.sort(of_walk["duration_s"]))
    letters = [text.get_text() for text in strip.texts]
    assert sorted(letters) == sorted(of_walk.loc[~of_walk["kept"], "code"])
    assert f"n = {len(of_walk)} strides (natural: {int(of_walk['kept'].sum())} kept" in figure.caption


def test_nobody_and_no_strides(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    assert strides_figure(run, "P99", "P99") is None
    run = run.with_units(WALK, tuple(replace(walk, strides=STRIDES[:0]) for walk in run.walks))
    assert strides_figure(run, "P01", "P01") is None


def test_all_dropped(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    dropped = STRIDES.assign(kept=False, reason="")
    run = run.with_units(WALK, tuple(replace(walk, strides=dropped) for walk in run.walks))
    figure = strides_figure(run, "P01", "P01")
    assert "natural: 0 kept, 6 dropped" in figure.caption
    assert set(figure.numbers["code"]) == {"A"}


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
    assert says(findings.rows[0][3], "gap: 0.12 s", "12.31-12.43; 40.10-40.22 s")
    assert len(findings.rows) == 3
    dropped = dropped_table(run, "P01", "P01")
    assert sum(int(row[3]) for row in dropped.rows) == len(dropped.numbers)
    clean = run.with_units(WALK, tuple(replace(w, strides=w.strides.assign(kept=True)) for w in run.walks))
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
