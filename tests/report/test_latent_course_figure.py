import numpy as np

from gaitdisc.report.latent_course_figure import LATENT, MODES, course_numbers, latent_course_figure


def test_a_mean_course_and_its_spread_by_percent_of_the_stride():
    phi = np.append(np.tile(np.arange(0.5, 100.0), 4), np.nan)
    up = np.append(np.repeat([0.0, 0.0, 2.0, 2.0], 100), 99.0)  # the sample outside of strides is left out
    numbers = course_numbers(phi, np.column_stack([up, np.nan_to_num(phi)]))
    first, second = (rows for _, rows in numbers.groupby("component"))
    np.testing.assert_allclose(first["mean"], 1.0)
    np.testing.assert_allclose(first["sd"], np.std([0.0, 0.0, 2.0, 2.0] * 2, ddof=1))
    np.testing.assert_allclose(second["mean"], second["percent"])
    figure = latent_course_figure({LATENT: numbers, MODES: numbers}, "latent", "As Fig. 5.1")
    left, right = figure.drawn.axes
    assert [len(axes.get_lines()) for axes in (left, right)] == [2, 2]
    assert (left.get_title(), right.get_title()) == (LATENT, MODES)
    assert set(figure.numbers["panel"]) == {LATENT, MODES}
