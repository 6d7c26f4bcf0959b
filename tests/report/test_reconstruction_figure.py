from dataclasses import replace

import pytest

from gaitdisc.report.reconstruction_figure import reconstruction_figures
from gaitdisc.sensing.reconstructor import KINDS, ON_REQUEST


def test_one_panel_a_state_with_what_was_measured_and_reconstructed(reconstruction):
    [figure] = reconstruction_figures(reconstruction, "P01", "P01")
    assert sum(axes.get_visible() for axes in figure.drawn.axes) == 1
    assert set(figure.numbers["model"]) == {"linear", "delay ridge"}
    assert "test windows alone, n = 5 strides" in figure.caption


@pytest.mark.parametrize("kind", [*KINDS, *ON_REQUEST])
def test_every_kind_of_model_can_be_recommended_and_drawn(reconstruction, kind):
    named = {"delay ridge": kind} if kind != "linear" else {"delay ridge": "shred"}
    tables = {name: getattr(reconstruction, name).replace({"model": named}) for name in ("errors", "summary", "curves")}
    told = replace(reconstruction, models=dict.fromkeys(("linear", *named.values()), ""), **tables)
    assert told.recommended == named["delay ridge"]
    [figure] = reconstruction_figures(told, "P01", "P01")
    assert set(figure.numbers["model"]) == {"linear", *named.values()}
