import numpy as np
import pytest

from gaitdisc.report.box import draw_box
from gaitdisc.report.panels import Room, panels


@pytest.mark.parametrize("orientation", ["vertical", "horizontal"])
def test_the_box_spans_the_quartiles_and_its_whiskers_everything(orientation):
    _, [[axes]] = panels(1, 1, 1.0, Room())
    draw_box(axes, np.array([0.0, 1.0, 2.0, 3.0, 9.0]), 5.0, "#123456", orientation)
    ends = [line.get_xydata()[:, 1 if orientation == "vertical" else 0] for line in axes.lines]
    assert {tuple(sorted({float(x) for x in end})) for end in ends} >= {(1.0, 3.0), (0.0, 1.0), (3.0, 9.0), (2.0,)}
    assert {line.get_color() for line in axes.lines} == {"#123456"}
