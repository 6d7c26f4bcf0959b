import numpy as np
import pandas as pd

from gaitdisc.chapters.pages.turbulence_figure import flow_figure


def test_the_mean_spectrum_stands_beside_the_slope():
    k = np.arange(1, 16)
    numbers = pd.DataFrame({f"e_{n}": [2.0 * n ** (-5 / 3), 4.0 * n ** (-5 / 3)] for n in k})
    numbers = numbers.assign(snapshot=[0, 10], dissipation=[0.09, 0.11], re_lambda=25.0, kmax_eta=1.3, turnover=3.4)
    figure = flow_figure(numbers, 0.1, "flow")
    spectrum, slope = figure.drawn.axes[0].lines[:2]
    np.testing.assert_allclose(spectrum.get_ydata(), 3.0 * k ** (-5 / 3))
    np.testing.assert_allclose(slope.get_ydata(), spectrum.get_ydata())
    labels = [axis.get_label_text() for axes in figure.drawn.axes for axis in (axes.xaxis, axes.yaxis)]
    assert [label for label in labels if not label.endswith("]")] == ["snapshot"]  # a count
    assert "microscale 25.0" in figure.caption
    assert "dissipation 0.1000, power 0.1" in figure.caption
