from dataclasses import replace

import numpy as np
import pandas as pd

from gaitdisc.report.strides_figure import reason_kind, stride_numbers, strides_figure

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
    run = replace(run, walks=tuple(replace(walk, strides=STRIDES) for walk in run.walks))
    numbers = stride_numbers(run, "P01")
    assert list(numbers["code"]) == ["", "A", "", "B", "", "A"] * 2
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
    run = replace(run, walks=tuple(replace(walk, strides=STRIDES[:0]) for walk in run.walks))
    assert strides_figure(run, "P01", "P01") is None


def test_all_dropped(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    dropped = STRIDES.assign(kept=False, reason="")
    run = replace(run, walks=tuple(replace(walk, strides=dropped) for walk in run.walks))
    figure = strides_figure(run, "P01", "P01")
    assert "natural: 0 kept, 6 dropped" in figure.caption
    assert set(figure.numbers["code"]) == {"A"}
