from __future__ import annotations

from gaitdisc.report.fonts import fonts_found


def test_the_font_that_matplotlib_brings_is_found():
    assert "DejaVu Sans" in fonts_found()
