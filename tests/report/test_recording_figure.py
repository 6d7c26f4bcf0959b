"""Channels of a recording over time."""

import numpy as np
from matplotlib.figure import Figure

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording
from gaitdisc.report.recording_figure import draw_recording


def test_every_channel_has_its_line_and_the_axis_every_unit():
    channels = (Channel("knee_angle_r", "angle", "deg", "r"), Channel("pelvis_tx", "translation", "m"))
    axes = Figure().subplots()
    draw_recording(
        axes, Recording(np.arange(3.0), np.arange(6.0).reshape(3, 2), channels), ["pelvis_tx", "knee_angle_r"]
    )
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), [1.0, 3.0, 5.0])
    assert axes.get_ylabel() == "[m, deg]"
