import base64

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure, file_names, save_figure
from gaitdisc.report.panels import Room, in_style, panels


def make_figure(points=5):
    drawn, [[axes]] = in_style(panels)(1, 1, 1.0, Room())
    values = np.sin(np.arange(points))
    axes.plot(values, label="$never mathematics$")
    return Figure("wave", "A wave, n = 5.", "a wave", pd.DataFrame({"y": values}), drawn)


def test_a_figure_lies_as_svg_png_and_csv_and_in_the_page(tmp_path):
    figure = make_figure()
    saved = save_figure(figure, tmp_path)
    svg = (tmp_path / "wave.svg").read_bytes()
    assert saved.data == "data:image/svg+xml;base64," + base64.b64encode(svg).decode()
    assert (tmp_path / "wave.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    np.testing.assert_allclose(pd.read_csv(tmp_path / "wave.csv")["y"], figure.numbers["y"], rtol=1e-7)
    assert b"<metadata" not in svg or b"date" not in svg


def test_a_large_svg_is_shown_as_a_picture(tmp_path):
    assert save_figure(make_figure(40_000), tmp_path, inline_bytes=0).data.startswith("data:image/png")


def test_drawing_again_gives_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        save_figure(make_figure(), tmp_path / folder)
    for ending in ("svg", "png", "csv"):
        assert (tmp_path / "a" / f"wave.{ending}").read_bytes() == (tmp_path / "b" / f"wave.{ending}").read_bytes()


def test_file_names_are_safe_and_differ():
    names = file_names(["../P1", "P1", "p1", "päul", ""])
    assert len({name.lower() for name in names.values()}) == 5
    assert all(set(name) <= set("abcdefghijklmnopqrstuvwxyzP0123456789_-") for name in names.values())
