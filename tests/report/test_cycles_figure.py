from __future__ import annotations

import numpy as np
from made_cycles import made_cycles

from gaitdisc.report.cycles_figure import cycles_figures


def test_both_feet_lie_over_each_other_with_every_cycle_and_foot_off():
    (figure,) = cycles_figures(made_cycles(each=4), "P01-walk")
    shown = [axes for axes in figure.drawn.axes if axes.get_visible()]
    titles = [axes.get_title() for axes in shown]
    assert titles[0] == "knee angle" and titles[-1].startswith("EMG")
    knee = shown[0]
    curves = [line for line in knee.lines if len(line.get_xdata()) == 101]
    assert len(curves) == 2 * (4 + 1)  # four cycles and their mean, of each foot
    assert any(np.allclose(line.get_xdata(), 60.0) for line in knee.lines if len(line.get_xdata()) == 2)
    assert "4 cycles left and 4 cycles right, pooled over 2 trials" in figure.caption
    assert "one plate" not in figure.caption and "a plate carried this foot alone: 1 left, 1 right" in figure.caption
    assert figure.alt.startswith("Mean cycles of P01, walk: ")


def test_without_a_kept_cycle_nothing_is_drawn():
    assert cycles_figures(made_cycles(each=0), "x") == []
