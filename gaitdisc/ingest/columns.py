"""What a column of a text file measures: its label, the study's own map, and the unit if one is stated."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, folded_label, nearest_word, side_of, vocabulary
from gaitdisc.errors import ChannelError, UnitError
from gaitdisc.units import convert, inner_unit, known_units, parsed_unit

# quantity -> units it may have inside; the first one is usual, the others are normalised by mass or by a maximum
_UNITS_OF = {
    "angle": ("deg",),
    "translation": ("m",),
    "marker": ("m",),
    "pressure_centre": ("m",),
    "moment": ("N m", "N m/kg", "%", "1"),
    "force": ("N", "N/kg", "%", "1"),
    "vertical_force": ("N", "N/kg", "%", "1"),
    "power": ("W", "W/kg", "1"),
    "emg": ("V", "1", "%"),
}
_CLOCK = " @ "


@dataclass(frozen=True)
class Column:
    """A column of a file: what it measures and the unit in which the file gives it.

    >>> Column("knee [rad]", Channel("knee_angle_r", "angle", "deg", "r"), "rad").converted(np.array([1.0])).round(2)
    array([57.3])
    """

    label: str
    channel: Channel  # what it is inside; its unit is the one used inside
    unit: str  # unit of the numbers in the file
    guessed: str = ""  # what had to be guessed, in words; empty where nothing was

    def converted(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Numbers in the unit used inside.

        values (time,) [unit]: as read
        """
        base, rate = (self.unit.partition("/s")[0], True) if "/s" in self.unit else (self.unit, False)
        inside = self.channel.unit.partition("/s")[0] if rate else self.channel.unit
        return np.asarray(convert(values, base, inside), float)


def split_unit(text: str) -> tuple[str, str | None]:
    """Name and unit of `name [unit]`, or of `name [unit] @ clock`; the unit is None where none is stated.

    text: a label of a file, or a value of the study's `[channels]`

    >>> split_unit("emg_sol_r [mV]"), split_unit("knee_angle_r")
    (('emg_sol_r', 'mV'), ('knee_angle_r', None))
    """
    bare = text.partition(_CLOCK)[0]
    found = re.fullmatch(r"\s*(.*?)\s*\[([^\[\]]*)\]\s*", bare, re.DOTALL)
    return (found[1], found[2].strip()) if found else (bare.strip(), None)


def said_clock(said: str) -> str:
    """What follows `@` in a value of the study's `[channels]`: a rate, or a variable of times; empty without one.

    said: `name [unit] @ clock`

    >>> said_clock("knee_angle_r [deg] @ 100 Hz"), said_clock("knee_angle_r [deg]")
    ('100 Hz', '')
    """
    return said.partition(_CLOCK)[2].strip()


def mapped_label(label: str, channels: Mapping[str, str] | None) -> str | None:
    """What the study's `[channels]` says that a label means, or None.

    channels: label -> `name` or `name [unit]`. Case, blanks and punctuation of labels count only where they must

    >>> mapped_label("Sensor 1.EMG", {"sensor 1 emg": "emg_sol_r [mV]"})
    'emg_sol_r [mV]'
    """
    if not channels:
        return None
    if label in channels:
        return channels[label]
    alike = [name for key, name in channels.items() if folded_label(key) == folded_label(label)]
    return alike[0] if len(alike) == 1 and folded_label(label) else None


def named_channel(name: str) -> Channel:
    """Channel of a name: that of the vocabulary, or one whose quantity the name shows.

    >>> named_channel("emg_gracilis_r").quantity, named_channel("RHEE.x").quantity, named_channel("trigger").quantity
    ('emg', 'marker', 'signal')
    """
    known = next((channel for channel in vocabulary().channels if channel.name == name), None)
    if known:
        return known
    if name.startswith("emg_"):
        return Channel(name, "emg", "V", side_of(name))
    if re.fullmatch(r".+\.[xyz]", name):
        return Channel(name, "marker", "m")
    if name.endswith(("_moment", "_beta_force")):  # OpenSim calls the moment about a copied rotation a force
        return Channel(name, "moment", "N m", side_of(name))
    if name.endswith("_force"):
        return Channel(name, "force", "N", side_of(name))
    return Channel(name, "signal", "1", side_of(name))


def check_written_names(names: Sequence[str], file: str) -> None:
    """Refuse names that a text table cannot hold.

    >>> check_written_names(["knee_angle_r"], "walk.csv")
    """
    for name in names:
        if name != name.strip() or not name.isprintable():
            raise ChannelError(
                f"{file}: a text table holds names without tabs, line breaks and blanks at the ends",
                f"found {name!r}",
                "Rename the channel.",
            )


def column_in_unit(label: str, channel: Channel, unit_text: str, file: str) -> Column:
    """Column whose unit the file or the study states.

    >>> column_in_unit("F", Channel("ground_force_r_vy", "vertical_force", "N", "r"), "kN", "a.csv").channel.unit
    'N'
    """
    unit = parsed_unit(unit_text)
    base, rate = unit_text, ""
    if unit is None and re.search(r"/s2?$", unit_text):
        base, rate = re.split(r"(?=/s2?$)", unit_text, maxsplit=1)
        unit = parsed_unit(base)
    if unit is None:
        nearest = nearest_word(base, known_units())
        raise UnitError(
            f"{file}: column {label!r} needs a unit of the closed list",
            f"found {unit_text!r}" + (f", the nearest is {nearest!r}" if nearest else ""),
            f"Use one of: {', '.join(known_units())}.",
        )
    inner = inner_unit(unit)
    allowed = _UNITS_OF.get(channel.quantity)
    if rate and channel.quantity != "signal":
        channel = replace(channel, name=f"{channel.name}{'/accel' if rate == '/s2' else '/speed'}", quantity="signal")
        allowed = None
    if allowed and inner not in allowed:
        raise UnitError(
            f"{file}: column {label!r} is {channel.name}, {_a(channel.quantity)} in {allowed[0]}",
            f"its unit says {unit_text!r}",
            "Correct the unit in the header or in the study's [channels], or map the column to another name.",
        )
    quantity = "angle" if channel.quantity == "signal" and inner == "deg" and not rate else channel.quantity
    return Column(label, replace(channel, unit=inner + rate, quantity=quantity), unit + rate)


def column_of(label: str, file: str, channels: Mapping[str, str] | None) -> Column:
    """Column of a label, by the study's own map or the vocabulary.

    channels: the study's `[channels]`

    >>> column_of("knee_angle_r", "walk.csv", None).unit
    'deg'
    """
    plain, unit = split_unit(label)
    said = mapped_label(label, channels) or mapped_label(plain, channels)
    alias = None if said else vocabulary().named(plain)
    name, said_unit = split_unit(said) if said else (plain, None)
    channel, unit = named_channel(name), said_unit or unit
    own = any(name == known.name for known in vocabulary().channels)
    if unit is None and not own:
        seems = f"; it seems to be {alias.name}" if alias else ""
        raise UnitError(
            f"{file}: column {label!r} needs a unit",
            f"neither its header nor the study states one{seems}",
            f'Write \'{plain} [unit]\' in the header, or "{plain}" = "{alias.name if alias else "name"} [unit]" '
            "in the study's [channels].",
        )
    return column_in_unit(label, alias or channel, unit or channel.unit, file)


def _a(quantity: str) -> str:
    article = "an" if quantity[0] in "ae" else "a"
    return f"{article} {'EMG' if quantity == 'emg' else quantity.replace('_', ' ')}"
