"""The same page as PDF by matplotlib, which needs no library of the system: two sheets of A4, then every cycle."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.recording import PERCENT
from gaitdisc.report.clinic.panels import Panel, consistency_sheet, emg_sheet, sheet
from gaitdisc.report.clinic.person_page import CONSISTENCY, EMG, MOMENT_SIGNS, band_words
from gaitdisc.report.clinic.values import (
    ENGLISH,
    PageWords,
    outstanding_sentences,
    quality_sentence,
    score_sentences,
    values_table,
)
from gaitdisc.report.panels import SIDES, in_style
from gaitdisc.results.clinical_reference import ClinicalReading, PersonSession
from gaitdisc.results.leg_curves import FORCES, KINEMATICS, MOMENTS, POWERS
from gaitdisc.results.provenance import Provenance
from gaitdisc.whole_file import whole_file

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

A4 = (8.27, 11.69)  # inch
MARGIN = 0.45
LINE = 0.16  # inch, of text of 8 points
LOOKS = {"mean": 1.2, "single": 0.35, "before": 0.8}
DASHES = {"l": "-", "r": (0, (5.0, 1.6)), "": "-"}
USE = "Research use, not a medical device. No diagnosis."


@in_style
def write_person_pdf(person: PersonSession, provenance: Provenance, path: Path, say: PageWords = ENGLISH) -> Path:
    """Write the main condition of a person's session as PDF; the same bytes for the same numbers."""
    from matplotlib.backends.backend_pdf import PdfPages

    main = person.readings[0]
    with whole_file(path) as part:
        metadata = {"Creator": None, "Producer": None, "CreationDate": None}
        with PdfPages(part, metadata=metadata) as pages:  # type: ignore[arg-type]
            for drawn in [_first(person, main, provenance, say), *(_others(main, say) if main.legs else [])]:
                pages.savefig(drawn)
    return path


def _first(
    person: PersonSession, main: ClinicalReading, provenance: Provenance, say: PageWords
) -> matplotlib.figure.Figure:
    """Who, what stands out, time and distance, scores, and kinematics."""
    page = _Page(say)
    page.text(USE, size=7, bold=True)
    page.text(f"{person.title}, {main.pooled.where}", size=13, bold=True)
    page.text(f"Computed {provenance.created[:10]}. {quality_sentence(main)}")
    if main.beside:
        page.text(" ".join(main.beside))
    page.text("What stands out", size=9.5, bold=True)
    for sentence in outstanding_sentences(main, say):
        page.text(f"•  {sentence}")
    if not main.legs:
        page.text(f"Left out: {'; '.join(main.reasons)}")
        return page.drawn
    page.text("Time and distance", size=9.5, bold=True)
    table = say.table(values_table(main))
    page.table((table.columns, *table.rows))
    page.text(table.caption, size=6.8)
    page.text("Scores", size=9.5, bold=True)
    for sentence in score_sentences(main):
        page.text(sentence)
    page.text("Kinematics", size=9.5, bold=True)
    page.panels(sheet(main, KINEMATICS), 5)
    page.text(f"{band_words(main)} Left red, unbroken; right blue, dashed; marks: foot off; L, R: cycles.", size=6.8)
    return page.drawn


def _others(main: ClinicalReading, say: PageWords) -> list[matplotlib.figure.Figure]:
    second = _Page(say)
    kinetics, muscles = sheet(main, MOMENTS, POWERS, FORCES), emg_sheet(main.pooled)
    if kinetics:
        second.text("Moments, powers and forces", size=9.5, bold=True)
        second.panels(kinetics, 4)
        second.text(MOMENT_SIGNS, size=6.8)
    if muscles:
        second.text("EMG", size=9.5, bold=True)
        second.panels(muscles, 4)
        second.text(EMG, size=6.8)
    third = _Page(say)
    third.text("Appendix: every cycle", size=9.5, bold=True)
    third.panels(consistency_sheet(main), 5)
    third.text(CONSISTENCY, size=6.8)
    return [second.drawn, third.drawn] if kinetics or muscles else [third.drawn]


class _Page:
    """A sheet of A4 that is filled from the top."""

    def __init__(self, say: PageWords) -> None:
        from matplotlib.figure import Figure as Drawing

        self.drawn = Drawing(figsize=A4)
        self._down, self._say = MARGIN, say

    def text(self, words: str, size: float = 8.0, bold: bool = False) -> None:
        """Write a paragraph, broken to the width of the page."""
        scale = size / 8.0
        for line in textwrap.wrap(self._say(words), round(124 / scale)) or [""]:
            self._down += LINE * scale
            weight = "bold" if bold else "normal"
            self.drawn.text(MARGIN / A4[0], 1 - self._down / A4[1], line, fontsize=size, fontweight=weight)
        self._down += 0.03

    def table(self, rows: Sequence[Sequence[str]]) -> None:
        """Write rows of cells in columns of equal width, the first wider."""
        places = [0.0, *(1.7 + 1.25 * k for k in range(len(rows[0]) - 1))]
        for number, row in enumerate(rows):
            self._down += LINE
            for place, cell in zip(places, row, strict=True):
                weight = "bold" if number == 0 else "normal"
                at = (MARGIN + place) / A4[0]
                self.drawn.text(at, 1 - self._down / A4[1], cell, fontsize=7.6, fontweight=weight)
        self._down += 0.05

    def panels(self, panels: Sequence[Panel], columns: int) -> None:
        """Draw panels in rows and columns, an empty column closed."""
        used = sorted({panel.column for panel in panels})
        columns = max(columns, len(used))
        wide, height = (A4[0] - 2 * MARGIN) / columns, 1.35
        rows = max((panel.row for panel in panels), default=-1) + 1
        for panel in panels:
            left = MARGIN + used.index(panel.column) * wide + 0.3
            top = self._down + 0.25 + panel.row * height
            size = (left / A4[0], 1 - (top + height - 0.5) / A4[1], (wide - 0.4) / A4[0], (height - 0.5) / A4[1])
            draw_panel(self.drawn.add_axes(size), self._say.panel(panel))
        self._down += rows * height + 0.1


def draw_panel(axes: Axes, panel: Panel) -> None:
    """Draw a panel on axes, as its SVG is drawn."""
    if panel.band is not None:
        mean, sd = panel.band.mean, panel.band.sd
        axes.fill_between(PERCENT, mean - sd, mean + sd, color="#d4d4d4", linewidth=0)
        axes.plot(PERCENT, mean, color="#9a9a9a", linewidth=0.6)
    for line in panel.lines:
        dash = DASHES[line.side] if line.look == "mean" else ":" if line.look == "before" else "-"
        faint = 0.45 if line.look == "single" else 1.0
        colour = SIDES[line.side].colour
        axes.plot(PERCENT, line.values, color=colour, linewidth=LOOKS[line.look], linestyle=dash, alpha=faint)
    low, high = panel.span()
    axes.set(xlim=(0, 100), ylim=(low, high), xticks=[0, 50, 100])
    for side, percent in panel.foot_off:
        axes.plot([percent, percent], [low, low + 0.12 * (high - low)], color=SIDES[side].colour, linewidth=1.0)
    for first, last in panel.normal:
        axes.plot([first, last], [low + 0.02 * (high - low)] * 2, color="#555555", linewidth=3.0, solid_capstyle="butt")
    if low < 0 < high:
        axes.axhline(0.0, color="#cfcfcf", linewidth=0.5, zorder=0)
    axes.tick_params(labelsize=5.5, length=2, pad=1)
    axes.set_title(f"{panel.title} [{panel.unit}]\n{panel.note}", fontsize=5.6, loc="left", pad=2)
    signs = (f"↑ {panel.up}", 0.98, "top"), (f"↓ {panel.down}", 0.03, "bottom")
    for words, at, where in signs if panel.up and panel.down else ():
        axes.text(0.02, at, words, transform=axes.transAxes, fontsize=4.8, color="#555555", va=where)
