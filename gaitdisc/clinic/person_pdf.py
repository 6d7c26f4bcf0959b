"""The same page as PDF by matplotlib, which needs no library of the system: sheets of A4, filled from the top."""

from __future__ import annotations

import base64
import io
import textwrap
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaitdisc.clinic.clinical_reference import ClinicalReading, Contrast, PersonSession, Profile
from gaitdisc.clinic.laboratory import ENGLISH, PageWords
from gaitdisc.clinic.panels import SPANS, Panel, contrast_sheet
from gaitdisc.clinic.person_page import CONTRAST, list_sheets
from gaitdisc.clinic.sentences import (
    contrast_sentences,
    laboratory_sentences,
    outstanding_sentences,
    quality_sentence,
    score_sentences,
)
from gaitdisc.clinic.values import change_table, profile_rows, values_table
from gaitdisc.recording import PERCENT
from gaitdisc.report.panels import SIDES, in_style
from gaitdisc.saved.provenance import Provenance
from gaitdisc.whole_file import whole_file

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

    from gaitdisc.report.table import Table

A4 = (8.27, 11.69)  # inch
MARGIN = 0.45
LINE = 0.16  # inch, of text of 8 points
ROW = 1.38  # inch, of panels
CELL, FIRST_CELL = 0.95, 1.45  # inch, of a table
BARS = (6.3, 1.45)  # inch, where bars of the profile begin beside a table, and how wide they are
LOOKS = {"mean": 1.2, "single": 0.35, "before": 0.8}
DASHES = {"l": "-", "r": (0, (5.0, 1.6)), "": "-"}
GREYS = {"band2": "#ececec", "band": "#c9c9c9", "normal": "#555555", "matters": "#111111", "small": "#9a9a9a"}
USE = "Research use, not a medical device. No diagnosis."
KEY = "Left red, unbroken; right blue, dashed; marks: foot off; L, R: cycles."
HEAD, SMALL = 9.5, 6.8  # points


@in_style
def write_person_pdf(person: PersonSession, provenance: Provenance, path: Path, say: PageWords = ENGLISH) -> Path:
    """Write a person's session with all conditions as PDF; the same bytes for the same numbers."""
    from matplotlib.backends.backend_pdf import PdfPages

    main, *others = person.readings
    sheets = _Sheets(say)
    sheets.text(USE, size=7, bold=True)
    if say.laboratory.logo:
        sheets.picture(say.laboratory.logo)
    if say.laboratory.name:
        sheets.text(say.laboratory.name, size=HEAD, bold=True)
    sheets.text(f"{person.title}, {main.pooled.where}", size=13, bold=True)
    for sentence in laboratory_sentences(person, say):
        sheets.text(sentence)
    _write_reading(sheets, main, person.before_after, f"Computed {provenance.created[:10]}. ")
    for other in others:
        sheets.turn()
        sheets.text(f"{person.title}, {other.pooled.where}", size=13, bold=True)
        _write_reading(sheets, other, None)
    for contrast in person.contrasts:
        if contrast is not person.before_after:
            sheets.turn()
            _write_contrast(sheets, contrast)
    with whole_file(path) as part:
        metadata = {"Creator": None, "Producer": None, "CreationDate": None}
        with PdfPages(part, metadata=metadata) as pages:  # type: ignore[arg-type]
            for drawn in sheets.drawn:
                pages.savefig(drawn)
    return path


def _write_reading(
    sheets: _Sheets, reading: ClinicalReading, before_after: Contrast | None, computed: str = ""
) -> None:
    """What stands out, before and after, time and distance, scores, kinematics; then kinetics and EMG on a sheet."""
    say = sheets.say
    sheets.text(f"{computed}{quality_sentence(reading)}")
    if reading.beside:
        sheets.text(" ".join(reading.beside), size=SMALL)
    sheets.text("What stands out", size=HEAD, bold=True)
    for words, sentences in outstanding_sentences(reading, say).items():
        if words:
            sheets.text(words, bold=True)
        for sentence in sentences:
            sheets.text(f"•  {sentence}")
    if not reading.legs:
        sheets.text(f"Left out: {'; '.join(reading.reasons)}")
        return
    if before_after is not None:
        _write_contrast(sheets, before_after)
        sheets.turn()
    sheets.text("Time and distance", size=HEAD, bold=True)
    sheets.table(say.table(values_table(reading)), reading.profile)
    sheets.text("Scores", size=HEAD, bold=True)
    for sentence in score_sentences(reading):
        sheets.text(sentence)
    kinematics, *others = list_sheets(reading)
    recorded = [one for one in others if one.panels]
    for one in (kinematics, *recorded):
        if recorded and one is recorded[0]:
            sheets.turn()
        sheets.text(one.heading, size=HEAD, bold=True)
        sheets.panels(one.panels)
        sheets.text(f"{one.caption} {KEY}" if one is kinematics else one.caption, size=SMALL)


def _write_contrast(sheets: _Sheets, contrast: Contrast) -> None:
    """Sentences with their test, values of both, and curves of both over each other, both legs in a panel."""
    first, second = contrast.first.pooled.where, contrast.second.pooled.where
    sheets.text(f"{first} and {second}", size=HEAD, bold=True)
    for sentence in contrast_sentences(contrast):
        sheets.text(f"•  {sentence}")
    sheets.table(sheets.say.table(change_table(contrast)))
    panels: dict[str, Panel] = {}
    for own in (panel for side in contrast.second.legs for panel in contrast_sheet(contrast, side)):
        other = panels.get(own.name, own)
        both = {"lines": other.lines + own.lines, "differs": other.differs + own.differs}
        panels[own.name] = own if other is own else replace(own, foot_off=other.foot_off + own.foot_off, **both)
    sheets.panels(list(panels.values()))
    sheets.text(CONTRAST.format(first, second), size=SMALL)


class _Sheets:
    """Sheets of A4 that are filled from the top; what does not fit begins the next."""

    def __init__(self, say: PageWords) -> None:
        self.say = say
        self.drawn: list[matplotlib.figure.Figure] = []
        self.turn()

    def turn(self) -> None:
        """Begin a sheet."""
        from matplotlib.figure import Figure as Drawing

        self.drawn.append(Drawing(figsize=A4))
        self._down = MARGIN

    def _make_room(self, height: float) -> None:
        if self._down + height > A4[1] - MARGIN:
            self.turn()

    def _write(self, left: float, words: str, size: float, bold: bool) -> None:
        weight, at = "bold" if bold else "normal", ((MARGIN + left) / A4[0], 1 - self._down / A4[1])
        self.drawn[-1].text(*at, words, fontsize=size, fontweight=weight)

    def text(self, words: str, size: float = 8.0, bold: bool = False) -> None:
        """Write a paragraph, broken to the width of the page."""
        scale = size / 8.0
        for line in textwrap.wrap(self.say(words), round(124 / scale)) or [""]:
            self._make_room(LINE * scale)
            self._down += LINE * scale
            self._write(0.0, line, size, bold)
        self._down += 0.03

    def picture(self, address: str) -> None:
        """Draw a logo, half an inch high."""
        from matplotlib import image

        kind, _, content = address.partition(";base64,")
        pixels = image.imread(io.BytesIO(base64.b64decode(content)), format=kind.rpartition("/")[2])
        wide = min(0.5 * pixels.shape[1] / pixels.shape[0], 3.0)
        place = (1 - (MARGIN + wide) / A4[0], 1 - (MARGIN + 0.5) / A4[1], wide / A4[0], 0.5 / A4[1])
        axes = self.drawn[-1].add_axes(place)
        axes.imshow(pixels)
        axes.set_axis_off()

    def table(self, table: Table, profile: Profile | None = None) -> None:
        """Write a table in columns of equal width, the first wider; bars of a profile stand beside it."""
        heads = [name.partition(", ") for name in table.columns]
        rows = [tuple(head for head, _, _ in heads), *([tuple(end for *_, end in heads)] if heads[1][1] else [])]
        bold, rows = len(rows), [*rows, *table.rows]
        self._make_room(LINE * (len(rows) + 1))
        top, places = self._down, [0.0, *(FIRST_CELL + CELL * k for k in range(len(rows[0]) - 1))]
        for number, row in enumerate(rows):
            self._down += LINE
            for place, cell in zip(places, row, strict=True):
                self._write(place, cell, 7.2, number < bold)
        if profile is not None:
            height = max(self._down - top, 1.6)
            left, wide = BARS
            size = (left / A4[0], 1 - (top + height) / A4[1], wide / A4[0], (height - 0.2) / A4[1])
            _draw_profile(self.drawn[-1].add_axes(size), profile, self.say)
            self._down = top + height
        self._down += 0.05
        self.text(table.caption, size=SMALL)

    def panels(self, panels: Sequence[Panel]) -> None:
        """Draw panels in rows as wide as the page."""
        part, filled = (A4[0] - 2 * MARGIN) / SPANS, 0
        for panel in panels:
            if not filled % SPANS:
                self._make_room(ROW)
                self._down += ROW
            left, wide, high = MARGIN + filled % SPANS * part + 0.3, panel.span * part - 0.4, ROW - 0.55
            bottom = 1 - (self._down - 0.2) / A4[1]
            axes = self.drawn[-1].add_axes((left / A4[0], bottom, wide / A4[0], high / A4[1]))
            draw_panel(axes, self.say.panel(panel))
            filled += panel.span
        self._down += 0.05


def _draw_profile(axes: Axes, profile: Profile, say: PageWords) -> None:
    """Bars of a profile, the reference's mean and spread behind."""
    rows = profile_rows(profile)
    for k, (_, scores) in enumerate(rows):
        for place, (side, score) in enumerate(scores.items()):
            if place == 0 and np.isfinite(score.reference_mean):
                low = max(0.0, score.reference_mean - score.reference_sd)
                wide = score.reference_mean + score.reference_sd - low
                axes.barh(k, wide, 0.9, low, color="#c9c9c9")
            axes.barh(k - 0.18 + 0.36 * place, score.value, 0.32, color=SIDES[side].colour, alpha=0.6 if place else 1.0)
    axes.set(ylim=(len(rows) - 0.5, -0.5), yticks=range(len(rows)), yticklabels=[say(words) for words, _ in rows])
    axes.tick_params(labelsize=5.8, length=2, pad=1)
    axes.set_title(f"{say('movement analysis profile')} [deg]", fontsize=6.2, loc="left", pad=2)


def draw_panel(axes: Axes, panel: Panel) -> None:
    """Draw a panel on axes, as its SVG is drawn."""
    for kind, below, above in panel.shades:
        axes.fill_between(PERCENT, below, above, color=GREYS[kind], linewidth=0)
    if panel.band is not None:
        axes.plot(PERCENT, panel.band.mean, color="#9a9a9a", linewidth=0.6)
    for line in panel.lines:
        dash = DASHES[line.side] if line.look == "mean" else ":" if line.look == "before" else "-"
        faint = 0.45 if line.look == "single" else 1.0
        colour = SIDES[line.side].colour
        axes.plot(PERCENT, line.values, color=colour, linewidth=LOOKS[line.look], linestyle=dash, alpha=faint)
    low, high = panel.ends()
    axes.set(xlim=(0, 100), ylim=(low, high), xticks=[0, 50, 100])
    for side, percent in panel.foot_off:
        axes.plot([percent, percent], [low, low + 0.12 * (high - low)], color=SIDES[side].colour, linewidth=1.0)
    for kind, first, last in panel.bars:
        at = low + (0.02 if kind == "normal" else 0.98) * (high - low)
        axes.plot([first, last], [at, at], color=GREYS[kind], linewidth=3.0, solid_capstyle="butt")
    if low < 0 < high:
        axes.axhline(0.0, color="#cfcfcf", linewidth=0.5, zorder=0)
    axes.tick_params(labelsize=5.5, length=2, pad=1)
    axes.set_title(f"{panel.title} [{panel.unit}]  {panel.note}\n{panel.signs}", fontsize=6.2, loc="left", pad=2)
