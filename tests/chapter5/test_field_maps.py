import numpy as np
import pandas as pd
from chapter5.pages import flow_figure, maps_figure, routes_figure
from manufactured_field import travelling_wave

from gaitdisc.recording import Axis, Field
from gaitdisc.report.figure import save_figure

WAVE = travelling_wave(20)


def test_maps_share_one_scale_about_zero_and_carry_their_numbers(tmp_path):
    shown = {"measured": WAVE.values[3, :, 0], "reconstructed": 0.5 * WAVE.values[3, :, 0]}
    figure = maps_figure(WAVE, shown, "maps", "As Fig. 5.3")
    assert figure.numbers["points"].tolist() == [WAVE.points] * 2
    assert np.isclose(figure.numbers["sd"][0], 2 * figure.numbers["sd"][1])
    limits = {collection.get_clim() for axes in figure.drawn.axes[:2] for collection in axes.collections}
    assert len(limits) == 1
    low, high = limits.pop()
    assert low == -high
    assert figure.caption == "As Fig. 5.3. h [m]."
    save_figure(figure, tmp_path)
    assert (tmp_path / "maps.png").stat().st_size > 5_000


def test_of_a_volume_the_middle_plane_is_shown():
    axes = tuple(Axis(name, np.arange(4.0)) for name in "zyx")
    values = np.repeat(np.arange(4.0), 16)[None, :, None]
    flow = Field(np.zeros(1), values, axes, np.ones((4, 4, 4), bool), ("u",), ("1",))
    figure = maps_figure(flow, {"flow": flow.values[0, :, 0]}, "maps", "As Fig. 5.2")
    assert figure.numbers["mean"][0] == 2
    assert figure.caption.endswith("Middle plane.")


def test_routes_are_lines_and_fixed_sensors_points():
    places = {"1 fixed": np.tile([[0.0, 4.0]], (5, 1)), "ship": np.column_stack([np.zeros(5), np.arange(5.0)])}
    figure = routes_figure(WAVE, places, "routes", "Routes")
    assert [line.get_linestyle() for line in figure.drawn.axes[0].lines] == ["None", "-"]
    assert figure.numbers.groupby("route")["lon"].max().to_dict() == {"1 fixed": 4, "ship": 4}


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
