"""Fonts of the figures that this machine has."""

from __future__ import annotations

from gaitdisc.report.panels import STYLE


def fonts_found() -> list[str]:
    """Of the fonts that figures are drawn with, those that are here."""
    from matplotlib import font_manager

    known = {font.name for font in font_manager.fontManager.ttflist}
    return [name for name in STYLE["font.sans-serif"] if name in known]
