"""Words for one gap: which joint, which way, how far, in which part of the stride, how sure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gaitdisc.channel import side_of
from gaitdisc.report.wording import SIDE_WORDS, label, sideless, unit_text, upwards

# meaning of a larger value -> what the joint is then, and what it is when the value is smaller
DIRECTIONS = {
    "dorsiflexion": ("dorsiflexed", "plantarflexed"),
    "flexion": ("flexed", "extended"),
    "adduction": ("adducted", "abducted"),
    "internal rotation": ("internally rotated", "externally rotated"),
    "inversion": ("inverted", "everted"),
}
JOINTS = {
    "hip_flexion": "hip",
    "hip_adduction": "hip",
    "hip_rotation": "hip",
    "knee_angle": "knee",
    "knee_adduction": "knee",
    "knee_rotation": "knee",
    "ankle_angle": "ankle",
    "subtalar_angle": "subtalar joint",
}


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
    ('p < .001', 'p = .031')
    """
    return "p < .001" if p < 0.001 else f"p = {p:.3f}".replace("0.", ".", 1)


def direction_words(name: str, gap: float, unit: str) -> str:
    """Which way and how far a channel lies from the other walk's.

    gap: first minus second [unit]

    >>> direction_words("ankle_angle_r", -6.1, "deg"), direction_words("pelvis_tilt", 2.0, "deg")
    ('the right ankle is up to 6.1 deg more plantarflexed', 'pelvis tilt is up to 2.0 deg higher')
    """
    size = with_unit(amount(abs(gap)), unit)
    stem, side = sideless(name), SIDE_WORDS[side_of(name)]
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
    return size if unit == "1" else f"{size} {unit_text(unit)}"


def amount(value: float) -> str:
    """Write a size with one digit after the point, or two significant digits where it is small.

    >>> amount(6.14), amount(0.0321), amount(123.4)
    ('6.1', '0.032', '123.4')
    """
    return f"{value:.1f}" if value >= 1 else f"{value:.2g}"
