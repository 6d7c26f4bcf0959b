import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from gaitdisc.report.panels import WIDTH, Room, axes_or_new, decades, draw_box, fonts_found, in_style, panels, sheets

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

    own = Figure().subplots()
    assert axes_or_new(own) is own
    assert axes_or_new(None) is plt.gca()
    plt.close("all")


def test_the_font_that_matplotlib_brings_is_found():
    assert "DejaVu Sans" in fonts_found()
