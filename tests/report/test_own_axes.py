"""Axes for a script that brings none of its own."""

import matplotlib as mpl
from matplotlib.figure import Figure

from gaitdisc.report.own_axes import axes_or_new

mpl.use("Agg")


def test_own_axes_are_given_back_and_new_ones_are_pyplots():
    import matplotlib.pyplot as plt

    own = Figure().subplots()
    assert axes_or_new(own) is own
    assert axes_or_new(None) is plt.gca()
    plt.close("all")
