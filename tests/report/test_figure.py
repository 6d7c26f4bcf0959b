import base64

import numpy as np
import pandas as pd
import pytest

from gaitdisc.report.figure import (
    WIDTH,
    Figure,
    Room,
    file_names,
    in_style,
    panels,
    save_figure,
    save_table,
    sheets,
)


def make_figure(points=5):
    drawn, [[axes]] = in_style(panels)(1, 1, 1.0, Room())
    values = np.sin(np.arange(points))
    axes.plot(values, label="$never mathematics$")
    return Figure("wave", "A wave, n = 5.", "a wave", pd.DataFrame({"y": values}), drawn)


def test_panels_have_their_size_and_do_not_overlap():
    drawn, grid = panels(2, 3, 1.0, Room(left=0.7, right=0.1, top=0.5, bottom=0.4, across=0.6, down=0.3))
    boxes = [[axes.get_position() for axes in row] for row in grid]
    height = drawn.get_figheight()
    assert height == pytest.approx(0.5 + 2 * 1.0 + 0.3 + 0.4)
    assert boxes[0][0].height * height == pytest.approx(1.0)
    assert (boxes[0][1].x0 - boxes[0][0].x1) * WIDTH == pytest.approx(0.6)
    assert (boxes[0][0].y0 - boxes[1][0].y1) * height == pytest.approx(0.3)
    assert boxes[1][2].x1 * WIDTH == pytest.approx(WIDTH - 0.1)


def test_a_figure_lies_as_svg_png_and_csv_and_in_the_page(tmp_path):
    figure = make_figure()
    saved = save_figure(figure, tmp_path)
    svg = (tmp_path / "wave.svg").read_bytes()
    assert saved.data == "data:image/svg+xml;base64," + base64.b64encode(svg).decode()
    assert (tmp_path / "wave.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    np.testing.assert_allclose(pd.read_csv(tmp_path / "wave.csv")["y"], figure.numbers["y"], rtol=1e-7)
    assert b"<metadata" not in svg or b"date" not in svg


def test_a_large_svg_is_shown_as_a_picture(tmp_path):
    assert save_figure(make_figure(40_000), tmp_path, inline_bytes=0).data.startswith("data:image/png")


def test_drawing_again_gives_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        save_figure(make_figure(), tmp_path / folder)
    for ending in ("svg", "png", "csv"):
        assert (tmp_path / "a" / f"wave.{ending}").read_bytes() == (tmp_path / "b" / f"wave.{ending}").read_bytes()


def test_sheets_are_of_nearly_equal_length():
    assert [len(part) for part in sheets(range(25), 12)] == [9, 8, 8]
    assert sheets([], 3) == []


def test_the_users_own_style_does_not_leak_in_or_out():
    import matplotlib as mpl

    with mpl.rc_context({"lines.linewidth": 17.0}):
        assert in_style(lambda: mpl.rcParams["lines.linewidth"])() == mpl.rcParamsDefault["lines.linewidth"]
        assert mpl.rcParams["lines.linewidth"] == 17.0


def test_file_names_are_safe_and_differ():
    names = file_names(["../P1", "P1", "p1", "päul", ""])
    assert len({name.lower() for name in names.values()}) == 5
    assert all(set(name) <= set("abcdefghijklmnopqrstuvwxyzP0123456789_-") for name in names.values())


def test_tables_are_written_without_index(tmp_path):
    save_table(pd.DataFrame({"a": [1.0, np.nan]}), tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text() == 'a\n1\n""\n'
