import numpy as np
import pandas as pd

from gaitdisc.chapters.pages.disturbance_figure import disturbance_figure


def test_one_panel_a_disturbance_and_one_line_a_model():
    rows = [
        (disturbance, level, model, 1.0 + level)
        for disturbance, models in (("noise", ("shred",)), ("missing", ("shred", "masked shred")))
        for level in (0.0, 0.1)
        for model in models
    ]
    found = pd.DataFrame(rows, columns=pd.Index(["disturbance", "level", "model", "rmse_deg"]))
    figure = disturbance_figure(found, "W01, 3 sensors", "disturbed")
    noise, missing = figure.drawn.axes
    assert (len(noise.get_lines()), len(missing.get_lines())) == (1, 2)
    assert list(np.asarray(noise.get_lines()[0].get_xdata())) == [0.0, 10.0]
    assert "masked shred is given which are lost" in figure.caption
