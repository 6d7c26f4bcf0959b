from gaitdisc.report.reconstruction_figure import reconstruction_figures


def test_one_panel_a_state_with_what_was_measured_and_told(reconstruction):
    [figure] = reconstruction_figures(reconstruction, "P01", "P01")
    assert sum(axes.get_visible() for axes in figure.drawn.axes) == 1
    assert set(figure.numbers["model"]) == {"linear", "delay ridge"}
    assert "judged windows alone, n = 5 strides" in figure.caption
