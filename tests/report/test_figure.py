"""Tables, figures, their panels and the page that they are laid out on."""

import base64

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from further import decades
from matplotlib.figure import Figure as Drawing

from gaitdisc.report.figure import Figure, file_names, save_figure
from gaitdisc.report.panels import (
    MODELS,
    SIDES,
    WIDTH,
    WITHOUT_DEVICE,
    Room,
    axes_or_new,
    draw_box,
    fonts_found,
    in_style,
    panels,
    sheets,
)


def make_figure(points=5):
    drawn, [[axes]] = in_style(panels)(1, 1, 1.0, Room())
    values = np.sin(np.arange(points))
    axes.plot(values, label="$never mathematics$")
    return Figure("wave", "A wave, n = 5.", "a wave", pd.DataFrame({"y": values}), drawn)


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


def test_file_names_are_safe_and_differ():
    names = file_names(["../P1", "P1", "p1", "päul", ""])
    assert len({name.lower() for name in names.values()}) == 5
    assert all(set(name) <= set("abcdefghijklmnopqrstuvwxyzP0123456789_-") for name in names.values())


mpl.use("Agg")


def test_panels_have_their_size_and_do_not_overlap():
    drawn, grid = panels(2, 3, 1.0, Room(left=0.7, right=0.1, top=0.5, bottom=0.4, across=0.6, down=0.3))
    boxes = [[axes.get_position() for axes in row] for row in grid]
    height = drawn.get_figheight()
    assert height == pytest.approx(0.5 + 2 * 1.0 + 0.3 + 0.4)
    assert boxes[0][0].height * height == pytest.approx(1.0)
    assert (boxes[0][1].x0 - boxes[0][0].x1) * WIDTH == pytest.approx(0.6)
    assert (boxes[0][0].y0 - boxes[1][0].y1) * height == pytest.approx(0.3)
    assert boxes[1][2].x1 * WIDTH == pytest.approx(WIDTH - 0.1)


def test_a_logarithmic_axis_has_plain_numbers():
    drawn, [[axes]] = panels(1, 1, 1.0, Room())
    axes.plot([0, 1], [0.3, 30.0])
    decades(axes)
    drawn.canvas.draw()
    shown = [label.get_text() for label in axes.get_yticklabels()]
    assert {"0.5", "1", "2", "5", "10"} <= set(shown)


def test_sheets_are_of_nearly_equal_length():
    assert {name: len(part) for name, part in sheets(range(25), 12, "r2").items()} == {"r2-1": 9, "r2-2": 8, "r2-3": 8}
    assert sheets([], 3, "r2") == {}
    assert list(sheets("ab", 3, "r2")) == ["r2"]


def test_the_users_own_style_does_not_leak_in_or_out():
    with mpl.rc_context({"lines.linewidth": 17.0}):
        assert in_style(lambda: mpl.rcParams["lines.linewidth"])() == mpl.rcParamsDefault["lines.linewidth"]
        assert mpl.rcParams["lines.linewidth"] == 17.0


@pytest.mark.parametrize("orientation", ["vertical", "horizontal"])
def test_the_box_spans_the_quartiles_and_its_whiskers_everything(orientation):
    _, [[axes]] = panels(1, 1, 1.0, Room())
    draw_box(axes, np.array([0.0, 1.0, 2.0, 3.0, 9.0]), 5.0, "#123456", orientation)
    ends = [line.get_xydata()[:, 1 if orientation == "vertical" else 0] for line in axes.lines]
    assert {tuple(sorted({float(x) for x in end})) for end in ends} >= {(1.0, 3.0), (0.0, 1.0), (3.0, 9.0), (2.0,)}
    assert {line.get_color() for line in axes.lines} == {"#123456"}


def test_own_axes_are_given_back_and_new_ones_are_pyplots():
    import matplotlib.pyplot as plt

    own = Drawing().subplots()
    assert axes_or_new(own) is own
    assert axes_or_new(None) is plt.gca()
    plt.close("all")


def test_the_font_that_matplotlib_brings_is_found():
    assert "DejaVu Sans" in fonts_found()


def test_models_and_sides_differ_without_colour():
    assert len({str(look.line) for look in MODELS.values()}) == len({look.mark for look in MODELS.values()}) == 3
    assert len({look.mark for look in SIDES.values()}) == 3
    assert WITHOUT_DEVICE.line != SIDES["l"].line


def test_left_is_red_right_is_blue():
    red, green, blue = (int(SIDES["l"].colour[i : i + 2], 16) for i in (1, 3, 5))
    assert red > 2 * max(green, blue)
    red, green, blue = (int(SIDES["r"].colour[i : i + 2], 16) for i in (1, 3, 5))
    assert blue > 2 * max(red, green)
