"""What a column of a text file measures, its unit, and the stream it belongs to; a missing force is refused."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.channel import Channel, find_side, fold_label, hint_nearest, vocabulary
from gaitdisc.errors import ChannelError, ReadError, SamplingError, UnitError
from gaitdisc.recording import Finding, Recording, Source, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.units import convert, inner_unit, list_units, offset_words, parse_unit

# quantity -> its stream, and units it may have inside; the first is usual, others are normalised by mass or a maximum
_KINDS = {
    "angle": ("kinematics", "deg"),
    "translation": ("kinematics", "m"),
    "marker": ("markers", "m"),
    "pressure_centre": ("forces", "m"),
    "moment": ("moments", "N m", "N m/kg", "%", "1"),
    "force": ("forces", "N", "N/kg", "%", "1"),
    "vertical_force": ("forces", "N", "N/kg", "%", "1"),
    "power": ("moments", "W", "W/kg", "1"),
    "emg": ("emg", "V", "1", "%"),
    "signal": ("signals",),  # of any unit
}
_CLOCK = " @ "
IGNORE = "ignore"  # what the study calls a column, a marker or a channel that is not used
RATE_WORDS = {"/s": "speed", "/s2": "accel"}  # how OpenSim calls the derivatives of a coordinate
SLOWEST_S = 0.2  # between samples: people make up to 2.5 steps a second, which fewer than 5 Hz cannot show (Nyquist)
FEW = 50  # samples, of which fewer are no recording of a walk


@dataclass(frozen=True)
class Column:
    """A column of a file: what it measures and the unit in which the file gives it.

    >>> Column("knee [rad]", Channel("knee_angle_r", "angle", "deg", "r"), "rad").convert(np.array([1.0])).round(2)
    array([57.3])
    """

    label: str
    channel: Channel  # what it is inside; its unit is the one used inside
    unit: str  # unit of the numbers in the file
    guessed: str = ""  # what had to be guessed, in words; empty where nothing was

    def convert(self, values: Values) -> Values:
        """Numbers (time,) as read, in the unit used inside."""
        base, rate = (self.unit.partition("/s")[0], True) if "/s" in self.unit else (self.unit, False)
        inside = self.channel.unit.partition("/s")[0] if rate else self.channel.unit
        return np.asarray(convert(values, base, inside), float)


def split_unit(text: str) -> tuple[str, str | None]:
    """Name and unit, None where unstated, of a label or value `name [unit]`, or `name [unit] @ clock`.

    >>> split_unit("emg_sol_r [mV]"), split_unit("knee_angle_r")
    (('emg_sol_r', 'mV'), ('knee_angle_r', None))
    """
    bare = text.partition(_CLOCK)[0]
    match = re.fullmatch(r"\s*(.*?)\s*\[([^\[\]]*)\]\s*", bare, re.DOTALL)
    return (match[1], match[2].strip()) if match else (bare.strip(), None)


def find_clock(entry: str) -> str:
    """What follows `@` in `name [unit] @ clock`: a rate, or a variable of times; empty without one.

    >>> find_clock("knee_angle_r [deg] @ 100 Hz"), find_clock("knee_angle_r [deg]")
    ('100 Hz', '')
    """
    return entry.partition(_CLOCK)[2].strip()


def map_label(label: str, channels: Mapping[str, str] | None) -> str | None:
    """What the study's `[channels]` says of a label, or None; case, blanks, punctuation count only where they must.

    channels: label -> `name` or `name [unit]`, here and in all readers of text

    >>> map_label("Sensor 1.EMG", {"sensor 1 emg": "emg_sol_r [mV]"})
    'emg_sol_r [mV]'
    """
    if not channels:
        return None
    if label in channels:
        return channels[label]
    alike = [name for key, name in channels.items() if fold_label(key) == fold_label(label)]
    return alike[0] if len(alike) == 1 and fold_label(label) else None


def read_label(label: str, channels: Mapping[str, str] | None) -> tuple[str, str | None, bool]:
    """Name and unit of a column, by the study's `[channels]` or else by its label; whether the study names it."""
    plain, unit = split_unit(label)
    entry = map_label(label, channels) or map_label(plain, channels)
    if not entry:
        return plain, unit, False
    name, said_unit = split_unit(entry)
    return name, said_unit or unit, True


def name_channel(name: str) -> Channel:
    """Channel of a name: that of the vocabulary, or one whose quantity the name shows.

    >>> name_channel("emg_gracilis_r").quantity, name_channel("RHEE.x").quantity, name_channel("trigger").quantity
    ('emg', 'marker', 'signal')
    """
    if name in vocabulary().by_name:
        return vocabulary().by_name[name]
    if name.startswith("emg_"):
        return Channel(name, "emg", "V", find_side(name))
    if re.fullmatch(r".+\.[xyz]", name):
        return Channel(name, "marker", "m")
    if name.endswith(("_moment", "_beta_force")):  # OpenSim calls the moment about a copied rotation a force
        return Channel(name, "moment", "N m", find_side(name))
    if name.endswith("_force"):
        return Channel(name, "force", "N", find_side(name))
    return Channel(name, "signal", "1", find_side(name))


def is_ignored(channel: Channel) -> bool:
    """Whether the study says `ignore` of a column, a marker or a channel."""
    return channel.name.partition(".")[0] == IGNORE


def check_written_names(names: Sequence[str], file: str) -> None:
    """Refuse names that a text table cannot hold."""
    for name in names:
        if name != name.strip() or not name.isprintable():
            raise ChannelError(
                f"{file}: names in a text table must not contain tabs or line breaks, nor begin or end with blanks",
                f"found {name!r}",
                "Rename the channel.",
            )


def column_in_unit(label: str, channel: Channel, unit_text: str, file: str) -> Column:
    """Column whose unit the file or the study states."""
    unit = parse_unit(unit_text)
    base, rate = unit_text, ""
    if unit is None and re.search(r"/s2?$", unit_text):
        base, rate = re.split(r"(?=/s2?$)", unit_text, maxsplit=1)
        unit = parse_unit(base)
    if unit is None:
        raise UnitError(
            f"{file}: the unit of column {label!r} must be in the list of units",
            f"found {unit_text!r}" + (offset_words(base) or hint_nearest(base, list_units())),
            f"Use one of: {', '.join(list_units())}.",
        )
    inner = inner_unit(unit)
    if rate and channel.quantity != "signal":
        channel = replace(channel, name=f"{channel.name}/{RATE_WORDS[rate]}", quantity="signal")
    _, *allowed = _KINDS[channel.quantity]
    if allowed and inner not in allowed:
        kind = "EMG" if channel.quantity == "emg" else channel.quantity.replace("_", " ")
        kind = f"{'an' if kind[0] in 'aE' else 'a'} {kind}"
        raise UnitError(
            f"{file}: column {label!r} is {channel.name} and must have the unit of {kind}, such as {allowed[0]}",
            f"its unit is {unit_text!r}",
            "Correct the unit in the header or in the study's [channels], or map the column to another name.",
        )
    quantity = "angle" if channel.quantity == "signal" and inner == "deg" and not rate else channel.quantity
    return Column(label, replace(channel, unit=inner + rate, quantity=quantity), unit + rate)


def find_column(label: str, file: str, channels: Mapping[str, str] | None) -> Column:
    """Column of a label, by the study's `[channels]` or the vocabulary."""
    plain = split_unit(label)[0]
    name, unit, is_mapped = read_label(label, channels)
    if is_mapped and name == IGNORE:
        return Column(label, name_channel(name), "1")
    alias = None if is_mapped else vocabulary().named(plain)
    channel = alias or name_channel(name)
    if unit is None and name not in vocabulary().by_name:
        seems = f"; the column seems to be {alias.name}" if alias else ""
        raise UnitError(
            f"{file}: column {label!r} must have a unit",
            f"neither its header nor the study states one{seems}",
            f'Write \'{plain} [unit]\' in the header, or "{plain}" = "{alias.name if alias else "name"} [unit]" '
            "in the study's [channels].",
        )
    return column_in_unit(label, channel, unit or channel.unit, file)


def find_stream(channel: Channel) -> str:
    """Stream of a channel: a free moment goes with ground forces, a translation's generalised force with moments.

    >>> find_stream(Channel("ground_torque_r_y", "moment", "N m", "r"))
    'forces'
    >>> find_stream(Channel("pelvis_tx_force", "force", "N"))
    'moments'
    """
    if channel.quantity == "moment" and "ground" in channel.name:
        return "forces"
    if channel.quantity == "force" and channel.name.endswith("_force"):
        return "moments"
    return _KINDS[channel.quantity][0]


def sort_trial(
    source: Source, time: Values, values: Values, columns: Sequence[Column], findings: Sequence[Finding] = ()
) -> Trial:
    """Trial of one file whose columns (time, channel), in the file's units, share one even time base [s]."""
    used = [not is_ignored(column.channel) for column in columns]
    columns, values = [column for column, use in zip(columns, used, strict=True) if use], values[:, used]
    channels = [column.channel for column in columns]
    names = [channel.name for channel in channels]
    doubled = next((name for name in names if names.count(name) > 1), None)
    if doubled:
        first, second = [i + 2 for i, name in enumerate(names) if name == doubled][:2]
        raise ChannelError(
            "each channel must have its own column",
            f"{source.file} has {doubled!r} in columns {first} and {second}",
            "Remove one column, or name the two differently in the study's [channels].",
        )
    _refuse_missing_force(time, values, channels, source.file)
    # too slow to show a step: mostly ms under the name of seconds
    measured = next((channel.name for channel in channels if channel.quantity not in ("signal", "translation")), None)
    step_s = float(time[1] - time[0]) if len(time) >= FEW else 0.0
    if measured and step_s > SLOWEST_S:
        raise SamplingError(
            f"{source.file}: {measured} of a walk must have a sample at least every {SLOWEST_S:g} s",
            f"its times are {step_s:g} s apart, so {len(time)} samples would last {len(time) * step_s / 3600:.3g} h",
            "If the times are in ms, name the column 'time [ms]'.",
        )
    inside = [column.convert(values[:, i]) for i, column in enumerate(columns)]
    places: dict[str, list[int]] = {}
    for i, channel in enumerate(channels):
        places.setdefault(find_stream(channel), []).append(i)
    streams = {
        key: Recording(time, np.column_stack([inside[i] for i in at]), tuple(channels[i] for i in at), source=source)
        for key, at in places.items()
    }
    name = source.file.rpartition(".")[0] or source.file
    return Trial(name, streams, findings=tuple(findings))


def _refuse_missing_force(time: Values, values: Values, channels: Sequence[Channel], file: str) -> None:
    for i, channel in enumerate(channels):
        missing = np.isnan(values[:, i])
        if channel.quantity in ("force", "vertical_force") and missing.any():
            first = int(np.argmax(missing))
            raise ReadError(
                f"{file}: {channel.name} must have a number in every sample",
                f"{missing.sum()} of {len(time)} samples are missing (first: sample {first + 1} at t = "
                f"{time[first]:.6g} s)",
                "Export the force again without gaps (0 where the foot is in the air).",
            )
