"""Words of the report: names, signs, units and gaps as a clinician reads them; a short table, as notebooks show it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

from gaitdisc.channel import find_side, vocabulary

if TYPE_CHECKING:
    import rich.text

SIDE_WORDS = {"r": "right", "l": "left", "": ""}
MODEL_WORDS = {"nominal": "Nominal", "augmented": "Augmented", "exo": "Exo", "discrepancy": "Discrepancy"}
LIGHTS = {
    "clean": ("green", "clean"),
    "note": ("green", "notes only"),
    "warning": ("amber", "warnings"),
    "refused": ("red", "refused"),
}
NONE = "–"  # cell of what has no value
_TRANSLATIONS = {"pelvis_tx": "pelvis fore-aft", "pelvis_ty": "pelvis vertical", "pelvis_tz": "pelvis sideways"}
# meaning of a larger value -> what the joint is then, and what it is when the value is smaller
DIRECTIONS = {
    "dorsiflexion": ("dorsiflexed", "plantarflexed"),
    "flexion": ("flexed", "extended"),
    "adduction": ("adducted", "abducted"),
    "internal rotation": ("internally rotated", "externally rotated"),
    "inversion": ("inverted", "everted"),
}
JOINTS = {
    **dict.fromkeys(("hip_flexion", "hip_adduction", "hip_rotation"), "hip"),
    **dict.fromkeys(("knee_angle", "knee_adduction", "knee_rotation"), "knee"),
    "ankle_angle": "ankle",
    "subtalar_angle": "subtalar joint",
}


def sideless(name: str) -> str:
    """Name of a channel without its side: what the two sides have in common.

    >>> sideless("ankle_angle_r"), sideless("hip_flexion_l_moment")
    ('ankle_angle', 'hip_flexion_moment')
    """
    return re.sub(r"_[rl](?=_|$)", "", name, count=1) if find_side(name) else name


def label(name: str) -> str:
    """Name of a channel as it is read in a title; one that the vocabulary lacks only loses its underscores.

    >>> label("ankle_angle_r"), label("emg_sol_l"), label("pelvis_tilt")
    ('ankle angle, right', 'EMG soleus, left', 'pelvis tilt')
    """
    stem = sideless(name)
    if stem.startswith("emg_"):
        words = f"EMG {_meaning(name) or stem.removeprefix('emg_').upper()}"
    else:
        words = _TRANSLATIONS.get(stem, stem.replace("_", " "))
    side = SIDE_WORDS[find_side(name)]
    return f"{words}, {side}" if side else words


def upwards(name: str) -> str:
    """What upwards means in a figure of a channel, or empty where the vocabulary does not say.

    >>> upwards("knee_angle_r"), upwards("emg_sol_r")
    ('flexion', '')
    """
    return "" if name.startswith("emg_") else _meaning(name)


def unit_text(unit: str) -> str:
    """Unit as it is printed."""
    return unit.replace("/s2", "/s²")


def number(value: float, digits: int = 2, none: str = "not computed") -> str:
    """Write a number with a proper minus sign, or what stands for none.

    A share (R², to two digits or more) that falls short of all is not printed as all; an amount is rounded.

    >>> number(0.8712), number(-0.004), number(0.9987), number(0.97, 1), number(float("nan"))
    ('0.87', '0.00', '>0.99', '1.0', 'not computed')
    """
    if not math.isfinite(value):
        return none
    text = f"{value:.{digits}f}"
    if digits > 1 and value < 1 and float(text) == 1:
        return f">{1 - 10**-digits:.{digits}f}"
    return text.lstrip("-") if float(text) == 0 else text.replace("-", "−")


def p_cell(p: float) -> str:
    """Write a p as it stands in a table.

    >>> p_cell(0.0004), p_cell(0.0312), p_cell(float("nan"))
    ('< 0.001', '0.031', '–')
    """
    return NONE if not math.isfinite(p) else "< 0.001" if p < 0.001 else f"{p:.3f}"


def counted(count: int, noun: str) -> str:
    """Count with its noun in the right number.

    >>> counted(1, "stride"), counted(2, "stride")
    ('1 stride', '2 strides')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"


def listing(words: list[str]) -> str:
    """Words as they stand in a sentence."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _meaning(name: str) -> str:
    meaning = vocabulary().positive.get(name, "")
    return re.split(r" \(|,", meaning)[0].strip()


def region_words(row: Mapping[str, Any]) -> str:
    """Part of the stride in words.

    >>> region_words({"from_percent": 12.0, "to_percent": 55.0})
    'between 12 and 55 % of the stride'
    """
    first, last = float(row["from_percent"]), float(row["to_percent"])
    if first == 0 and last == 100:
        return "throughout the stride"
    return f"at {first:.0f} % of the stride" if first == last else f"between {first:.0f} and {last:.0f} % of the stride"


def p_words(p: float) -> str:
    """A p as it is printed.

    >>> p_words(0.0004), p_words(0.0312)
    ('p < 0.001', 'p = 0.031')
    """
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}"


def direction_words(name: str, gap: float, unit: str) -> str:
    """Which way and how far a channel lies from the other walk's.

    gap: of this walk minus the other [unit]

    >>> direction_words("ankle_angle_r", -6.1, "deg"), direction_words("pelvis_tilt", 2.0, "deg")
    ('the right ankle is up to 6.1 deg more plantarflexed', 'pelvis tilt is up to 2.0 deg higher')
    """
    size = with_unit(amount(abs(gap)), unit)
    stem, side = sideless(name), SIDE_WORDS[find_side(name)]
    ways = DIRECTIONS.get(upwards(name))
    if stem in JOINTS and ways:
        return f"the {side} {JOINTS[stem]} is up to {size} more {ways[0] if gap > 0 else ways[1]}"
    return f"{spoken(name)} is up to {size} {'higher' if gap > 0 else 'lower'}"


def spoken(name: str) -> str:
    """Name of a channel as it is said in a sentence, the side first.

    >>> spoken("knee_angle_r"), spoken("emg_sol_l"), spoken("pelvis_tilt")
    ('right knee angle', 'left EMG soleus', 'pelvis tilt')
    """
    words, _, side = label(name).partition(", ")
    return f"{side} {words}" if side else words


def with_unit(size: str, unit: str) -> str:
    """Size with its unit; a ratio has none.

    >>> with_unit("6.1", "deg"), with_unit("0.15", "1")
    ('6.1 deg', '0.15')
    """
    return size if unit in ("", "1") else f"{size} {unit_text(unit)}"


def amount(value: float) -> str:
    """Write a size with one digit after the point, or two significant digits where it is small.

    >>> amount(6.14), amount(0.0321), amount(123.4)
    ('6.1', '0.032', '123.4')
    """
    return f"{value:.1f}" if value >= 1 else f"{value:.2g}"


def plain(words: str, style: str = "") -> rich.text.Text:
    """Words that rich prints letter by letter, whatever they are; every cell and caption with a user's name is made so.

    >>> plain("xo[/b] :walking:").plain
    'xo[/b] :walking:'
    """
    from rich.text import Text

    return Text(words, style)


def as_html(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """HTML of a title and a few rows of two cells; every text is escaped.

    >>> as_html("<walk>", [("rate", "100 Hz")])
    '<table><caption>&lt;walk&gt;</caption><tr><th>rate</th><td>100 Hz</td></tr></table>'
    """
    cells = "".join(f"<tr><th>{escape(what)}</th><td>{escape(much)}</td></tr>" for what, much in rows)
    return f"<table><caption>{escape(title)}</caption>{cells}</table>"
